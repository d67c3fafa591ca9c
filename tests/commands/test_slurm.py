# SPDX-License-Identifier: GPL-3.0-or-later
"""palpate batch through a Slurm cluster of this machine's own."""
import os
import pathlib
import subprocess
import tempfile
import unittest

import slurm_here
from small_cohort import STAGES, SmallCohort, digests

SOURCE = pathlib.Path(os.environ["PALPATE_SOURCE"])


@unittest.skipIf(slurm_here.why_not(), f"no Slurm cluster can be started: {slurm_here.why_not()}")
class Slurm(SmallCohort):
    def test_a_slurm_cluster_makes_the_same_bytes(self):
        self.write_table(("first", "inputs/case.toml", "", "", ""), ("second", "inputs/case.toml", "inputs/good.seg.nrrd", "5", ""),
                         ("cut", "inputs/case.toml", "inputs/bad.seg.nrrd", "", ""))
        home = self.folder / "slurm"
        home.mkdir()
        cluster = slurm_here.Cluster(home)
        self.addCleanup(cluster.stop)
        cluster.start()
        self.batch("--profile", "slurm", code=4, env={**cluster.environment, "CI": "true"})  # Snakemake asks every second
        jobs = cluster.ask("scontrol", "--oneliner", "show", "jobs")
        self.assertGreaterEqual(jobs.count("JobState=COMPLETED"), 2 * len(STAGES))
        self.assertIn("JobState=FAILED", jobs)
        self.assertEqual(jobs.count("TimeLimit=02:00:00"), jobs.count("JobId="))
        self.assertEqual(self.status("cut")["failed_stage"], "import labels")
        self.batch(out="local", code=4)
        self.assertEqual(digests(self.out), digests(self.folder / "local"))
        self.assertEqual(len(digests(self.out)), 2)


class Status(unittest.TestCase):
    """What the profile makes of a controller's answers, by a controller that answers as told."""

    def status(self, answer, code=0):
        with tempfile.TemporaryDirectory() as folder:
            controller = pathlib.Path(folder) / "scontrol"
            controller.write_text(f"#!/bin/sh\necho '{answer}'\nexit {code}\n")
            controller.chmod(0o755)
            script = SOURCE / "pipelines" / "profiles" / "slurm" / "status.sh"
            ran = subprocess.run([script, "7"], env={**os.environ, "PATH": f"{folder}:{os.environ['PATH']}"}, capture_output=True, text=True,
                                 check=True)
            return ran.stdout.strip()

    def test_a_job_is_what_its_state_says(self):
        for state, status in (("COMPLETED", "success"), ("PENDING", "running"), ("COMPLETING", "running"), ("FAILED", "failed"),
                              ("OUT_OF_MEMORY", "failed"), ("TIMEOUT", "failed"), ("NODE_FAIL", "failed"), ("CANCELLED", "failed")):
            self.assertEqual(self.status(f"JobId=7 JobName=palpate JobState={state} Reason=None"), status, state)

    def test_a_controller_that_does_not_answer_is_no_failure_and_a_job_that_it_does_not_know_is_one(self):
        self.assertEqual(self.status(""), "running")
        self.assertEqual(self.status("slurm_load_jobs error: Unable to contact slurm controller (connect failure)", 1), "running")
        self.assertEqual(self.status("slurm_load_jobs error: Invalid job id specified", 1), "failed")


if __name__ == "__main__":
    unittest.main()
