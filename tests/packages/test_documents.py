# SPDX-License-Identifier: Apache-2.0
"""What a package tells of itself: manual pages, copyright, changelog."""
import gzip
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

SOURCE = pathlib.Path(os.environ["PALPATE_SOURCE"])
BIN = pathlib.Path(os.environ["PALPATE_BIN"])


@unittest.skipUnless(all(map(shutil.which, ("man", "mandoc"))), "PALPATE: man-db or mandoc is missing")
class Documents(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        cls.share = pathlib.Path(temporary.name)
        cls.programs = sorted(path.name for path in BIN.glob("palpate*"))
        subprocess.run([SOURCE / "cmake/packages/documents.py", "palpate-tools", "1.2.3", "--share", cls.share,
                        "--programs", BIN, "--sources", "formats", "tools", "--commands", *cls.programs], check=True)

    def page(self, program):
        return gzip.decompress((self.share / f"man/man1/{program}.1.gz").read_bytes()).decode()

    def shown(self, program):
        """A page as a terminal shows it, without its warnings, and those."""
        shown = subprocess.run(
            ["man", "--warnings", "-l", "-"], input=self.page(program), capture_output=True, text=True,
            env=os.environ | {"LC_ALL": "C.UTF-8", "MANWIDTH": "100"})
        return shown.stdout, shown.stderr

    def test_every_program_has_a_page_that_groff_takes_without_a_warning(self):
        for program in self.programs:
            shown, warnings = self.shown(program)
            self.assertEqual(warnings, "", program)
            self.assertRegex(shown, rf"NAME\n +{program} +- +\w")

    def test_every_page_is_one_that_mandoc_takes_without_a_warning(self):
        for program in self.programs:
            told = subprocess.run(["mandoc", "-Tlint", "-W", "warning"], input=self.page(program), capture_output=True,
                                  text=True)
            self.assertEqual((told.returncode, told.stdout), (0, ""), program)

    def test_a_page_has_every_option_of_the_help_and_palpate_1_every_command(self):
        for program in self.programs[1:]:
            told = subprocess.run([BIN / program, "--help"], capture_output=True, text=True, check=True).stdout
            names = [line.split()[0] for line in told.splitlines() if line.startswith("  -")]
            named = ",".join(names).split(",")
            shown = self.shown(program)[0]
            self.assertGreater(len(named), 5)
            self.assertEqual([name for name in named if name not in shown], [], program)
            self.assertIn(program.replace("palpate-", "palpate "), self.shown("palpate")[0])

    def test_copyright_has_the_licences_of_the_sources_and_of_no_others(self):
        text = (self.share / "doc/palpate-tools/copyright").read_text()
        apache, gpl = (part for part in text.split("\n\n") if part.startswith("Files:"))
        self.assertIn("formats/*\n tools/cli/*\n", apache)
        self.assertIn("License: Apache-2.0", apache)
        self.assertIn(" tools/meshing/*\n", gpl)
        self.assertIn("License: GPL-3+", gpl)
        self.assertNotIn("runtime", text)

    def test_dpkg_reads_the_changelog(self):
        changelog = gzip.decompress((self.share / "doc/palpate-tools/changelog.gz").read_bytes()).decode()
        told = subprocess.run(["dpkg-parsechangelog", "-l", "-", "-S", "Version"], input=changelog,
                              capture_output=True, text=True, check=True)
        self.assertEqual((told.stdout.strip(), told.stderr), ("1.2.3", ""))


if __name__ == "__main__":
    unittest.main()
