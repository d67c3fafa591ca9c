# SPDX-License-Identifier: GPL-3.0-or-later
"""A BIDS dataset becomes a cohort, and the cohort a BIDS dataset of derivatives."""
import fcntl
import json
import os
import re
import shutil
import subprocess
import time
import unittest

from nifti import nrrd_as_nifti, read_nifti, read_nrrd
from small_cohort import BIN, CASE, PHANTOM, SmallCohort

NAMES = "index\tname\n{}\tliver\n{}\ttumour\n"
# BIDS 1.9, discrete segmentations of non-parametric anatomical images: the order of entities and what may follow.
DSEG = re.compile(r"sub-[0-9a-zA-Z]+(/ses-[0-9a-zA-Z]+)?/anat/sub-[0-9a-zA-Z]+(_ses-[0-9a-zA-Z]+)?(_task-[0-9a-zA-Z]+)?(_acq-[0-9a-zA-Z]+)?"
                  r"(_ce-[0-9a-zA-Z]+)?(_rec-[0-9a-zA-Z]+)?(_run-\d+)?(_space-[0-9a-zA-Z]+)?(_seg-[0-9a-zA-Z]+)?(_desc-[0-9a-zA-Z]+)?"
                  r"_dseg\.(nii\.gz|tsv|json)")


def files_of(folder):
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


class Bids(SmallCohort):
    def setUp(self):
        super().setUp()
        self.dataset = self.folder / "bids"
        self.dataset.mkdir()
        (self.dataset / "dataset_description.json").write_text('{"Name": "Phantoms", "BIDSVersion": "1.9.0"}')
        (self.folder / "inputs" / "case.toml").write_text(CASE.replace('labels = "good.seg.nrrd"\n', ""))

    def add_scan(self, below, name="T1w", *phantom_options):
        """An image sub-01[_ses-01]_NAME.nii.gz and its segmentation among the derivatives."""
        ct, labels = self.folder / "ct.nrrd", self.folder / "labels.seg.nrrd"
        subprocess.run([PHANTOM, "abdomen", ct, labels, "--quiet", "--force", *phantom_options], check=True, stdout=subprocess.DEVNULL)
        stem = below.replace("/", "_")
        entities, _, suffix = name.rpartition("_")
        nrrd_as_nifti(ct, self.dataset / below / "anat" / f"{stem}_{name}.nii.gz")
        nrrd_as_nifti(labels, self.dataset / "derivatives" / "hand" / below / "anat" / f"{stem}_{entities + '_' if entities else ''}dseg.nii.gz")

    def name_labels(self):
        (self.dataset / "derivatives" / "hand" / "dseg.tsv").write_text(NAMES.format(*self.values()))

    def values(self):
        head = (self.folder / "labels.seg.nrrd").read_bytes().partition(b"\n\n")[0].decode()
        found = {match[1]: match[0] for match in re.findall(r"Segment(\d+)_Name:=(\w+)", head)}
        return [re.search(rf"Segment{found[name]}_LabelValue:=(\d+)", head)[1] for name in ("liver", "tumour")]

    def run_palpate(self, *arguments, code=0):
        ran = subprocess.run([BIN / "palpate", *arguments], text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=250, check=False)
        self.assertEqual(ran.returncode, code, ran.stdout + ran.stderr)
        return ran

    def bids(self, *options, code=0):
        return self.run_palpate("batch", self.dataset, "--case", self.folder / "inputs" / "case.toml", "-o", self.out, *options, code=code)

    def rows(self):
        lines = [line.split("\t") for line in (self.out / "patients.tsv").read_text().splitlines()]
        return {line[0]: dict(zip(lines[0], line)) for line in lines[1:]}

    @unittest.skipUnless(shutil.which("snakemake"), "snakemake is not installed")
    def test_a_dataset_is_built_and_goes_back_as_derivatives(self):
        self.add_scan("sub-01", "acq-thick_run-1_T1w")
        self.add_scan("sub-02/ses-01")
        self.add_scan("sub-02/ses-02", "T1w", "--angle", "8")
        self.add_scan("sub-03")
        self.name_labels()
        cut = self.dataset / "sub-03" / "anat" / "sub-03_T1w.nii.gz"
        cut.write_bytes(cut.read_bytes()[:2000])
        (self.dataset / "sub-04" / "anat").mkdir(parents=True)
        ran = self.bids("--json", self.folder / "result.json", code=4)
        self.assertIn("3 of 5 patients", ran.stderr)
        status = {row["patient"]: row for row in json.loads((self.folder / "result.json").read_text())["patients"]}
        self.assertEqual([name for name, row in status.items() if row["status"] == "built"], ["sub-01", "sub-02_ses-01", "sub-02_ses-02"])
        self.assertEqual(status["sub-03"]["failed_stage"], "import volume")
        self.assertRegex(status["sub-04"]["said"], r"patients\.tsv:6: has no image in anat/ or ct/; add one")
        self.assertEqual(self.rows()["sub-02_ses-02"]["volume"], "../bids/sub-02/ses-02/anat/sub-02_ses-02_T1w.nii.gz")
        self.assertEqual(self.rows()["sub-01"]["label_names"], "../bids/derivatives/hand/dseg.tsv")

        target = self.dataset / "derivatives" / "palpate"
        self.leave_a_killed_export(target)
        ran = self.run_palpate("export", self.out, "-o", target, "--json", self.folder / "export.json")
        made = json.loads((self.folder / "export.json").read_text())
        self.assertEqual(made["patients"], ["sub-01", "sub-02_ses-01", "sub-02_ses-02"])
        self.assertEqual([row["patient"] for row in made["left_out"]], ["sub-03", "sub-04"])
        self.check_dataset(target)
        for patient, stem in (("sub-01", "sub-01/anat/sub-01_acq-thick_run-1"), ("sub-02_ses-02", "sub-02/ses-02/anat/sub-02_ses-02")):
            self.check_round_trip(patient, target / f"{stem}_desc-palpate_dseg.nii.gz")
            asset = target / f"{stem}_desc-palpate_asset.vtkhdf"
            self.assertEqual(asset.read_bytes(), (self.out / f"{patient}.vtkhdf").read_bytes())
            self.assertTrue((target / f"{stem}_desc-palpate_report.html").exists())
        self.assertIn("0 findings", self.run_palpate("verify", "--privacy", target).stdout)

        first = files_of(target)
        self.assertIn("exists already", self.run_palpate("export", self.out, "-o", target, code=3).stderr)
        self.assertEqual(files_of(target), first)
        self.run_palpate("export", self.out, "-o", target, "--force")
        self.assertEqual(files_of(target), first, "the same cohort gives the same bytes")
        self.assertEqual(sorted(path.name for path in target.parent.iterdir()), ["hand", "palpate"], "nothing else is left")

        self.bids(code=4)  # our own derivatives are no segmentations to build from
        elsewhere = self.folder / "elsewhere"
        (self.dataset / "dataset_description.json").write_text('{"Name": "Phantoms", "BIDSVersion": "1.9.0", "DatasetDOI": "10.1234/phantoms"}')
        self.run_palpate("export", self.out, "-o", elsewhere)
        description = json.loads((elsewhere / "dataset_description.json").read_text())
        self.assertEqual((description["SourceDatasets"], description["DatasetLinks"]), ([{"DOI": "10.1234/phantoms"}], {"raw": "doi:10.1234/phantoms"}))
        (self.dataset / "dataset_description.json").write_text('{"Name": "Phantoms", "BIDSVersion": "1.9.0"}')
        self.assertIn("does not say which files", self.run_palpate("export", self.out, "-o", elsewhere, "--force").stderr)
        sidecar = json.loads((elsewhere / "sub-01/anat/sub-01_acq-thick_run-1_desc-palpate_dseg.json").read_text())
        self.assertEqual(sidecar["SpatialReference"], "orig")
        self.assertIn("0 findings", self.run_palpate("verify", "--privacy", elsewhere).stdout)

    def leave_a_killed_export(self, target):
        """Another process leaves the folder that an export fills; once that is killed, it is the next one's to remove."""
        report, aside = self.out / "sub-02_ses-02.html", self.folder / "report.html"
        report.rename(aside)
        os.mkfifo(report)  # holds the export up: nobody writes into it
        running = subprocess.Popen([BIN / "palpate", "export", self.out, "-o", target, "--quiet"])
        self.addCleanup(running.wait)
        self.addCleanup(running.kill)
        staged = lambda: list(target.parent.glob(".part-*"))
        while not staged() and running.poll() is None:
            time.sleep(0.02)
        self.run_palpate("tissues", "--json", target.parent / "tissues.json")
        (target.parent / "tissues.json").unlink()
        (staged()[0] / "sub-99").mkdir()
        running.kill()
        running.wait()
        self.assertEqual(len(staged()), 1)
        aside.replace(report)

    def check_dataset(self, target):
        description = json.loads((target / "dataset_description.json").read_text())
        self.assertEqual(description["DatasetType"], "derivative")
        self.assertEqual(description["GeneratedBy"][0]["Name"], "Palpate")
        self.assertEqual(description["DatasetLinks"], {"raw": "../.."})
        ignored = [line.removeprefix("*") for line in (target / ".bidsignore").read_text().splitlines()]
        for name in files_of(target):
            if name in (".bidsignore", "README.md", "dataset_description.json"):
                continue
            self.assertTrue(DSEG.fullmatch(name) or name.endswith(tuple(ignored)), name)
        sidecar = json.loads((target / "sub-02/ses-02/anat/sub-02_ses-02_desc-palpate_dseg.json").read_text())
        image = "bids:raw:sub-02/ses-02/anat/sub-02_ses-02_T1w.nii.gz"
        self.assertEqual(sidecar["SpatialReference"], image)
        self.assertEqual(sidecar["Sources"], [image, "bids:raw:derivatives/hand/sub-02/ses-02/anat/sub-02_ses-02_dseg.nii.gz"])
        for source in sidecar["Sources"]:
            self.assertTrue((target / description["DatasetLinks"]["raw"] / source.removeprefix("bids:raw:")).exists())

    def check_round_trip(self, patient, exported):
        size, lps, voxels, _ = read_nrrd(self.out / f"{patient}.parts" / "labels.seg.nrrd")
        found_size, found_lps, found_voxels = read_nifti(exported)
        self.assertEqual((found_size, found_voxels), (size, voxels))
        back = self.folder / f"{patient}.seg.nrrd"
        self.run_palpate("import", exported, "--labels", "--label-names", str(exported).replace(".nii.gz", ".tsv"), "-o", back)
        back_size, back_lps, back_voxels, _ = read_nrrd(back)
        self.assertEqual((back_size, back_voxels), (size, voxels))
        for read in (found_lps, back_lps):
            for row, expected in zip(read, lps):
                for number, wanted in zip(row, expected):
                    self.assertAlmostEqual(number, wanted, delta=1e-4)  # float32 of 500 mm
        self.assertIn(b"Segment0_Name:=liver", back.read_bytes())

    def test_what_a_dataset_leaves_open_is_refused_by_name_or_chosen_and_said(self):
        self.add_scan("sub-01", "run-2_T1w")
        self.add_scan("sub-01", "run-10_T1w")
        self.add_scan("sub-01", "run-2_T2w")
        self.add_scan("sub-02", "acq-a_T1w")
        self.add_scan("sub-02", "acq-b_T1w")
        self.name_labels()
        self.assertIn("1 of 2 patients cannot be built", self.bids("--check", code=3).stderr)
        self.assertFalse(self.out.exists())
        ran = self.bids("--requests")
        self.assertIn("there are T2w too, which --image chooses", ran.stderr)
        self.assertIn("../bids/sub-01/anat/sub-01_run-2_T1w.nii.gz", self.rows()["sub-01"]["volume"])
        self.assertEqual(self.rows()["sub-01"]["#note"], "the first of 2 runs")
        self.assertRegex(self.rows()["sub-02"]["problem"], r"has 2 T1w images, sub-02_acq-a_T1w\.nii\.gz, sub-02_acq-b_T1w\.nii\.gz; choose")
        self.assertEqual([path.stem for path in (self.out / ".batch" / "requests").iterdir()], ["sub-01"])

        (self.out / "patients.tsv").write_text((self.out / "patients.tsv").read_text() + "\n")
        self.assertRegex(self.bids("--requests", code=3).stderr, r"is not the table that .*bids gives now; build it as it stands with")
        self.run_palpate("batch", self.out / "patients.tsv", "-o", self.out, "--requests")
        self.bids("--image", "acq-b_T1w", "--requests", "--force")
        self.assertRegex(self.rows()["sub-01"]["problem"], "has no acq-b_T1w image; there are sub-01_run-10_T1w.nii.gz, ")
        self.assertEqual(self.rows()["sub-02"]["problem"], "")
        self.assertRegex(self.bids("--image", "FLAIR", code=3).stderr, "has no FLAIR image; there are")

    def test_what_is_no_dataset_or_no_cohort_is_refused(self):
        case = self.folder / "inputs" / "case.toml"
        self.assertIn("has no subjects", self.bids(code=3).stderr)
        self.assertIn("no dataset_description.json", self.run_palpate("batch", self.folder, "--case", case, "-o", self.out, code=3).stderr)
        self.assertIn("without --case", self.run_palpate("batch", self.dataset, "-o", self.out, code=2).stderr)
        self.write_table(("first", "inputs/case.toml", "inputs/good.seg.nrrd", "", ""))
        table = self.folder / "patients.tsv"
        self.assertIn("--image: with a table", self.run_palpate("batch", table, "--image", "T1w", "-o", self.out, code=2).stderr)
        self.assertIn("is no cohort", self.run_palpate("export", self.dataset, "-o", self.folder / "x", code=3).stderr)
        self.run_palpate("batch", table, "-o", self.out, "--requests")
        precious = self.folder / "inputs"
        self.assertIn("no dataset that Palpate made", self.run_palpate("export", self.out, "-o", precious, "--force", code=3).stderr)
        self.assertTrue((precious / "case.toml").exists())
        self.assertIn("of which it would be made", self.run_palpate("export", self.out, "-o", self.folder, "--force", code=3).stderr)
        self.assertIn("has no patient that is built", self.run_palpate("export", self.out, "-o", self.folder / "x", code=3).stderr)
        self.assertIn("with a cohort", self.run_palpate("export", self.out, "--title", "liver", "-o", self.folder / "x", code=2).stderr)
        self.assertFalse(any(name.startswith((".part", "x")) for name in os.listdir(self.folder)))

    def test_a_table_is_not_written_anew_while_its_cohort_is_built(self):
        self.add_scan("sub-01")
        self.name_labels()
        self.bids("--requests")
        table = self.out / "patients.tsv"
        table.write_text(table.read_text() + "\n")
        kept = table.read_text()
        place = 1469598103934665603  # FNV-1a, as FolderLock has it
        for letter in b"batch":
            place = (place ^ letter) * 1099511628211 % 2**64
        with open(self.out / ".batch" / "lock", "a+b") as held:
            fcntl.lockf(held, fcntl.LOCK_EX, 1, place % 2**30)
            self.assertIn("is being built by another", self.bids("--requests", "--force", code=3).stderr)
            self.assertIn("is being built by another", self.run_palpate("export", self.out, "-o", self.folder / "made", code=3).stderr)
        self.assertEqual(table.read_text(), kept)
        self.bids("--requests", "--force")
        self.assertNotEqual(table.read_text(), kept)


if __name__ == "__main__":
    unittest.main()
