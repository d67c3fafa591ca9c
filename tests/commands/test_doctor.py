# SPDX-License-Identifier: Apache-2.0
"""palpate-doctor on this machine: what it says, what it hides, what it exits with."""

import getpass
import json
import os
import pathlib
import re
import socket
import subprocess

from sample_asset import SampleAsset

DOCTOR = pathlib.Path(os.environ["PALPATE_BIN"]) / "palpate-doctor"


class Doctor(SampleAsset):
    writer = "write_sample_case"

    def doctor(self, *options, **variables):
        environment = {k: v for k, v in os.environ.items() if k not in ("PALPATE_HD_LIBRARY", "GTDD_HOME")}
        return subprocess.run(
            [DOCTOR, "--seconds", "0.2", *map(str, options)],
            capture_output=True, text=True, timeout=60, env=environment | variables,
        )

    def findings(self, run):
        return {finding["id"]: finding for finding in json.loads(run.stdout)["findings"]}

    def test_a_machine_without_a_device_library_is_not_ready_for_a_device(self):
        # A path where no library is, so that the test does not depend on what is installed.
        run = self.doctor(PALPATE_HD_LIBRARY="/nowhere/libHD.so", GTDD_HOME="/nowhere")
        self.assertEqual(run.returncode, 4, run.stderr)
        self.assertIn("PALPATE_HD_LIBRARY=/nowhere/libHD.so: no such library", run.stdout)
        self.assertIn("      unset PALPATE_HD_LIBRARY", run.stdout)
        self.assertIn("GTDD_HOME=/nowhere holds no", run.stdout)
        self.assertIn("not ready for a device", run.stderr)
        for group in ("real time", "measured", "device library", "environment"):
            self.assertIn(f"\n{group}\n", "\n" + run.stdout)

    def test_a_simulation_asks_for_less(self):
        run = self.doctor("--simulated", "--json", "-")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertTrue({"library", "usb", "device_config"}.isdisjoint(self.findings(run)))

    def test_json_agrees_with_the_exit_code_and_has_a_fix_for_every_problem(self):
        run = self.doctor("--json", "-")
        result = json.loads(run.stdout)
        self.assertEqual(result["schema"], "palpate.doctor/1")
        levels = [finding["level"] for finding in result["findings"]]
        self.assertEqual(result["problems"], levels.count("problem"))
        self.assertEqual(result["warnings"], levels.count("warning"))
        self.assertEqual(run.returncode, 4 if result["problems"] else 0)
        self.assertEqual(result["ready"], not result["problems"])
        for finding in result["findings"]:
            self.assertTrue(finding["fix"] or finding["level"] != "problem", finding)
            self.assertTrue(finding["found"], finding)
        self.assertEqual(len(self.findings(run)), len(levels), "an id occurs twice")
        self.assertIn(result["rate_held_hz"], (0, 250, 500, 1000))
        for measured in result["measured"].values():
            self.assertGreater(measured["deadlines"], measured["missed"])

    def test_json_holds_no_personal_data(self):
        home = self.folder / "home_of_somebody"
        home.mkdir()
        run = self.doctor(
            "--json", "-", HOME=str(home), PALPATE_HD_LIBRARY=f"{home}/libHD.so", GTDD_HOME=f"{home}/driver"
        )
        self.assertIn("~/libHD.so", run.stdout)
        self.assertNotIn("home_of_somebody", run.stdout)
        self.assertNotRegex(run.stdout, rf"\b{re.escape(socket.gethostname())}\b")  # 'vm' is in 'kvm-clock'
        if getpass.getuser() != "root":
            self.assertNotIn(getpass.getuser(), run.stdout)

    def test_a_case_is_held_against_every_device(self):
        found = self.findings(self.doctor(self.asset, "--simulated", "--json", "-"))
        for device in ("touch", "desktop", "premium", "premium-6dof"):
            self.assertIn("wall", found["workspace." + device]["found"])
            self.assertIn("N/mm", found["rendering." + device]["found"])

    def test_what_makes_no_sense_is_refused(self):
        self.assertEqual(self.doctor("--seconds", "0").returncode, 2)
        self.assertEqual(self.doctor("--seconds", "1e9").returncode, 2)
        text = self.folder / "text.vtkhdf"
        text.write_text("not an asset")
        self.assertEqual(self.doctor(text, "--simulated").returncode, 3)
        self.assertEqual(self.doctor(self.folder / "absent.vtkhdf").returncode, 3)
