# SPDX-License-Identifier: GPL-3.0-or-later
"""palpate batch through a Slurm cluster of this machine's own."""
import unittest

import slurm_here
from small_cohort import STAGES, SmallCohort, digests


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
        self.assertEqual(self.status("cut")["failed_stage"], "import labels")
        self.batch(out="local", code=4)
        self.assertEqual(digests(self.out), digests(self.folder / "local"))
        self.assertEqual(len(digests(self.out)), 2)


if __name__ == "__main__":
    unittest.main()
