# SPDX-License-Identifier: Apache-2.0
"""The Debian packages on a clean Debian 12: what they add, that they run, and that nothing stays behind."""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import debian_root
from debian_root import DebianRoot

SOURCE = pathlib.Path(os.environ["PALPATE_SOURCE"])
sys.path.insert(0, f"{SOURCE}/tests/commands")
from small_cohort import CASE  # noqa: E402
BUILD = pathlib.Path(os.environ["PALPATE_BUILD"])
MOST_ADDED_MB = 30  # by the runtime with all that it depends on and recommends
# Fields that SPDX 2.3 knows of a document and of a package, of those that we give.
DOCUMENT = {"spdxVersion", "dataLicense", "SPDXID", "name", "documentNamespace", "creationInfo", "packages",
            "relationships", "hasExtractedLicensingInfos"}
OF_PACKAGE = {"name", "SPDXID", "versionInfo", "supplier", "downloadLocation", "filesAnalyzed", "licenseConcluded",
              "licenseDeclared", "copyrightText", "externalRefs", "packageFileName", "checksums"}
NAMES = ("libpalpate-dev", "palpate-runtime", "palpate-tools", "palpate-trainer")
def output(*command):
    return subprocess.run([*map(str, command)], check=True, stdout=subprocess.PIPE, text=True).stdout


def setUpModule():
    """The packages are made once."""
    temporary = tempfile.TemporaryDirectory()
    unittest.addModuleCleanup(temporary.cleanup)
    Packages.scratch = pathlib.Path(temporary.name)
    output("cpack", "--config", BUILD / "CPackConfig.cmake", "-B", Packages.scratch)
    Packages.archives = {path.name.partition("_")[0]: path for path in Packages.scratch.glob("*.deb")}
    Packages.bill = json.loads(next(Packages.scratch.glob("*.spdx.json")).read_text())


class Packages(unittest.TestCase):
    """Gives its tests `scratch`, a folder, `archives`, the packages in it by name, and their `bill` of materials."""


class Archives(Packages):
    def test_there_are_four_and_no_file_is_in_two(self):
        self.assertEqual(sorted(self.archives), sorted(NAMES))
        owner = {}
        for name, archive in self.archives.items():
            for line in output("dpkg-deb", "-c", archive).splitlines():
                path = line.split()[5]
                if not path.endswith("/"):
                    self.assertNotIn(path, owner, name)
                    owner[path] = name
        self.assertGreater(len(owner), 100)

    def test_together_they_are_what_an_installation_has(self):
        prefix = self.scratch / "prefix"
        output("cmake", "--install", BUILD, "--prefix", prefix)
        installed = {str(path.relative_to(prefix)) for path in prefix.rglob("*") if path.is_file()}
        packed = {line.split()[5].removeprefix("./usr/") for archive in self.archives.values()
                  for line in output("dpkg-deb", "-c", archive).splitlines() if not line.endswith("/")}
        in_common_licences = {path for path in installed if path.startswith("share/doc/palpate/LICENSES/")}
        self.assertEqual(installed ^ packed, in_common_licences)

    def test_the_runtime_depends_on_no_library_of_the_tools(self):
        depends = output("dpkg-deb", "-f", self.archives["palpate-runtime"], "Depends")
        self.assertIn("libhdf5", depends)
        self.assertNotRegex(depends, "insighttoolkit|vtk|cgal|cholmod|metis|blas")


class Bill(Packages):
    """The list of what the packages are and stand on, by what SPDX 2.3 asks of a document."""

    @classmethod
    def setUpClass(cls):
        cls.packages = {each["name"]: each for each in cls.bill["packages"]}

    def test_it_has_the_fields_that_spdx_asks_for_and_no_other(self):
        self.assertEqual(self.bill.keys(), DOCUMENT)
        self.assertEqual([self.bill[field] for field in ("spdxVersion", "dataLicense", "SPDXID")],
                         ["SPDX-2.3", "CC0-1.0", "SPDXRef-DOCUMENT"])
        self.assertRegex(self.bill["documentNamespace"], r"^[a-z]+:[^#]+$")
        self.assertRegex(self.bill["creationInfo"]["created"], r"^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ$")
        for creator in self.bill["creationInfo"]["creators"]:
            self.assertRegex(creator, r"^(Tool|Organization|Person): \S")
        for each in self.bill["packages"]:
            self.assertRegex(each["SPDXID"], r"^SPDXRef-[A-Za-z0-9.-]+$")
            self.assertLessEqual(each.keys(), OF_PACKAGE)
            self.assertTrue(each["name"] and each["versionInfo"] and each["downloadLocation"])
            self.assertIs(each["filesAnalyzed"], False)  # else SPDX asks for their digest
        self.assertEqual(len({each["SPDXID"] for each in self.bill["packages"]}), len(self.bill["packages"]))

    def test_what_it_relates_and_what_licences_it_refers_to_is_in_it(self):
        known = {each["SPDXID"] for each in self.bill["packages"]} | {"SPDXRef-DOCUMENT"}
        for each in self.bill["relationships"]:
            self.assertLessEqual({each["spdxElementId"], each["relatedSpdxElement"]}, known)
            self.assertIn(each["relationshipType"],
                          {"DESCRIBES", "DEPENDS_ON", "BUILD_DEPENDENCY_OF", "GENERATED_FROM"})
        texts = {each["licenseId"]: each["extractedText"] for each in self.bill["hasExtractedLicensingInfos"]}
        self.assertTrue(all(texts.values()))
        declared = " ".join(each["licenseDeclared"] for each in self.bill["packages"])
        self.assertEqual(set(re.findall(r"LicenseRef-[A-Za-z0-9.-]+", declared)), set(texts))

    def test_every_licence_is_an_expression_and_ours_are_told(self):
        term = r"(?:LicenseRef-[A-Za-z0-9.-]+|[A-Za-z0-9.-]+)"
        group = rf"(?:{term}|\({term}(?: (?:AND|OR) {term})*\))"
        for each in self.bill["packages"]:
            self.assertRegex(each["licenseDeclared"], rf"^{group}(?: AND {group})*$", each["name"])
        self.assertEqual({name: self.packages[name]["licenseDeclared"] for name in NAMES},
                         dict.fromkeys(NAMES, "Apache-2.0") | {"palpate-tools": "Apache-2.0 AND GPL-3.0-or-later"})

    def test_it_names_what_the_tools_load_and_are_built_with(self):
        for name in ("libc6", "libvtk9.1", "libinsighttoolkit5.2", "libcholmod3", "libcgal-dev", "libeigen3-dev"):
            self.assertIn("Debian", self.packages[name]["supplier"])


@unittest.skipIf(debian_root.why_not(), debian_root.why_not())
class CleanDebian(Packages):
    @classmethod
    def setUpClass(cls):
        try:
            debian_root.make_bare()
        except subprocess.CalledProcessError as error:
            raise unittest.SkipTest(f"PALPATE: no clean Debian 12, is there a network? {error}")
        cls.sample = cls.scratch / "sample.vtkhdf"
        output(BUILD / "tests/write_sample_asset", cls.sample)

    def setUp(self):
        self.root = DebianRoot.in_new(self.scratch / self.id().rpartition(".")[2])
        self.root.take(self.sample)

    def tearDown(self):
        subprocess.run(["rm", "-rf", "--one-file-system", self.root.folder], check=True)

    def install(self, *names):
        self.root.install(*(self.archives[name] for name in names))

    def result(self, *command):
        return json.loads(self.root.run(*command, "--json", "-"))

    def touch(self):
        """What a short run on the sample gives: it was felt."""
        result = self.result("palpate", "touch", "/srv/sample.vtkhdf", "--seconds", 1, "--quiet")
        self.assertTrue(any(result["peak"]["force_n"]))
        return result

    def test_the_runtime_is_small_and_leaves_no_file_behind(self):
        before, packages = self.root.files(), self.root.packages()
        self.install("palpate-runtime")
        added = self.root.packages().keys() - packages.keys()
        after = self.root.files()
        on_disk = (sum(after.values()) - sum(before.values())) / 1e6
        said = sum(size for name, size in self.root.packages().items() if name in added) * 1024 / 1e6
        ready = sorted(self.touch()["ready_s"] for _ in range(9))
        print(f"the runtime adds {len(added)} packages, {on_disk:.1f} MB on the disk, {said:.1f} by their own account;",
              f"palpate-touch is ready after {ready[4]:.2f} s (median of 9, most {ready[-1]:.2f} s)")
        self.assertLess(max(on_disk, said), MOST_ADDED_MB)
        needed = {name for name in added if name in self.depended_on("palpate-runtime")}
        self.assertIn("libhdf5-103-1", needed)
        listed = {each["name"] for each in self.bill["packages"]}
        self.assertEqual(needed - listed, set())
        self.root.purge()
        self.assertEqual(self.root.packages().keys(), packages.keys())
        self.assertEqual(self.root.files().keys() ^ before.keys(), set())

    def depended_on(self, name):
        """All packages that one leads to by what it depends on."""
        told = self.root.run("apt-cache", "depends", "--recurse", "--installed", "--important", name)
        return {line.strip() for line in told.splitlines() if not line.startswith(" ")}

    def test_the_tools_build_a_case_and_a_cohort(self):
        self.root.install("snakemake", recommended=False)  # with it come the tools of several clouds, 1 GB
        self.install("palpate-runtime", "palpate-tools")
        labels = self.scratch / "good.seg.nrrd"  # as the case file says
        output(BUILD / "tests/phantom", "abdomen", self.scratch / "abdomen.nrrd", labels)
        self.root.take(labels)
        (self.root.folder / "srv/case.toml").write_text(CASE)
        (self.root.folder / "srv/patients.tsv").write_text("patient\tcase\none\tcase.toml\ntwo\tcase.toml\n")
        self.root.run("palpate", "build", "/srv/case.toml", "-o", "/srv/abdomen.vtkhdf")
        self.assertIn("<html", (self.root.folder / "srv/abdomen.html").read_text()[:200])
        self.result("palpate", "verify", "/srv/abdomen.vtkhdf")
        self.root.run("palpate", "batch", "/srv/patients.tsv", "-o", "/srv/cohort")
        for name in ("one", "two"):
            self.assertEqual(json.loads((self.root.folder / f"srv/cohort/{name}.json").read_text())["status"], "built")
        self.leave_nothing()

    def test_the_trainer_opens_its_window(self):
        self.install("palpate-runtime", "palpate-trainer")
        self.root.install("xvfb", "xauth")
        self.root.run("xvfb-run", "-a", "palpate", "train", "/srv/sample.vtkhdf", "--script", "press", "--seconds", 2,
                      "--screenshot", "/srv/press.png")
        self.assertGreater((self.root.folder / "srv/press.png").stat().st_size, 10000)
        self.leave_nothing()

    def test_a_program_of_ones_own_is_compiled_with_the_libraries(self):
        self.install("libpalpate-dev")
        self.root.install("g++", "cmake", "make")
        subprocess.run(["cp", "-r", SOURCE / "tests/consumer/project", self.root.folder / "srv"], check=True)
        self.root.run("cmake", "-S", "/srv/project", "-B", "/srv/project/build")
        self.root.run("cmake", "--build", "/srv/project/build")
        self.assertRegex(self.root.run("/srv/project/build/consumer", "/srv/sample.vtkhdf"), r"^[\d.]+ N\n")
        self.leave_nothing()

    def leave_nothing(self):
        """Purges ours and finds nothing of them."""
        self.assertTrue([path for path in self.root.files() if "palpate" in path])
        self.root.purge()
        self.assertEqual([name for name in self.root.packages() if "palpate" in name], [])
        self.assertEqual([path for path in self.root.files() if "palpate" in path], [])


if __name__ == "__main__":
    unittest.main()
