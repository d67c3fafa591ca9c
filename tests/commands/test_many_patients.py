# SPDX-License-Identifier: GPL-3.0-or-later
"""The Snakefile over a table of two patients: the one that fails is named and does not stop the other."""
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

BIN = pathlib.Path(os.environ["PALPATE_BIN"])
SOURCE = pathlib.Path(os.environ["PALPATE_SOURCE"])
PHANTOM = pathlib.Path(os.environ["PALPATE_BUILD"]) / "tests" / "phantom"

CASE = """schema = 1
name = "abdomen"
[[structure]]
name = "liver"
recipe = "import"
[[deformable]]
name = "liver"
mesh = { cell_size_mm = 9 }
fixed = [{ plane_mm = [0, 8, 0, 0, 1, 0] }]
[[deformable.region]]
label = "liver"
youngs_modulus_kpa = 6.3
poissons_ratio = 0.45
"""


@unittest.skipUnless(shutil.which("snakemake"), "snakemake is not installed")
class ManyPatients(unittest.TestCase):
    def test_one_failure_is_named_and_the_rest_is_built_once(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            subprocess.run([PHANTOM, "abdomen", folder / "ct.nrrd", folder / "good.seg.nrrd", "--quiet"], check=True,
                           stdout=subprocess.DEVNULL)
            (folder / "bad.seg.nrrd").write_bytes((folder / "good.seg.nrrd").read_bytes()[:2000])
            (folder / "case.toml").write_text(CASE)
            (folder / "patients.tsv").write_text("patient\tcase\tvolume\tlabels\n"
                                                 "first\tcase.toml\t\tbad.seg.nrrd\n"
                                                 "second\tcase.toml\t\tgood.seg.nrrd\n")

            def snakemake():
                return subprocess.run(["snakemake", "--snakefile", SOURCE / "pipelines" / "Snakefile",
                                       "--profile", SOURCE / "pipelines" / "profiles" / "local", "--directory", folder,
                                       "--config", "table=patients.tsv", "out=out", f"palpate={BIN / 'palpate'}"],
                                      text=True, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=250)

            ran = snakemake()
            self.assertNotEqual(ran.returncode, 0)
            out = folder / "out"
            self.assertTrue((out / "second.vtkhdf").exists(), ran.stdout)
            self.assertTrue((out / "second.html").exists())
            self.assertFalse((out / "first.vtkhdf").exists())
            failures = (out / "failures.txt").read_text()
            self.assertRegex(failures, r"^first\tpalpate-import: .*bad\.seg\.nrrd")
            self.assertEqual(len(failures.splitlines()), 1)

            (folder / "patients.tsv").write_text("patient\tcase\tvolume\tlabels\n"
                                                 "second\tcase.toml\t\tgood.seg.nrrd\n")
            again = snakemake()
            self.assertEqual(again.returncode, 0, again.stdout)
            self.assertIn("Nothing to be done", again.stdout)


if __name__ == "__main__":
    unittest.main()
