# SPDX-License-Identifier: Apache-2.0
"""Devices from outside: a driver's library, a tracker, what goes wrong with them, and who looks on."""

import json
import math
import os
import shutil
import signal
import socket
import struct
import subprocess
import sys
import threading
import time
import unittest

import h5py
import numpy as np

sys.path.insert(0, "..")
import openigtlink  # noqa: E402
from device_run import (ASSET_REMOVED, BIN, DEVICE_LOST, FELT, PATIENCE, PRESS, RAMP, RAS, SLEW, TICK_LATE,  # noqa: E402
                        DeviceRun, wait_until)
from recorded import kept  # noqa: E402
from x_server import XServer  # noqa: E402


class Devices(DeviceRun):
    # A driver's device.

    def test_a_hand_on_a_driver_s_device_feels_the_organ(self):
        log = self.fresh(".csv")
        result, _ = self.result("--device", "openhaptics", "--seconds", 3, "--log", log,
                                environment=self.driver({"path": PRESS}))
        self.assertEqual(result["device"], "touch Default Device")
        self.assertEqual(result["script"], "none")
        self.assertGreater(result["force_peak_n"], 0.01)
        self.assertLessEqual(result["force_step_max_n"], SLEW)
        # The hand gives way by friction and force over its 0.3 N/mm.
        self.assertAlmostEqual(result["penetration"]["device_mm"], 7, delta=1)
        self.assertNotIn("starts_inside", result["statuses"])
        self.assertLessEqual({fault["fault"] for fault in result["faults"]}, {"tick_late"})  # a busy machine's
        time_s, force, _ = self.logged(log)
        self.assertEqual(force[0], 0)
        self.assertTrue((np.diff(time_s) > 0).all())

    def test_two_devices_of_one_driver_are_two_tools(self):
        beside = [[t, x + 6, y, z] for t, x, y, z in PRESS]
        environment = self.driver({"name": "A", "path": PRESS}, {"name": "B", "path": beside})
        log = self.fresh(".csv")
        result, _ = self.result("--device", "openhaptics:A,B", "--seconds", 3, "--log", log, environment=environment)
        self.assertEqual(result["device"], "touch A 'A'")
        self.assertGreater(result["force_peak_n"], 0.01)
        self.assertGreater(result["second"]["force_peak_n"], 0.01)
        apart = math.dist(result["peak"]["device_mm"], result["second"]["peak"]["device_mm"])
        self.assertAlmostEqual(apart, 6, delta=1)  # friction holds each of them a little beside its hand
        other, _ = self.result("--device", "openhaptics:B", "--seconds", 0.2, environment=environment)
        self.assertEqual(other["device"], "touch B 'B'")
        self.assertNotIn("second", other)

    def test_a_lone_device_is_opened_under_another_name_and_that_is_said(self):
        result, talk = self.result("--device", "openhaptics:Left", "--seconds", 0.2, environment=self.driver({}))
        self.assertEqual(result["device"], "touch Default Device, default device for 'Left'")
        self.assertIn("did not open a device by the name 'Left'", talk)

    def test_each_fault_is_said_once_takes_the_force_away_and_gives_it_back(self):
        named = [("warm_motors", "motors_warm"), ("disconnect", "device_lost"), ("not_a_number", "invalid_position"),
                 ("comm_error", "device_lost"), ("calibration_lost", "not_calibrated"), ("frozen_pose", "pose_frozen")]
        # A frozen pose is one after 0.1 s, a lost calibration after the next look, as late; the force is whole
        # again 0.52 s after the last tick of a fault.
        faults = [{"fault": fault, "from": 3 + i, "until": 3.3 + i} for i, (fault, _) in enumerate(named)]
        log = self.fresh(".csv")
        result, talk = self.result("--device", "openhaptics", "--body", "skull", "--seconds", 9.2, "--log",
                                   log, environment=self.driver({"path": PRESS, "faults": faults}))
        events = [fault for fault in result["faults"] if fault["fault"] != "tick_late"]
        self.assertEqual([event["fault"] for event in events], [fault for _, fault in named])
        for name in {fault for _, fault in named}:
            self.assertEqual(talk.count(f"({name}), so the force goes to zero"),
                             sum(event["fault"] == name for event in events))
        time_s, force, in_tick = self.logged(log)
        for event in events:
            with self.subTest(**event):
                self.assertEqual(event["tool"], 0)
                there = np.array([event["fault"] in faults for faults in in_tick])
                there &= (time_s > event["from_s"] - 1e-4) & (time_s < event["until_s"] + 1e-4)
                self.assert_no_force_while(there, force)
                after = (time_s > event["until_s"] + 0.1) & (time_s < event["until_s"] + 0.6)
                self.assertGreater(force[after].max(), FELT / 2)  # a busy machine may be late meanwhile
        self.assertLessEqual(result["force_step_max_n"], SLEW)

    def test_what_cannot_be_had_is_refused_with_cause_and_fix_and_leaves_nothing(self):
        without = {key: value for key, value in os.environ.items() if key != "PALPATE_HD_LIBRARY"}
        loaded = self.driver({"name": "A"}, {"name": "B"})
        inkwell, reset = ({"calibration": "needs_manual_input", "styles": [style]} for style in ("inkwell", "reset"))
        taken = socket.create_server(("127.0.0.1", 0))
        self.addCleanup(taken.close)
        default = ["--device", "openhaptics"]
        cases = [
            (without, default, 1, ["its library is not found", "PALPATE_HD_LIBRARY"]),
            (without | {"PALPATE_HD_LIBRARY": "/nowhere/libHD.so"}, default, 3,
             ["/nowhere/libHD.so: not found", "check the path"]),
            (without | {"PALPATE_HD_LIBRARY": str(self.asset)}, default, 3, ["sample.vtkhdf", "not a shared library"]),
            (self.driver({"refuse": "licence"}), default, 1, ["no licence", "install a licence"]),
            (self.driver({"refuse": "comm"}), default, 1, ["cannot talk to the device", "udev"]),
            (self.driver({"refuse": "comm_config"}), default, 1, ["configuration", "setup program"]),
            (self.driver(inkwell), default, 1, ["not calibrated", "put the stylus into its inkwell"]),
            (self.driver(reset), default, 1, ["not calibrated", "reset position"]),
            (loaded, ["--device", "openhaptics:A,C"], 1, ["device 'C'"]),
            (loaded, ["--device", "openhaptics:A,A"], 3, ["'A' is named twice"]),
            (loaded, ["--device", "openhaptics:"], 2, ["openhaptics:NAME"]),
            (loaded, ["--device", "openhaptics:A,"], 2, ["openhaptics:NAME"]),
            (loaded, [*default, "--script", "slide"], 2, ["--script: with --device openhaptics", "a simulated device"]),
            (loaded, [*default, "--depth", 2], 2, ["--depth: with --device openhaptics"]),
            (without, ["--device", "igtl:127.0.0.1"], 2, ["HOST:PORT"]),
            (without, ["--device", f"igtl:127.0.0.1:{openigtlink.free_port()}"], 3, ["refused", "start the server"]),
            (without, ["--stream", taken.getsockname()[1]], 1, ["in use", "choose another port"]),
        ]
        for environment, options, code, words in cases:
            with self.subTest(options=options, words=words):
                before = sorted(self.folder.iterdir())
                run = self.touch(*options, "--seconds", 0.1, "--log", self.folder / "no.csv", "--record",
                                 self.folder / "no.h5", "--curve", self.folder / "no.svg", environment=environment)
                self.assertEqual(run.returncode, code, run.stderr)
                for word in words:
                    self.assertIn(word, run.stderr)
                self.assertEqual(run.stderr.count("\n"), 1, run.stderr)
                self.assertEqual(sorted(self.folder.iterdir()), before)

    # A run that is stopped, frozen, or robbed of its asset.

    def test_an_interrupt_takes_the_force_to_zero_and_keeps_the_recording_alone(self):
        for how in (signal.SIGINT, signal.SIGTERM):
            with self.subTest(how=how.name):
                log = self.fresh(".csv")
                process, recording = self.begin("--device", "openhaptics", "--log", log,
                                                environment=self.driver({"path": PRESS}))
                self.wait_for_force(recording)
                before = sorted(self.folder.iterdir())
                self.assertIn("interrupted: the force has gone to zero", self.end(process, how))
                # Nothing but the log's unfinished rows has gone.
                gone = set(before) - set(self.folder.iterdir())
                self.assertTrue(all(path.name.endswith(log.name) for path in gone), gone)
                self.assertFalse(log.exists())
                self.assert_ended_without_force(recording)
                with h5py.File(recording) as file:
                    lost = file["count/lost_ticks"][0]
                replay, _ = self.result("--replay", recording)
                self.assertEqual(replay["replay"]["different_ticks"], 0)
                if lost == 0:
                    self.assertEqual(replay["replay"]["skipped_ticks"], 0)

    def test_the_force_is_away_while_the_asset_is_and_the_run_goes_on(self):
        asset, elsewhere = self.fresh(".vtkhdf"), self.fresh(".away")
        shutil.copy(self.asset, asset)
        process, recording = self.begin("--device", "openhaptics", asset=asset,
                                        environment=self.driver({"path": PRESS}))
        self.wait_for_force(recording)
        asset.rename(elsewhere)
        self.wait_for_fault(recording, ASSET_REMOVED)
        time.sleep(0.2)
        elsewhere.rename(asset)
        self.wait_for_force(recording)
        talk = self.end(process)
        force, faults = self.recorded(recording)
        self.assert_no_force_while((faults & ASSET_REMOVED) != 0, force)
        self.assertLessEqual(np.abs(np.diff(force)).max(), SLEW)
        self.assertEqual(talk.count("(asset_removed)"), 1)
        self.assertIn("put the file back", talk)

    def test_an_asset_cut_short_under_the_run_does_not_crash_it(self):
        asset = self.fresh(".vtkhdf")
        shutil.copy(self.asset, asset)
        process, recording = self.begin("--device", "openhaptics", asset=asset,
                                        environment=self.driver({"path": PRESS}))
        self.wait_for_force(recording)
        os.truncate(asset, 1000)
        self.wait_for_fault(recording, ASSET_REMOVED)
        ticks = len(self.recorded(recording)[0])
        wait_until(lambda: len(self.recorded(recording)[0]) > ticks + 300, "the run stood still")
        self.assertIn("(asset_removed)", self.end(process))
        force, faults = self.recorded(recording)
        self.assert_no_force_while((faults & ASSET_REMOVED) != 0, force)

    def test_a_run_that_was_asleep_wakes_without_force_and_takes_it_up_gently(self):
        for device, environment in ((["openhaptics"], self.driver({"path": PRESS})), (["premium", "--depth", 6], None)):
            with self.subTest(device=device):
                process, recording = self.begin("--device", *device, environment=environment)
                self.wait_for_force(recording)
                process.send_signal(signal.SIGSTOP)
                time.sleep(1)
                before = len(self.recorded(recording)[0])
                process.send_signal(signal.SIGCONT)
                self.wait_for_fault(recording, TICK_LATE, since=before)
                self.wait_for_force(recording)
                self.assertIn("(tick_late)", self.end(process))
                force, faults = self.recorded(recording)
                late = before + np.flatnonzero(faults[before:] & TICK_LATE)[0]
                self.assertLess(late - before, 20)  # the results that had not been taken when it fell asleep
                self.assertEqual(force[late + RAMP], 0)
                self.assertLessEqual(np.abs(np.diff(force)).max(), SLEW)
                self.assertEqual(force[-1], 0)

    # OpenIGTLink.

    def test_a_session_is_seen_live_in_ras(self):
        port = openigtlink.free_port()
        process, recording = self.begin("--stream", f"127.0.0.1:{port}")
        wait_until(lambda: len(self.recorded(recording)[0]) > 0, "the run did not start")
        tool, force, status = None, 0, None
        with socket.create_connection(("127.0.0.1", port), timeout=PATIENCE) as connection:
            while tool is None or force < FELT or status is None:
                kind, device, body = openigtlink.receive(connection)
                if kind == "TRANSFORM":
                    *axes, translation = np.array(struct.unpack(">12f", body)).reshape(4, 3)
                if (kind, device) == ("TRANSFORM", "PalpateTool"):
                    tool = translation
                if (kind, device) == ("TRANSFORM", "PalpateForce"):
                    force = np.linalg.norm(axes[2])
                if (kind, device) == ("STATUS", "PalpateStatus"):
                    status, = struct.unpack(">H", body[:2])
            process.send_signal(signal.SIGINT)
            with self.assertRaises(ConnectionError):  # at the end of a message or within one
                while True:
                    openigtlink.receive(connection)
        process.communicate(timeout=10)
        self.assertEqual(process.returncode, 130)
        self.assertIn(status, (1, 2))  # all is well, or a busy machine's tick_late
        lps = tool * RAS
        self.assertLess(np.abs(kept(recording, "ticks/tool_position") - lps).max(axis=1).min(), 1e-4)
        peak = np.linalg.norm(kept(recording, "ticks/force"), axis=1)
        self.assertLess(np.abs(peak - force).min(), 1e-4)

    def test_a_tracker_s_pose_in_ras_moves_the_tool_in_lps(self):
        target = self.result("--virtual-clock", "--body", "skull", "--seconds", 0.001)[0]["target"]
        point, normal = np.array(target["point_mm"]), np.array(target["normal"])
        outside, inside = 6.5, -1.5  # above the point, mm, of a tip of 1.5 mm: 5 mm clear, 3 mm deep
        tip = {"height": outside}  # None: the tracker sees nothing
        stop = threading.Event()

        def serve(server):
            connection, _ = server.accept()
            damaged = bytearray(openigtlink.transform("Stylus", (0, 0, 0)))
            damaged[-1] ^= 1
            with connection:
                while not stop.wait(0.005):
                    if (height := tip["height"]) is not None:
                        connection.sendall(openigtlink.transform("Other", (0, 0, 500)) + damaged
                                           + openigtlink.transform("Stylus", (point + height * normal) * RAS))

        with socket.create_server(("127.0.0.1", 0)) as server:
            server.settimeout(PATIENCE)
            thread = threading.Thread(target=serve, args=[server])
            thread.start()
            try:
                process, recording = self.begin("--device", f"igtl:127.0.0.1:{server.getsockname()[1]}/Stylus")
                wait_until(lambda: len(self.recorded(recording)[0]) > 0, "the run did not start")
                for tip["height"] in np.linspace(outside, inside, 100):
                    time.sleep(0.005)
                self.wait_for_force(recording)
                tip["height"] = None
                self.wait_for_fault(recording, DEVICE_LOST)
                tip["height"] = inside
                self.wait_for_force(recording)
            finally:
                stop.set()
                thread.join()
        self.assertIn("(device_lost)", self.end(process))
        force, faults = self.recorded(recording)
        self.assert_no_force_while((faults & DEVICE_LOST) != 0, force)
        place = kept(recording, "ticks/device_position") - point
        height = place @ normal
        self.assertLess(np.abs(place - np.outer(height, normal)).max(), 1e-4)  # float32 on the wire
        self.assertAlmostEqual(height.min(), inside, delta=1e-4)
        with h5py.File(recording) as file:
            self.assertIn("'Stylus'", file["devices/name"][0].decode())

    # The other commands.

    def test_the_doctor_looks_at_a_driver_s_device(self):
        def findings(**device):
            run = subprocess.run(
                [BIN / "palpate-doctor", "--seconds", "0.1", "--simulated", "--device", "openhaptics", "--json", "-"],
                capture_output=True, text=True, timeout=60, env=self.driver(device))
            found = {finding["id"]: finding for finding in json.loads(run.stdout)["findings"]}
            return run.returncode, found

        code, found = findings()
        self.assertEqual(code, 0)
        self.assertEqual(found["name"]["found"], "touch Default Device")
        self.assertEqual(found["pose"]["level"], "ok")
        self.assertIn("1000 Hz", found["limits"]["found"])

        code, found = findings(faults=[{"fault": "frozen_pose"}])
        self.assertEqual(code, 4)
        self.assertEqual(found["pose"]["level"], "problem")
        self.assertIn("pose_frozen", found["faults"]["found"])
        self.assertIn("unplug", found["pose"]["fix"])

        code, found = findings(refuse="licence")
        self.assertEqual(code, 4)
        self.assertIn("licence", found["device"]["found"])


@unittest.skipUnless((BIN / "palpate-train").exists(), "PALPATE_VISUAL is off")
@unittest.skipUnless(shutil.which("Xvfb") and shutil.which("convert"), "PALPATE: xvfb or imagemagick is missing")
class HeldTrainer(DeviceRun):
    def train(self, *options, devices):
        with XServer() as server:
            run = subprocess.run([BIN / "palpate-train", self.asset, *map(str, options), "--json", "-"], capture_output=True, text=True,
                                 timeout=60, env=self.driver(*devices, DISPLAY=server.environment["DISPLAY"]))
        self.assertEqual(run.returncode, 0, run.stderr)
        return json.loads(run.stdout)

    def test_two_devices_of_one_driver_hold_two_tools(self):
        # The device's axes are the screen's: z comes out of it, and the surface faces the eye within 45 degrees.
        into_screen = [[0, 0, 0, 0], [3, 0, 0, 0], [4, 0, 0, -20], [100, 0, 0, -20]]
        beside = [[t, x + 5, y, z] for t, x, y, z in into_screen]
        recording = self.fresh(".h5")
        result = self.train("--device", "openhaptics:A,B", "--seconds", 6, "--record", recording,
                            devices=[{"name": "A", "path": into_screen}, {"name": "B", "path": beside}])
        self.assertEqual(result["device"], "touch A 'A'")
        force, tool = (kept(recording, f"ticks/{column}") for column in ("force", "tool"))
        for which in (0, 1):
            self.assertGreater(np.linalg.norm(force[tool == which], axis=1).max(), 0.01, which)

    def test_a_tool_is_drawn_along_the_stylus(self):
        pictures = []
        for shaft in ([0, 0, 1], [1, 0, 0], [1, 0, 0]):
            path = self.fresh(".png")
            self.train("--device", "openhaptics", "--exercise", "free", "--seconds", 2, "--screenshot", path, devices=[{"shaft": shaft}])
            rgb = subprocess.run(["convert", path, "-gravity", "south", "-crop", "100%x25%+0+0", "-depth", "8", "rgb:-"], check=True,
                                 capture_output=True).stdout
            pictures.append(np.frombuffer(rgb, np.uint8).astype(int))
        out_of_screen, across, again = pictures
        self.assertGreater(np.abs(out_of_screen - across).mean(), 3 * max(np.abs(again - across).mean(), 0.05))


class WeakDevices(DeviceRun):
    variant = ("stiffness",)

    def test_what_a_device_loses_in_its_joints_is_warned_of_with_what_to_do(self):
        for device, told in (("touch", True), ("premium", False)):
            _, talk = self.result("--device", device, "--virtual-clock", "--seconds", 0.1)
            self.assertEqual("the joints of a Touch lose 0.26 N: it is felt from 14 mm on" in talk, told, talk)


if __name__ == "__main__":
    unittest.main()
