# SPDX-License-Identifier: Apache-2.0
"""palpate-train --play in a real window: a recorded run is shown as it was, sought in, filmed; a ghost beside one's own."""

import json
import math
import shutil
import signal
import subprocess
import sys
import time
import unittest

import h5py
from ogg_theora import packets_of, read_theora
from trainer_case import SIZE, TIMELINE, TRAIN, TrainerCase, pixels_like

from x_server import XServer  # found by trainer_case

sys.path.insert(0, "../trust")
from forge import rehash  # noqa: E402

SECONDS = 3


def is_ghost(r, g, b):
    """(255, 178, 60), shaded, of which every other pixel is left out: half and half with the tissue where pixels are coarse."""
    return r > 120 and 0.5 * r < g < r and r - b > 80


class Playback(TrainerCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.run_file = cls.folder / "run.h5"
        cls.touch("--script", "press", "--seconds", SECONDS, "--virtual-clock", "--record", cls.run_file)
        with h5py.File(cls.run_file) as recorded:
            count = recorded["count/ticks"][0]
            cls.forces = recorded["ticks/force"][:count].tolist()
            cls.contacts = recorded["ticks/contact_count"][:count].tolist()
            positions = recorded["ticks/device_position"][:count].tolist()
        cls.peak = max(range(count), key=lambda tick: math.hypot(*cls.forces[tick]))
        cls.pressed = positions[cls.peak]

    @classmethod
    def touch(cls, *options, asset=None):
        subprocess.run([TRAIN.with_name("palpate-touch"), asset or cls.asset, *map(str, options)], check=True, capture_output=True)

    def train(self, *options, expect=0):
        run = subprocess.run([TRAIN, self.asset, "--json", "-", *map(str, options)], capture_output=True, text=True,
                             timeout=120, env=self.server.environment, cwd=self.folder)
        self.assertEqual(run.returncode, expect, run.stderr)
        return json.loads(run.stdout) if expect == 0 else run.stderr

    def close(self, process):
        self.x("xdotool", "key", "q")
        return self.finish(process)

    def assert_as_recorded(self, result):
        last = result["last"]
        self.assertEqual(last["force_n"], self.forces[last["tick"]])
        self.assertEqual(last["contacts"], self.contacts[last["tick"]])

    def place_of(self, tick):
        """Where a tick of the run lies on the timeline, pixels from the left."""
        return self.on_timeline(tick / (len(self.forces) - 1))

    def test_it_pauses_where_one_clicks_and_shows_the_recorded_force_of_that_moment(self):
        # So slow that it is not over before the first key comes, however slow the machine.
        process, window = self.open_window("--play", self.run_file, "--speed", 0.125)
        self.x("xdotool", "key", "space")
        for tick in (self.peak, len(self.forces) // 10):
            self.x("xdotool", "mousemove", "--window", window, round(self.place_of(tick)), TIMELINE)
            self.x("xdotool", "click", 1)
            time.sleep(0.6)
            self.assertAlmostEqual(self.head(window), self.place_of(tick), delta=3)
        self.x("xdotool", "mousemove", "--window", window, round(self.place_of(self.peak)) + 100, TIMELINE)
        self.x("xdotool", "mousedown", 1)
        self.x("xdotool", "mousemove", "--window", window, round(self.place_of(self.peak)), 100)  # dragged out of it
        time.sleep(0.3)
        self.x("xdotool", "mouseup", 1)
        time.sleep(0.6)
        result = self.close(process)
        self.assert_as_recorded(result)
        self.assertEqual(result["schema"], "palpate.train.playback/1")
        self.assertAlmostEqual(result["last"]["tick"], self.peak, delta=1.1 * len(self.forces) / SIZE[0] + 1)
        self.assertGreater(math.hypot(*result["last"]["force_n"]), 0.01)
        self.assertEqual((result["ticks"], result["missing_ticks"]), (1000 * SECONDS, 0))

    def test_keys_stop_step_and_change_the_speed(self):
        process, window = self.open_window("--play", self.run_file, "--speed", 0.125)
        self.x("xdotool", "key", "space", "Home")
        time.sleep(0.3)
        self.x("xdotool", "key", "Right", "Right", "Right", "period", "period", "Left")
        time.sleep(0.6)
        result = self.close(process)
        self.assert_as_recorded(result)
        self.assertEqual(result["speed"], 0.5)
        self.assertEqual(result["last"]["tick"], 0)  # three steps of 0.1 s on, one of 0.4 s back

    def test_it_goes_on_by_itself_to_the_end_and_no_servo_runs(self):
        result = self.train("--play", self.run_file, "--speed", 4, "--seconds", SECONDS)
        self.assert_as_recorded(result)
        self.assertEqual(result["last"]["tick"], 1000 * SECONDS - 1)
        self.assertGreater(result["shown_ticks"], 1)
        self.assertLessEqual(result["force_peak_n"], math.hypot(*self.forces[self.peak]) + 1e-12)
        self.assertNotIn("overruns", result)

    def test_a_video_has_a_picture_for_each_moment_whatever_the_machine(self):
        video = self.folder / "run.ogv"
        options = ("--play", self.run_file, "--video", video, "--film-rate", 20, "--speed", 2, "--size", "330x250")
        result = self.train(*options)
        pictures = 1 + math.floor((1000 * SECONDS - 1) / 1000 * 20 / 2)
        self.assertEqual(result["film"], {"pictures": pictures, "pictures_per_second": 20})
        self.assertEqual(read_theora(video.read_bytes()), (330, 250, pictures, 20))
        self.assertEqual(result["shown_ticks"], pictures)
        self.assertIn("exists already", self.train(*options, expect=3))
        self.train(*options, "--force")

    def test_pictures_of_a_film_are_all_there_or_none(self):
        folder = self.folder / "series"
        options = ("--play", self.run_file, "--pictures", folder, "--film-rate", 4, "--size", "320x240")
        result = self.train(*options)
        names = sorted(path.name for path in folder.iterdir())
        self.assertEqual(names, [f"{i:05}.png" for i in range(result["film"]["pictures"])])
        self.assertEqual(len(names), 1 + math.floor((1000 * SECONDS - 1) / 1000 * 4))
        self.assertNotEqual((folder / names[0]).read_bytes(), (folder / names[self.peak * 4 // 1000]).read_bytes())
        self.assertIn("exists already", self.train(*options, "--force", expect=3))
        self.assertEqual(len(list(folder.iterdir())), len(names))

    def test_a_film_that_is_broken_off_leaves_nothing(self):
        before = sorted(self.folder.iterdir())
        process, _ = self.open_window("--play", self.run_file, "--speed", 0.125, "--film-rate", 120,
                                      "--video", self.folder / "never.ogv", "--pictures", self.folder / "never")
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=30)
        self.assertEqual(process.returncode, 130)
        self.assertEqual(sorted(self.folder.iterdir()), before)

    def test_a_display_that_goes_away_ends_it_and_leaves_no_film(self):
        before = sorted(self.folder.iterdir())
        for film in ((), ("--speed", 0.125, "--video", self.folder / "never.ogv")):
            with XServer() as server:
                process = self.launch("--play", self.run_file, *film, environment=server.environment)
                subprocess.run(["xdotool", "search", "--sync", "--onlyvisible", "--name", "Palpate: sample"],
                               env=server.environment, check=True, capture_output=True, timeout=60)
                time.sleep(0.5)
                server.process.kill()
                _, err = process.communicate(timeout=30)
            self.assertEqual(process.returncode, 1, err)
            self.assertIn("went away", err)
        self.assertEqual(sorted(self.folder.iterdir()), before)

    def test_films_of_one_recording_are_the_same(self):
        films = []
        for name in ("one.ogv", "two.ogv"):
            self.train("--play", self.run_file, "--video", self.folder / name, "--film-rate", 10, "--size", "320x240")
            films.append(packets_of((self.folder / name).read_bytes()))  # a stream's serial number is drawn at random
        self.assertEqual(*films)

    def test_a_ghost_presses_beside_one_that_stays_away(self):
        far, near, held = self.folder / "far.txt", self.folder / "near.txt", self.folder / "held.h5"
        far.write_text("0 60 60 60\n10 60 60 60\n")
        # It stays where it is seen: how much time has passed when the picture is taken is the machine's affair.
        near.write_text("".join("{} {} {} {}\n".format(time, *self.pressed) for time in (0, 10)))
        self.touch("--script", near, "--seconds", 1, "--virtual-clock", "--record", held)
        pictures = {}
        exercise = ("--exercise", "touch", "--attempts", self.folder / "attempts")
        ghost = ("--ghost", held)
        for name, options in (("without", ()), ("freely", ghost), ("in an exercise", (*ghost, *exercise))):
            picture = self.folder / f"{name}.png"
            self.train("--script", far, *options, "--seconds", 1, "--screenshot", picture)
            dump = subprocess.run(["convert", picture, "-depth", "8", "rgb:-"], capture_output=True, check=True).stdout
            pictures[name] = len(pixels_like(dump, is_ghost))
        for name in ("freely", "in an exercise"):
            self.assertGreater(pictures[name], pictures["without"] + 200, name)

    def test_a_ghost_of_a_forceps_has_both_jaws(self):
        far, wide = self.folder / "far.txt", {}
        far.write_text("0 60 60 60\n10 60 60 60\n")
        x, y, z = self.pressed
        for name, degrees in (("open", 20), ("closed", 0)):
            hand, held, picture = (self.folder / f"{name}{ending}" for ending in (".txt", ".h5", ".png"))
            hand.write_text("".join(f"{time} {x} {y} {z + 4} 0 0 0 1 {degrees}\n" for time in (0, 10)))
            self.touch("--instrument", "forceps", "--jaw-length", 16, "--jaw-radius", 1, "--jaw-opening", 120, "--script", hand,
                       "--seconds", 1, "--virtual-clock", "--record", held)
            self.train("--script", far, "--ghost", held, "--seconds", 1, "--screenshot", picture)
            dump = subprocess.run(["convert", picture, "-depth", "8", "rgb:-"], capture_output=True, check=True).stdout
            columns = [i % 1280 for i in pixels_like(dump, is_ghost)]
            wide[name] = max(columns) - min(columns)
        # Closed jaws lie beside each other, open ones apart: by 2 x 16 mm x sin 10 degrees.
        self.assertGreater(wide["open"], wide["closed"] + 200)

    def test_a_ghost_is_played_back_too(self):
        result = self.train("--play", self.run_file, "--ghost", self.run_file, "--speed", 4, "--seconds", 1)
        first = self.contacts.index(next(count for count in self.contacts if count > 0))
        self.assertAlmostEqual(result["ghost"]["begins_s"], max(0, (first + 1) / 1000 - 1), delta=0.0015)

    def test_recordings_of_several_tools_show_the_one_that_is_asked_for(self):
        file, hand = self.folder / "two.h5", self.folder / "hand.txt"
        hand.write_text("0 60 60 60\n3 60 60 60\n")
        self.touch("--script", "press", "--second", hand, "--seconds", 1, "--virtual-clock", "--record", file)
        with h5py.File(file) as recorded:
            forces = recorded["ticks/force"][:2000].reshape(-1, 2, 3)
        for tool in (0, 1):
            film = ("--video", self.folder / f"tool{tool}.ogv", "--film-rate", 20, "--size", "320x240")
            result = self.train("--play", file, "--tool", tool, *film)
            shown = [math.hypot(*forces[50 * picture][tool]) for picture in range(result["film"]["pictures"])]
            self.assertAlmostEqual(result["force_peak_n"], max(shown), places=12)
            self.assertEqual(result["force_peak_n"] > 0.01, tool == 0)
        self.assertIn("tool 2", self.train("--play", file, "--tool", 2, expect=3))

    def test_misuse_is_refused(self):
        other, other_run = self.folder / "other.vtkhdf", self.folder / "other.h5"
        shutil.copy(self.asset, other)
        with h5py.File(other, "r+", libver=("v110", "v110")) as file:
            file["palpate/haptics"].attrs["max_force"] = 2.5
            rehash(file)
        self.touch("--script", "press", "--seconds", 0.1, "--virtual-clock", "--record", other_run, asset=other)
        for options, code, phrase in (
            (("--play", other_run), 3, "is of an asset of case"),
            (("--ghost", other_run), 3, "is of an asset of case"),
            (("--play", self.asset), 3, "sample.vtkhdf"),
            (("--play", self.run_file, "--script", "press"), 2, "--script"),
            (("--play", self.run_file, "--speed", 9), 2, "--speed"),
            (("--video", self.folder / "x.ogv"), 2, "--play"),
            (("--ghost", self.folder / "nothing.h5"), 3, "nothing.h5"),
        ):
            self.assertIn(phrase, self.train(*options, expect=code))


if __name__ == "__main__":
    unittest.main()
