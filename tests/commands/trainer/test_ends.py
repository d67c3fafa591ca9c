# SPDX-License-Identifier: Apache-2.0
"""Every way in which a trainer's run ends: the force has gone to zero, recording and attempt are whole."""

import ctypes
import json
import signal
import subprocess
import time
import unittest

import h5py
import numpy as np

from trainer_case import TRAIN, TrainerCase
from device_run import DEVICE_LOST, FELT, RAMP, SERVO_STOPPING, SLEW, TESTS, VISUAL_STOPPED, DeviceRun
from x_server import XServer

# The sample's skull is a ball of 15 mm about (40, 10, 10) mm, its tool one of 1.5 mm: 5 mm above it, then 4 mm deep to stay.
HELD = [(0, 40, 10, 31.5), (0.5, 40, 10, 31.5), (1, 40, 10, 22.5), (100, 40, 10, 22.5)]
# A driver's device at rest in free space, which is pulled out for a second.
PULLED_OUT = {"path": [[0, 0, 0, 0], [100, 0, 0, 0]], "faults": [{"fault": "disconnect", "from": 2, "until": 3}]}
# One that presses on the skull, towards which the first view looks, and is pulled out for good.
PULLED_OUT_OF_A_PRESS = {"path": [[0, 0, 0, 0], [6, 0, 0, 0], [6.5, 0, 0, -12], [1000, 0, 0, -12]],
                         "faults": [{"fault": "disconnect", "from": 24, "until": 1000}]}


def ask_to_close(display, window):
    """What a window manager sends where its button is clicked."""
    x11 = ctypes.CDLL("libX11.so.6")
    x11.XOpenDisplay.restype = ctypes.c_void_p
    x11.XInternAtom.argtypes = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int]
    x11.XInternAtom.restype = ctypes.c_ulong
    x11.XSendEvent.argtypes = [ctypes.c_void_p, ctypes.c_ulong, ctypes.c_int, ctypes.c_long, ctypes.c_void_p]
    x11.XCloseDisplay.argtypes = [ctypes.c_void_p]
    connection = x11.XOpenDisplay(display.encode())
    protocols, delete = (x11.XInternAtom(connection, name, 0) for name in (b"WM_PROTOCOLS", b"WM_DELETE_WINDOW"))
    event = (ctypes.c_long * 24)()  # an XEvent: type, serial, send_event, display, window, message_type, format, data
    event[0], event[4], event[5], event[6], event[7] = 33, window, protocols, 32, delete
    x11.XSendEvent(connection, window, 0, 0, event)
    x11.XCloseDisplay(connection)


class Ends(DeviceRun, TrainerCase):
    def begin_exercise(self, *options, environment=None, device=False):
        """A trainer in the middle of an attempt whose hand, or a driver's device, presses on the skull, and its recording."""
        hand = self.fresh(".txt")
        np.savetxt(hand, HELD)
        held = ("--device", "openhaptics", "--body", "skull") if device else ("--script", hand)
        self.attempts = self.fresh("-attempts")
        recording = self.fresh(".h5")
        process = self.launch("--exercise", "free", "--attempts", self.attempts, "--trainee", "T-1", *held,
                              "--record", recording, "--record-seconds", 60, *options, environment=environment)
        self.wait_for_force(recording)
        return process, recording

    def assert_ended_in_order(self, process, recording, code):
        """Returns what the trainer said."""
        _, err = process.communicate(timeout=30)
        self.assertEqual(process.returncode, code, err)
        force, faults = self.recorded(recording)
        stopping = np.flatnonzero(faults & SERVO_STOPPING)
        self.assertGreater(len(stopping), RAMP)
        self.assertGreater(force.max(), FELT)  # not just before: a busy machine's faults may have taken it away already
        self.assertTrue((np.diff(force[stopping]) <= 0).all())
        self.assertEqual(force[-1], 0)
        replay, _ = self.result("--replay", recording)
        self.assertEqual(replay["replay"]["different_ticks"], 0)
        with h5py.File(recording) as file:
            if file["count/lost_ticks"][0] == 0:
                self.assertEqual(replay["replay"]["missing_ticks"], 0)
        (attempt,) = [json.loads(path.read_text()) for path in (self.attempts / "T-1").glob("*.json")]
        self.assertEqual(attempt["ending"], "cut short")
        self.assertGreater(attempt["metrics"]["peak_force_n"], FELT)
        return err

    def test_a_closed_window(self):
        for how in ("q", "its button"):
            with self.subTest(how=how):
                process, recording = self.begin_exercise()
                window = self.find_window()
                if how == "q":
                    self.x("xdotool", "key", "q")
                else:
                    ask_to_close(self.server.environment["DISPLAY"], int(window))
                self.assert_ended_in_order(process, recording, 0)

    def test_a_device_that_was_pulled_out_and_in_again_ends_nothing(self):
        environment = self.driver(PULLED_OUT, DISPLAY=self.server.environment["DISPLAY"])
        recording = self.fresh(".h5")
        run = subprocess.run(
            [TRAIN, self.asset, "--exercise", "free", "--attempts", self.fresh("-attempts"), "--device", "openhaptics",
             "--seconds", "6", "--record", recording, "--json", "-"],
            capture_output=True, text=True, timeout=60, env=environment)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual(run.stderr.count("(device_lost), so the force goes to zero"), 1)
        result = json.loads(run.stdout)
        (lost,) = [fault for fault in result["faults"] if fault["fault"] == "device_lost"]
        self.assertAlmostEqual(lost["until_s"] - lost["from_s"], 1, delta=0.3)
        force, faults = self.recorded(recording)
        there = (faults & DEVICE_LOST) > 0
        self.assert_no_force_while(there, force)
        self.assertTrue((faults[np.flatnonzero(there)[-1] + 1 :] & SERVO_STOPPING).any())

    def test_a_device_that_was_pulled_out_while_it_pressed(self):
        environment = self.driver(PULLED_OUT_OF_A_PRESS, DISPLAY=self.server.environment["DISPLAY"])
        process, recording = self.begin_exercise(environment=environment, device=True)
        self.find_window()
        self.wait_for_fault(recording, DEVICE_LOST)
        self.x("xdotool", "key", "q")
        self.assertEqual(self.assert_ended_in_order(process, recording, 0).count("(device_lost), so the force goes to zero"), 1)
        force, faults = self.recorded(recording)
        self.assert_no_force_while((faults & DEVICE_LOST) > 0, force)
        self.assertLessEqual(np.abs(np.diff(force)).max(), SLEW)

    def test_a_display_that_stood_still_ends_nothing(self):
        with XServer() as server:
            process, recording = self.begin_exercise(environment=server.environment)
            server.process.send_signal(signal.SIGSTOP)
            time.sleep(4)
            server.process.send_signal(signal.SIGCONT)
            self.wait_for_fault(recording, VISUAL_STOPPED)
            self.wait_for_force(recording)
            process.send_signal(signal.SIGINT)
            self.assertIn("(visual_stopped), so the force goes to zero", self.assert_ended_in_order(process, recording, 130))
        force, faults = self.recorded(recording)
        self.assert_no_force_while((faults & VISUAL_STOPPED) > 0, force)

    def test_a_signal(self):
        for how in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            with self.subTest(how=how.name):
                process, recording = self.begin_exercise()
                process.send_signal(how)
                self.assertIn("the force has gone to zero", self.assert_ended_in_order(process, recording, 130))

    def test_a_display_that_went_away(self):
        for how in (signal.SIGTERM, signal.SIGKILL):
            with self.subTest(how=how.name), XServer() as server:
                process, recording = self.begin_exercise(environment=server.environment)
                server.process.send_signal(how)
                err = self.assert_ended_in_order(process, recording, 1)
                self.assertIn("display or window went away", err)
                self.assertIn("the force has gone to zero", err)

    def test_nothing_is_waited_for_in_a_window_that_is_gone(self):
        run = subprocess.run([TESTS / "lose_window"], env=self.server.environment, capture_output=True, text=True, timeout=30)
        self.assertEqual((run.returncode, run.stdout), (0, "lost\n"), run.stderr)

    def test_a_window_that_another_program_took_away(self):
        for how in ("windowclose", "windowkill"):
            with self.subTest(how=how):
                process, recording = self.begin_exercise()
                self.x("xdotool", "search", "--sync", "--onlyvisible", "--name", "Palpate: sample", how)
                self.assert_ended_in_order(process, recording, 1)


if __name__ == "__main__":
    unittest.main()
