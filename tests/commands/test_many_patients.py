# SPDX-License-Identifier: GPL-3.0-or-later
"""palpate batch over small tables: who is built, who fails and why, and what a second run, a kill and an interrupt leave to do."""
import json
import os
import shutil
import signal
import subprocess
import time
import unittest

from small_cohort import BIN, STAGES, SmallCohort, digests


@unittest.skipUnless(shutil.which("snakemake"), "snakemake is not installed")
class ManyPatients(SmallCohort):
    def test_each_failure_is_named_the_rest_is_built_once_and_a_change_reruns_what_it_touches(self):
        self.write_table(("first", "inputs/case.toml", "", "", ""), ("second", "inputs/case.toml", "inputs/good.seg.nrrd", "5", "stiffer"),
                         ("cut", "inputs/case.toml", "inputs/bad.seg.nrrd", "", ""), ("gone", "inputs/case.toml", "inputs/none.seg.nrrd", "", ""),
                         ("negative", "inputs/case.toml", "", "-4", ""), ("p 1;touch X", "inputs/case.toml", "", "", ""))
        ran = self.batch(code=4)
        self.assertIn("2 of 6 patients", ran.stderr)
        self.assertFalse((self.folder / "X").exists())
        for patient, modulus in ("first", 6.3), ("second", 5):
            self.assertTrue((self.out / f"{patient}.vtkhdf").exists())
            self.assertTrue((self.out / f"{patient}.html").exists())
            status = self.status(patient)
            self.assertEqual([(row["stage"], row["status"]) for row in status["stages"]], [(stage, "finished") for stage in STAGES])
            inspected = subprocess.run([BIN / "palpate", "inspect", self.out / f"{patient}.vtkhdf", "--json", "-"], stdout=subprocess.PIPE,
                                       text=True, check=True).stdout
            self.assertEqual(json.loads(inspected)["regions"][0]["youngs_modulus_kpa"], modulus)
        failures = {"cut": r"bad\.seg\.nrrd.*check that the file is whole", "gone": r"patients\.tsv:5: .*none\.seg\.nrrd: is not there",
                    "negative": r"patients\.tsv:6: .*youngs_modulus_kpa.* is -4 \(expected 0\.001 to 2e\+09\)"}
        results = [line.split("\t") for line in (self.out / "results.tsv").read_text().splitlines()[1:]]
        self.assertEqual([row[:2] for row in results], [["first", "built"], ["second", "built"], ["cut", "failed"], ["gone", "failed"],
                                                        ["negative", "failed"], ["p 1;touch X", "failed"]])
        for patient, said in failures.items():
            self.assertRegex(self.status(patient)["said"].replace("\n", " "), said)
        self.assertEqual(self.status("cut")["failed_stage"], "import labels")
        self.assertRegex(results[5][-1], r"patients\.tsv:7: .*no safe file name")

        page = (self.out / "index.html").read_text()
        self.assertEqual(page.count("data:image/png;base64,"), 2, "a picture of each that was built")
        for link in ("first.html", "second.html", "cut.parts/failure.html"):
            self.assertIn(f'href="{link}"', page)
            self.assertTrue((self.out / link).exists())

        before = digests(self.out)
        self.batch(code=4)
        self.assertEqual(self.stages_to_do(), 0, "bad input is not tried again either")
        self.write_table(("first", "inputs/case.toml", "", "", ""), ("second", "inputs/case.toml", "", "7", "stiffer still"))
        self.batch()
        self.assertEqual(self.stages_to_do(), len(STAGES) - 3, "from condensation on, of one patient")
        self.assertEqual(digests(self.out)["first.vtkhdf"], before["first.vtkhdf"])
        self.assertNotEqual(digests(self.out)["second.vtkhdf"], before["second.vtkhdf"])

    def test_the_table_is_checked_without_building(self):
        self.write_table(("first", "inputs/case.toml", "", "", ""))
        self.batch("--check")
        self.assertFalse(self.out.exists())
        self.write_table(("first", "inputs/case.toml", "", "-4", ""), ("second", "none.toml", "", "", ""))
        ran = self.batch("--check", code=3)
        self.assertIn("patients.tsv:2", ran.stderr)
        self.assertIn("patients.tsv:3", ran.stderr)
        self.write_table()
        self.assertIn("has no patients", self.batch("--check", code=3).stderr)

    def test_a_request_of_each_patient_builds_him_elsewhere(self):
        self.write_table(("first", "inputs/case.toml", "inputs/good.seg.nrrd", "", ""))
        self.batch("--requests")
        array = shutil.copy(BIN.parent / "share" / "palpate" / "pipelines" / "slurm_array.sh", self.folder)
        path = f"{BIN}:{os.environ['PATH']}"
        subprocess.run([array, "out"], cwd=self.folder, env={**os.environ, "PATH": path, "SLURM_ARRAY_TASK_ID": "1"}, check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.batch()
        self.assertEqual(self.stages_to_do(), 0)
        self.assertEqual(self.status("first")["status"], "built")

    def start_and_wait_for_a_stage(self):
        finished = len(list(self.out.glob("*.parts/[!.]*.stage.json")))
        process = subprocess.Popen(self.command(), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        while len(list(self.out.glob("*.parts/[!.]*.stage.json"))) <= finished:
            self.assertIsNone(process.poll())
            time.sleep(0.05)
        return process

    def assert_goes_on(self):
        finished = {path: path.stat().st_mtime_ns for path in self.out.glob("*.parts/[!.]*.stage.json")}
        self.batch()
        for path, stamp in finished.items():
            self.assertEqual(path.stat().st_mtime_ns, stamp, f"{path} ran again")
        for asset in self.out.glob("*.vtkhdf"):
            subprocess.run([BIN / "palpate", "verify", asset], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def test_an_interrupt_or_a_kill_loses_no_finished_stage(self):
        self.write_table(*((f"p{i}", "inputs/case.toml", "", str(4 + i), "") for i in range(3)))
        process = self.start_and_wait_for_a_stage()
        other = self.batch(code=3)
        self.assertIn("is being built by another palpate batch", other.stderr)
        process.send_signal(signal.SIGINT)
        said = process.communicate(timeout=60)[1]
        self.assertEqual(process.returncode, 130, said)
        self.assertIn("run the same command again", said)
        self.assertIn("unfinished", (self.out / "results.tsv").read_text())
        process = self.start_and_wait_for_a_stage()
        process.kill()
        process.communicate()
        self.assert_goes_on()
        self.assertEqual(len(digests(self.out)), 3)


if __name__ == "__main__":
    unittest.main()
