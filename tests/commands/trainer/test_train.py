# SPDX-License-Identifier: Apache-2.0
"""palpate-train under a real X server, driven with mouse and keyboard as a person would."""

import json
import os
import signal
import subprocess
import time
import unittest

import h5py
import numpy as np

from trainer_case import TRAIN, OpenedTrainer, difference, is_whole, yellow_pixels

ON_THE_ORGAN = 760, 250  # pixels of the first view


class Train(OpenedTrainer):
    def run_train(self, *options, environment=None):
        return subprocess.run(
            [TRAIN, *map(str, options)],
            capture_output=True,
            text=True,
            timeout=60,
            env=environment or self.server.environment,
        )

    def colours(self, window):
        """How many colours the window on the screen has."""
        dump = self.screen(window)
        picture = self.folder / "window.png"
        subprocess.run(["convert", "xwd:-", f"png:{picture}"], input=dump, check=True)
        return self.colours_of(picture)

    def colours_of(self, picture):
        counted = subprocess.run(["convert", picture, "-format", "%k", "info:"], capture_output=True, check=True)
        return int(counted.stdout)

    def test_t_shows_and_hides_the_enclosed_tumour(self):
        process, window = self.open_window()
        before = yellow_pixels(self.screen(window))
        for as_it_is_due in (lambda yellow: yellow > before + 500, lambda yellow: yellow < before + 100):
            self.x("xdotool", "key", "t")
            self.wait_for(lambda: as_it_is_due(yellow_pixels(self.screen(window))))
        self.x("xdotool", "key", "q")
        self.finish(process)

    def test_p_writes_a_picture_of_the_window_beside_those_there_are(self):
        process, _ = self.open_window("--size", "640x360")
        for name in ("palpate-sample-1.png", "palpate-sample-2.png"):
            self.x("xdotool", "key", "p")
            self.wait_for(lambda: is_whole(self.folder / name))
            header = (self.folder / name).read_bytes()[:24]
            self.assertEqual((int.from_bytes(header[16:20], "big"), int.from_bytes(header[20:24], "big")), (640, 360))
        self.x("xdotool", "key", "q")
        self.finish(process)

    def test_keys_drive_the_tool_into_the_organ_and_q_closes(self):
        process, window = self.open_window()
        for _ in range(40):  # half a millimetre each, from 5 mm above the surface
            self.x("xdotool", "key", "w")
        self.come_to_rest()
        self.assertGreater(self.colours(window), 500)
        self.x("xdotool", "key", "q")
        result = self.finish(process)
        self.assertEqual(result["schema"], "palpate.train/1")
        self.assertGreater(result["ticks"], 500)
        self.assertGreater(result["frames"], 5)
        self.assertGreater(result["frames_per_second"], 1)
        self.assertGreater(result["first_frame_s"], 0)
        self.assertGreater(result["device_travel_mm"], 10)
        self.assertGreater(result["force_peak_n"], 0.01)
        self.assertNotIn("starts_inside", result["statuses"])

    def test_keys_hold_a_simulated_device_that_gives_way(self):
        process, window = self.open_window("--device", "premium")
        for _ in range(16):  # half a millimetre each, from 5 mm above the surface: 3 mm deep
            self.x("xdotool", "key", "w")
        self.come_to_rest()
        self.x("xdotool", "key", "q")
        result = self.finish(process)
        self.assertEqual(result["device"], "simulated premium, guided by mouse and keyboard")
        self.assertGreater(result["force_peak_n"], 0.01)
        self.assertGreater(result["device_travel_mm"], 6)
        self.assertLess(result["penetration"]["device_mm"], 4)

    def test_a_script_holds_a_simulated_device(self):
        for script in ("tremble", "let-go"):
            recording = self.folder / f"{script}.h5"
            run = self.run_train(
                self.asset, "--script", script, "--device", "desktop", "--seconds", "2", "--json", "-", "--record", recording
            )
            self.assertEqual(run.returncode, 0, run.stderr)
            result = json.loads(run.stdout)
            self.assertEqual(result["device"], "simulated desktop, scripted hand")
            self.assertGreater(result["force_peak_n"], 0.01)
            with h5py.File(recording) as recorded:
                count = recorded["count/ticks"][0]
                positions = recorded["ticks/device_position"][:count]
                touching = recorded["ticks/contact_count"][:count] > 0
            # From 5 mm outside the hand goes 3 mm deep and is there for most of the time; it gives way by 0.3 N/mm. The median,
            # for a servo that other programs starve has moments without force.
            depth = np.linalg.norm(positions - positions[0], axis=1) - 5
            self.assertLess(np.median(depth[touching]), 2.95)

    def test_a_second_tool_is_felt_shown_and_recorded_beside_the_first(self):
        second, recording = self.folder / "second.txt", self.folder / "both.h5"
        second.write_text("0 40 10 30\n0.5 40 10 24\n2 40 10 24\n")  # down onto the skull, beside the organ
        options = [self.asset, "--script", "press", "--seconds", 2, "--json", "-", "--force"]
        pictures = [self.folder / "alone.png", self.folder / "both.png"]
        alone = self.run_train(*options, "--screenshot", pictures[0])
        both = self.run_train(*options, "--screenshot", pictures[1], "--second", second, "--record", recording)
        self.assertEqual((alone.returncode, both.returncode), (0, 0), both.stderr)
        alone, both = json.loads(alone.stdout), json.loads(both.stdout)
        self.assertGreater(both["force_peak_n"], 2 * alone["force_peak_n"], "bone is harder")
        self.assertEqual(both["recording"]["rows"] + both["recording"]["lost_rows"], 2 * both["ticks"])
        self.assertNotEqual(pictures[0].read_bytes(), pictures[1].read_bytes())
        with h5py.File(recording) as recorded:
            count = recorded["count/ticks"][0]
            depth = recorded["ticks/depth"][:count][recorded["ticks/tool"][:count] == 0]
        # Where the script holds the first tool for half a second, which a servo that starves does not miss.
        self.assertAlmostEqual(depth.max(), alone["penetration"]["device_mm"], places=2)

    def test_what_the_hand_did_is_recorded_and_replays(self):
        recording = self.folder / "trained.h5"
        process, _ = self.open_window("--record", recording, "--record-seconds", 60)
        for _ in range(30):
            self.x("xdotool", "key", "w")
        self.x("xdotool", "key", "q")
        result = self.finish(process)
        self.assertEqual(result["recording"]["rows"] + result["recording"]["lost_rows"], result["ticks"])
        touch = subprocess.run(
            [TRAIN.with_name("palpate-touch"), self.asset, "--replay", recording, "--json", "-"],
            capture_output=True, text=True, timeout=60)
        self.assertEqual(touch.returncode, 0, touch.stderr)
        replayed = json.loads(touch.stdout)
        self.assertEqual(replayed["replay"]["different_ticks"], 0)
        self.assertEqual(replayed["force_peak_n"], result["force_peak_n"])

    def drag(self, button, dx, dy, steps=10):
        """Drags from where the pointer is, steps times dx, dy pixels, and returns the scene's picture then."""
        self.x("xdotool", "mousedown", button)
        for _ in range(steps):
            self.x("xdotool", "mousemove_relative", "--", dx, dy)
            time.sleep(0.05)
        self.come_to_rest()
        self.x("xdotool", "mouseup", button)
        return self.come_to_rest()

    def test_the_left_button_presses_and_drags_with_every_simulated_device(self):
        for device in ([], ["--device", "touch"], ["--device", "desktop"], ["--device", "premium"]):
            process, window = self.open_window(*device)
            self.x("xdotool", "mousemove", "--window", window, *ON_THE_ORGAN)
            self.come_to_rest()
            self.drag(1, 4, 2)
            self.x("xdotool", "key", "q")
            result = self.finish(process)
            self.assertGreater(result["force_peak_n"], 0.02, device)
            self.assertGreater(result["penetration"]["device_mm"], 1, device)
            self.assertLess(result["penetration"]["device_mm"], 5, device)
            self.assertNotIn("starts_inside", result["statuses"])

    def test_the_wheel_presses_deeper_while_the_button_is_held(self):
        depth = {}
        for notches in (0, 4):  # half a millimetre each
            process, window = self.open_window()
            self.x("xdotool", "mousemove", "--window", window, *ON_THE_ORGAN)
            self.x("xdotool", "mousedown", 1)
            self.come_to_rest()
            for _ in range(notches):
                self.x("xdotool", "click", 4)
            self.come_to_rest()
            self.x("xdotool", "mouseup", 1)
            self.x("xdotool", "key", "q")
            depth[notches] = self.finish(process)["penetration"]["device_mm"]
        self.assertAlmostEqual(depth[4] - depth[0], 2, delta=0.3)

    def test_the_pointer_alone_touches_nothing(self):
        process, window = self.open_window()
        for x, y in ((500, 300), ON_THE_ORGAN, (800, 500)):
            self.x("xdotool", "mousemove", "--window", window, x, y)
            self.come_to_rest()
        self.x("xdotool", "key", "q")
        result = self.finish(process)
        self.assertGreater(result["device_travel_mm"], 1)
        self.assertEqual(result["force_peak_n"], 0)

    def test_what_moves_the_view_leaves_the_tool_where_it_is(self):
        for button, modifier in ((3, None), (2, None), (1, "shift"), (1, "ctrl"), (3, "ctrl")):
            process, _ = self.open_window()
            before = self.come_to_rest()
            if modifier:
                self.x("xdotool", "keydown", modifier)
            moved = self.drag(button, -8, -8)
            if modifier:
                self.x("xdotool", "keyup", modifier)
            self.assertGreater(difference(before, moved), 5, (button, modifier))
            self.x("xdotool", "key", "Escape")
            self.assertEqual(self.finish(process)["device_travel_mm"], 0, (button, modifier))

    def test_keys_step_and_reset_brings_back(self):
        process, _ = self.open_window()
        for _ in range(10):  # half a millimetre each, away from the organ
            self.x("xdotool", "key", "s")
        self.come_to_rest()
        self.x("xdotool", "key", "r")
        self.come_to_rest()
        self.x("xdotool", "key", "q")
        self.assertAlmostEqual(self.finish(process)["device_travel_mm"], 10, delta=0.5)

    def test_scripted_run_closes_by_itself_and_leaves_a_picture(self):
        picture = self.folder / "press.png"
        options = [self.asset, "--script", "press", "--seconds", "2", "--screenshot", picture, "--json", "-"]
        run = self.run_train(*options, "--size", "640x360")
        self.assertEqual(run.returncode, 0, run.stderr)
        result = json.loads(run.stdout)
        self.assertGreater(result["force_peak_n"], 0.01)
        self.assertAlmostEqual(result["penetration"]["device_mm"], 3, places=2)
        self.assertGreater(self.colours_of(picture), 300)
        header = picture.read_bytes()[:24]
        self.assertEqual(header[:8], b"\x89PNG\r\n\x1a\n")
        self.assertEqual((int.from_bytes(header[16:20], "big"), int.from_bytes(header[20:24], "big")), (640, 360))
        self.assertEqual(self.run_train(*options).returncode, 3, "an existing picture was replaced")

    def test_interrupt_ends_with_130_and_leaves_nothing(self):
        picture = self.folder / "never.png"
        process, _ = self.open_window("--screenshot", picture)
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=30)
        self.assertEqual(process.returncode, 130)
        self.assertFalse(picture.exists())

    def test_without_a_display_the_remedy_is_named(self):
        for display in ({}, {"DISPLAY": ":9999"}):
            environment = {k: v for k, v in os.environ.items() if k != "DISPLAY"} | display
            run = self.run_train(self.asset, environment=environment)
            self.assertEqual(run.returncode, 1)
            self.assertIn("xvfb-run", run.stderr)

    def test_bad_arguments_are_refused(self):
        cases = [
            ([self.asset, "--size", "wide"], 2, "WIDTHxHEIGHT"),
            ([self.asset, "--size", "10x10"], 2, "320x240"),
            ([self.asset, "--script", "dance"], 3, "press, slide"),
            ([self.asset, "--body", "spleen"], 2, "spleen"),
            ([self.asset, "--device", "omni"], 2, "touch, desktop, premium, premium-6dof"),
            ([self.asset, "--script", "let-go"], 2, "--device"),
            ([self.folder / "nothing.vtkhdf"], 3, "nothing.vtkhdf"),
        ]
        for options, code, words in cases:
            run = self.run_train(*options)
            self.assertEqual(run.returncode, code, run.stderr)
            self.assertIn(words, run.stderr)


if __name__ == "__main__":
    unittest.main()
