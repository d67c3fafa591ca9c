# SPDX-License-Identifier: GPL-3.0-or-later
"""A folder with a phantom, a case file and a label map that is cut off, and palpate batch over tables of them."""
import hashlib
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

BIN = pathlib.Path(os.environ["PALPATE_BIN"])
PHANTOM = pathlib.Path(os.environ["PALPATE_BUILD"]) / "tests" / "phantom"

CASE = """schema = 1
name = "abdomen"
[input]
labels = "good.seg.nrrd"
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
STAGES = ["import labels", "segment", "mesh liver", "condense liver", "pack", "touch", "report"]
HEAD = ("patient", "case", "labels", "deformable.liver.region.liver.youngs_modulus_kpa", "#note")


def digests(folder):
    return {asset.name: hashlib.sha256(asset.read_bytes()).hexdigest() for asset in folder.glob("*.vtkhdf")}


class SmallCohort(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        self.out = self.folder / "out"
        inputs = self.folder / "inputs"
        inputs.mkdir()
        subprocess.run([PHANTOM, "abdomen", inputs / "ct.nrrd", inputs / "good.seg.nrrd", "--quiet"], check=True, stdout=subprocess.DEVNULL)
        (inputs / "bad.seg.nrrd").write_bytes((inputs / "good.seg.nrrd").read_bytes()[:2000])
        (inputs / "case.toml").write_text(CASE)

    def write_table(self, *rows):
        table = self.folder / "patients.tsv"
        table.write_text("".join("\t".join(row) + "\n" for row in (HEAD, *rows)))

    def command(self, *options, out="out"):
        return [BIN / "palpate", "batch", self.folder / "patients.tsv", "-o", self.folder / out, "--json", self.folder / "result.json", "--force",
                "--threads", "2", *options]

    def batch(self, *options, out="out", code=0, env=None):
        ran = subprocess.run(self.command(*options, out=out), text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=250, env=env,
                             check=False)
        log = self.folder / out / "logs" / "snakemake.log"
        self.assertEqual(ran.returncode, code, ran.stdout + ran.stderr + (log.read_text()[-3000:] if log.exists() else ""))
        return ran

    def stages_to_do(self):
        return json.loads((self.folder / "result.json").read_text())["stages_to_do"]

    def status(self, patient):
        return json.loads((self.out / f"{patient}.json").read_text())
