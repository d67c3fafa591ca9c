# SPDX-License-Identifier: Apache-2.0
"""Exercises of palpate-train in a real window: a good, a clumsy and an idle hand, keys and mouse."""

import json
import math
import shutil
import subprocess
import time
import unittest

import numpy as np

from trainer_case import TIMELINE, TRAIN, TrainerCase, yellow_pixels
from recorded import kept  # found by trainer_case

RADIUS = 1.5  # mm, of the sample's tool; the cube's free top is at z = 20 mm


def pressing(places, depth, hold=0.8):
    """A hand that presses place by place, straight down: rows t, x, y, z."""
    rows, t = [], 0.0
    for x, y, _ in places:
        for dt, z in ((0.3, 20 + RADIUS + 4), (0.3, 20 + RADIUS - depth), (hold, 20 + RADIUS - depth), (0.3, 20 + RADIUS + 4)):
            rows.append((t := t + dt, x, y, z))
    return [(0, *rows[0][1:])] + rows


def following(line, depth, aside=0.0):
    """A hand that follows the line of places under steady depth."""
    x, y, _ = line[0]
    rows = [(0, x, y, 25), (0.5, x, y, 20 + RADIUS - depth)]
    rows += [(1 + 1.5 * i, x, y + aside, 20 + RADIUS - depth) for i, (x, y, _) in enumerate(line)]
    return rows


class Exercises(TrainerCase):
    def setUp(self):
        self.attempts = self.folder / self.id()

    def kept(self):
        return "--attempts", self.attempts, "--trainee", "T-1"

    def command(self, *options):
        return [TRAIN, self.asset, "--json", "-", *map(str, (*self.kept(), *options))]

    def hand(self, rows):
        path = self.folder / "hand.txt"
        path.write_text("\n".join(" ".join(f"{value:.4f}" for value in row) for row in rows))
        return path, rows[-1][0] + 0.5

    def train(self, *options):
        run = subprocess.run(
            self.command(*options), capture_output=True, text=True, timeout=90, env=self.server.environment
        )
        self.assertEqual(run.returncode, 0, run.stderr)
        return json.loads(run.stdout)

    def with_hand(self, exercise, rows, *options):
        path, seconds = self.hand(rows)
        (attempt,) = self.train("--exercise", exercise, "--script", path, "--seconds", seconds, *options)["attempts"]
        return attempt

    def laid_out(self, exercise, *options):
        return self.with_hand(exercise, [(0, 50, 50, 50), (0.1, 50, 50, 50)], *options)["exercise"]

    def open_window(self, *options):
        return super().open_window(*self.kept(), *options)

    def finish(self, process):
        return super().finish(process)["attempts"]

    def begun_at(self, attempt):
        rows = (self.attempts / "T-1" / attempt["file"]).with_suffix(".csv").read_text().splitlines()
        return np.array([float(value) for value in rows[1].split(",")[1:4]])  # behind the time

    def small_marks(self):
        path = self.folder / "marks.toml"
        path.write_text(
            'schema = 1\n[[exercise]]\nname = "touch"\ntask = "touch"\ntolerance_mm = 2\nhold_s = 0.4\n'
            "most_force_n = 0.15\nleast_force_n = 0.005\ntime_limit_s = 60\n"
            "places_mm = [[6, 6, 20], [14, 7, 20], [10, 14, 20]]\n"
        )
        return "--exercises", path

    def test_a_good_hand_touches_all_marks_gently(self):
        exercise = self.small_marks()
        places = self.laid_out("touch", *exercise)["places_mm"]
        # Held for longer than the marks ask, so that a force that a starved servo took away has come back in half a second.
        attempt = self.with_hand("touch", pressing(places, 1, hold=2), *exercise)
        self.assertEqual(attempt["ending"], "all reached")
        self.assertGreater(attempt["metrics"]["score"], 95)
        self.assertEqual(attempt["metrics"]["misses"], 0)
        self.assertLess(attempt["metrics"]["position_error_mm"], 1.5)

    def test_a_clumsy_hand_hurts_and_misses(self):
        exercise = self.small_marks()
        places = self.laid_out("touch", *exercise)["places_mm"]
        beside = [places[0], [13, 13, 20], places[1], [6, 13, 20], places[2]]
        attempt = self.with_hand("touch", pressing(beside, 7), *exercise)
        self.assertEqual(attempt["ending"], "all reached")
        self.assertLess(attempt["metrics"]["score"], 60)
        self.assertGreaterEqual(attempt["metrics"]["misses"], 2)
        self.assertGreater(attempt["metrics"]["time_above_limit_s"], 1)

    def test_an_idle_hand_gets_nothing(self):
        for name in ("touch", "find", "trace"):
            attempt = self.with_hand(name, [(0, 50, 50, 50), (1, 50, 50, 50)])
            self.assertEqual(attempt["ending"], "cut short")
            self.assertEqual(attempt["metrics"]["score"], 0, name)

    def test_a_line_is_followed_by_a_steady_hand_and_not_by_one_beside_it(self):
        path = self.folder / "line.toml"
        path.write_text(
            'schema = 1\n[[exercise]]\nname = "trace"\ntask = "trace"\ntolerance_mm = 2\n'
            "places_mm = [[4, 6, 20], [10, 8, 20], [16, 6, 20]]\n"
        )
        exercise = "--exercises", path
        line = self.laid_out("trace", *exercise)["places_mm"]
        good = self.with_hand("trace", following(line, 1.5), *exercise)
        self.assertEqual(good["ending"], "all reached")
        self.assertGreater(good["metrics"]["score"], 90)
        self.assertLess(good["metrics"]["position_error_mm"], 1)
        astray = self.with_hand("trace", following(line, 1.5, aside=4), *exercise)
        self.assertLess(astray["metrics"]["score"], 40)

    def test_a_tool_is_led_through_gates_unhurt_by_a_good_hand_and_not_by_one_that_scrapes_along(self):
        gates = [(-4, 10, 24), (5, 6, 23), (12, 12, 23), (18, 10, 23), (26, 10, 22)]
        path = self.folder / "scope.toml"
        path.write_text(
            'schema = 1\n[[exercise]]\nname = "scope"\ntask = "guide"\ntolerance_mm = 2\nmost_force_n = 0.05\n'
            f"time_limit_s = 60\nplaces_mm = {[list(gate) for gate in gates]}\n"
        )
        exercise = "--exercises", path
        through = [(i + 0.5, *gate) for i, gate in enumerate(gates)]
        good = self.with_hand("scope", [(0, -8, 10, 26), *through], *exercise)
        self.assertEqual(good["ending"], "all reached")
        self.assertGreater(good["metrics"]["score"], 95)
        self.assertEqual(good["metrics"]["peak_force_n"], 0)
        # From each gate over the cube down into it, there for a second, and up again to the next.
        scraping = [row for i, (x, y, z) in enumerate(gates)
                    for row in ((3 * i + 0.5, x, y, z), (3 * i + 1.5, x, y, 16), (3 * i + 2.5, x, y, 16))]
        clumsy = self.with_hand("scope", [(0, -8, 10, 26), *scraping], *exercise)
        self.assertEqual(clumsy["ending"], "all reached")
        self.assertGreater(clumsy["metrics"]["peak_force_n"], 0.05)
        self.assertGreater(clumsy["metrics"]["time_above_limit_s"], 1)
        self.assertLess(clumsy["metrics"]["score"], 60)
        idle = self.with_hand("scope", [(0, 50, 50, 50), (1, 50, 50, 50)], *exercise)
        self.assertEqual((idle["ending"], idle["metrics"]["score"]), ("cut short", 0))

    def test_a_hand_is_led_back_to_the_first_gate_by_those_between(self):
        # Around an edge of the cube, beside which the hand begins, close to the last gate.
        gates = np.array([(10, -8, 10), (-8, -8, 10), (-8, 10, 10)])
        path, recording = self.folder / "round.toml", self.folder / "round.h5"
        path.write_text('schema = 1\n[[exercise]]\nname = "round"\ntask = "guide"\ntolerance_mm = 2\n'
                        f"time_limit_s = 60\nplaces_mm = {gates.tolist()}\n")
        process, _ = self.open_window("--exercises", path, "--exercise", "round", "--target", "0,10,10", "--record", recording)
        self.x("xdotool", "key", "Return")  # begins at once, where the hand is
        self.picture()
        self.x("xdotool", "key", "n")  # from the beginning

        def second_has_ended():
            self.x("xdotool", "key", "e")  # says nothing to a countdown
            return len(list(self.attempts.glob("T-1/*.json"))) == 2

        self.wait_for(second_has_ended)
        self.x("xdotool", "key", "q")
        first, second = (self.begun_at(attempt) for attempt in self.finish(process))
        self.assertGreater(np.linalg.norm(first - gates[0]), 10)
        self.assertLess(np.linalg.norm(second - gates[0]), 0.1)
        way = kept(recording, "ticks/device_position")
        distances = np.linalg.norm(way[:, None] - gates, axis=2)
        self.assertTrue((distances.min(axis=0) < 2).all(), distances.min(axis=0))
        self.assertEqual(distances.argmin(axis=0).tolist(), sorted(distances.argmin(axis=0), reverse=True))
        self.assertFalse(kept(recording, "ticks/force").any(), "straight on the cube is in the way")

    def test_what_is_hidden_is_found_with_the_m_key(self):
        (place,) = self.laid_out("find")["places_mm"]
        path, _ = self.hand([(0, 10, 10, 26), (1, 10, 10, 20.5), (30, 10, 10, 20.5)])
        for key in ("m", "e"):
            process, _ = self.open_window("--exercise", "find", "--script", path)
            time.sleep(1.5)
            self.x("xdotool", "key", key)
            time.sleep(0.5)
            self.x("xdotool", "key", "q")
            (attempt,) = self.finish(process)
            if key == "e":
                self.assertEqual((attempt["ending"], attempt["metrics"]["score"]), ("ended", 0))
                continue
            error = math.dist(place, (10, 10, 20))
            self.assertEqual(attempt["ending"], "found" if error <= 10 else "not found")
            self.assertAlmostEqual(attempt["metrics"]["position_error_mm"], error, delta=1)
            expected = 100 * min(1, max(0, 1 - (error - 10) / 20))
            self.assertAlmostEqual(attempt["metrics"]["score"], expected, delta=8)

    def test_a_border_is_marked_before_the_answer_and_held_against_the_outline(self):
        path, _ = self.hand([(0, 10, 10, 26), (1, 10, 10, 20.5), (3, 10, 10, 20.5), (4, 4, 10, 20.5), (30, 4, 10, 20.5)])
        process, _ = self.open_window("--exercise", "find", "--script", path)
        time.sleep(2.5)
        self.x("xdotool", "key", "k")
        time.sleep(3)
        self.x("xdotool", "key", "k")
        self.x("xdotool", "key", "m")
        time.sleep(0.5)
        self.x("xdotool", "key", "k")  # too late
        self.x("xdotool", "key", "q")
        (attempt,) = self.finish(process)
        outline = attempt["exercise"]["outline_mm"]
        self.assertGreater(len(outline), 10)
        self.assertEqual(len(attempt["border_mm"]), 2)
        errors = [min(math.dist(point, place) for place in outline) for point in attempt["border_mm"]]
        # The outline's points lie a millimetre apart.
        self.assertAlmostEqual(attempt["metrics"]["border_error_mm"], sum(errors) / 2, delta=0.5)

    def steady_yellow(self, window):
        """Yellow pixels once three pictures in a row have about as many: pages that open and detail that is chosen change them."""
        counts, deadline = [], time.monotonic() + 20
        while len(counts) < 3 or max(counts[-3:]) - min(counts[-3:]) > 50:
            self.assertLess(time.monotonic(), deadline, f"the picture does not come to rest: {counts}")
            counts.append(yellow_pixels(self.screen(window)))
            time.sleep(0.3)
        return counts[-1]

    def test_what_is_hidden_stays_so_while_it_is_searched(self):
        path, _ = self.hand([(0, 10, 10, 26), (30, 10, 10, 26)])
        process, window = self.open_window("--exercise", "find", "--script", path)
        before = self.steady_yellow(window)
        self.x("xdotool", "key", "t")
        time.sleep(0.5)
        # A notice may come and fade; a region that is shown stays.
        counts, deadline = [self.steady_yellow(window)], time.monotonic() + 15
        while counts[-1] >= before + 100 and time.monotonic() < deadline:
            counts.append(self.steady_yellow(window))
        self.x("xdotool", "key", "q")
        self.finish(process)
        self.assertLess(counts[-1], before + 100, counts)

    def test_mouse_and_keys_lead_through_the_pages(self):
        process, window = self.open_window()
        # From below: 'Look around first', 'Another trainee', 'Make an exercise', then exercises in two columns, the fourth at the right.
        self.x("xdotool", "mousemove", "--window", window, 600, 720 - 20 - 28 - 3 * 30 - 37)  # free exploration
        self.x("xdotool", "click", 1)
        time.sleep(1)
        self.x("xdotool", "key", "Return")  # begins at once
        time.sleep(0.5)
        for _ in range(30):
            self.x("xdotool", "key", "w")
        for key in ("space", "space", "e", "Return", "Return", "n", "BackSpace", "q"):
            self.x("xdotool", "key", key)
            time.sleep(0.4)
        attempts = self.finish(process)
        self.assertEqual([attempt["exercise"]["name"] for attempt in attempts], ["free", "free"])
        self.assertEqual([attempt["ending"] for attempt in attempts], ["ended", "ended"])
        self.assertGreater(attempts[0]["metrics"]["peak_force_n"], 0.01)
        self.assertIsNone(attempts[0]["metrics"]["score"])

    def test_attempts_are_kept_and_a_closed_window_leaves_an_unfinished_one(self):
        process, _ = self.open_window("--exercise", "touch")
        time.sleep(4)
        self.x("xdotool", "key", "q")
        (attempt,) = self.finish(process)
        self.assertEqual(attempt["ending"], "cut short")
        kept = json.loads((self.attempts / "T-1" / attempt["file"]).read_text())
        self.assertEqual(kept["metrics"], attempt["metrics"])
        rows = (self.attempts / "T-1" / attempt["file"]).with_suffix(".csv").read_text().splitlines()
        times = [float(row.split(",")[0]) for row in rows[1:]]  # a busy machine leaves some out
        self.assertEqual(times, sorted(set(times)))
        self.assertAlmostEqual(times[-1], attempt["metrics"]["time_s"], delta=0.2)
        self.assertLessEqual(len(times), 100 * attempt["metrics"]["time_s"] + 1)
        statements = [json.loads(row) for row in (self.attempts / "T-1" / "statements.jsonl").read_text().splitlines()]
        self.assertEqual({statement["actor"]["account"]["name"] for statement in statements}, {"T-1"})
        self.assertEqual([statement["verb"]["display"]["en"] for statement in statements], ["initialized", "terminated"])

    def test_an_attempt_is_watched_again_with_its_own_forces(self):
        path, _ = self.hand([(0, 10, 10, 26), (1, 10, 10, 26), (1.5, 10, 10, 20), (2.5, 10, 10, 20), (3, 10, 10, 26), (60, 10, 10, 26)])
        process, window = self.open_window("--exercise", "free", "--script", path)
        time.sleep(5)
        self.x("xdotool", "key", "e")
        self.wait_for(lambda: self.shows_page(window))
        self.assertIsNone(self.head(window))
        self.x("xdotool", "key", "F4")
        self.wait_for(lambda: self.head(window))
        self.x("xdotool", "key", "space")  # stops it, and sits well before its end
        self.x("xdotool", "mousemove", "--window", window, round(self.on_timeline(0.1)), TIMELINE)
        self.x("xdotool", "click", 1)
        self.wait_for(lambda: abs(self.head(window) - self.on_timeline(0.1)) < 4)
        self.x("xdotool", "key", "F4")
        self.wait_for(lambda: self.shows_page(window))
        self.x("xdotool", "key", "q")
        (attempt,) = self.finish(process)

        kept = self.attempts / "T-1" / attempt["recording"]
        self.assertEqual(json.loads((self.attempts / "T-1" / attempt["file"]).read_text())["recording"], kept.name)
        shown = json.loads(subprocess.run([TRAIN, self.asset, "--json", "-", "--play", kept, "--speed", "4", "--seconds", "3"],
                                          capture_output=True, text=True, check=True, env=self.server.environment).stdout)
        self.assertEqual(shown["missing_ticks"], 0)
        self.assertGreater(shown["ticks"], 50 * 0.5 * attempt["metrics"]["time_s"])  # however late the servo was
        self.assertAlmostEqual(shown["ends_s"] - shown["begins_s"], attempt["metrics"]["time_s"], delta=0.2)
        # Held for a second, so that one tick of 20 sees it.
        self.assertAlmostEqual(shown["force_peak_n"], attempt["metrics"]["peak_force_n"], delta=0.1 * attempt["metrics"]["peak_force_n"])
        replayed = subprocess.run([TRAIN.with_name("palpate-touch"), self.asset, "--replay", kept], capture_output=True, text=True)
        self.assertEqual(replayed.returncode, 3)
        self.assertIn("keeps one tick of 20", replayed.stderr)

    def test_the_hand_stays_where_it_is_while_an_attempt_is_watched(self):
        for watched in (True, False):
            process, window = self.open_window("--exercise", "free")
            for key in ("Return", "e"):  # begins at once
                self.x("xdotool", "key", key)
                time.sleep(0.5)
            self.wait_for(lambda: self.shows_page(window))
            self.x("xdotool", "key", "F4" if watched else "BackSpace", *([] if watched else ["BackSpace"]))  # away from all pages
            self.wait_for(lambda: self.head(window) if watched else not self.shows_page(window))
            self.x("xdotool", "mousemove", "--window", window, 640, 360)
            self.x("xdotool", "mousedown", 1)
            time.sleep(1)
            self.x("xdotool", "mouseup", 1)
            if watched:
                self.x("xdotool", "key", "F4")
                self.wait_for(lambda: self.shows_page(window))
            self.x("xdotool", "key", "q")
            travel = super().finish(process)["device_travel_mm"]
            self.assertLess(travel, 0.1) if watched else self.assertGreater(travel, 1)

    def test_figures_are_kept_where_the_recording_cannot_be(self):
        self.asset = shutil.copy(self.asset, self.folder / "removed.vtkhdf")
        process, window = self.open_window("--exercise", "free")
        self.x("xdotool", "key", "Return")  # begins at once
        time.sleep(1)
        self.asset.unlink()  # which a recording names by its digest
        self.x("xdotool", "key", "e")
        self.wait_for(lambda: self.shows_page(window))
        self.x("xdotool", "key", "F4")  # nothing to be shown
        time.sleep(0.5)
        self.x("xdotool", "key", "q")
        out, err = process.communicate(timeout=30)
        (attempt,) = json.loads(out)["attempts"]
        self.assertNotIn("recording", attempt)
        self.assertTrue((self.attempts / "T-1" / attempt["file"]).exists())
        self.assertIn("the attempt's recording is not kept", err)

    def test_another_trainee_types_a_pseudonym_and_goes_on_under_it(self):
        process, window = self.open_window()
        self.wait_for(lambda: self.shows_page(window))
        for key in ("F3", "a", "space", "A", "slash", "7", "x", "BackSpace", "minus", "1", "Return", "4"):  # free exploration
            self.x("xdotool", "key", key)
            time.sleep(0.4)
        self.x("xdotool", "key", "Return")  # begins at once
        time.sleep(0.5)
        for key in ("e", "BackSpace", "F3", "z", "Escape", "q"):
            self.x("xdotool", "key", key)
            time.sleep(0.4)
        (attempt,) = self.finish(process)
        self.assertEqual(attempt["trainee"], "aA7-1")
        self.assertTrue((self.attempts / "aA7-1" / attempt["file"]).exists())

    def test_attempts_that_cannot_be_kept_are_told_and_the_trainer_goes_on(self):
        self.attempts.write_text("a file, not a folder")
        path, seconds = self.hand([(0, 50, 50, 50), (0.3, 50, 50, 50)])
        run = subprocess.run(
            self.command("--exercise", "free", "--script", path, "--seconds", seconds),
            capture_output=True,
            text=True,
            timeout=60,
            env=self.server.environment,
        )
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("not kept", run.stderr)

    def test_misuse_is_refused_before_the_window_opens(self):
        bad = self.folder / "bad.toml"
        bad.write_text('schema = 1\n[[exercise]]\nname = "a"\ntask = "jump"\n')
        for options, code, phrase in (
            (("--trainee", "Jane Doe"), 2, "pseudonym"),
            (("--exercise", "fnd"), 2, "touch, find, trace, free"),
            (("--exercises", bad), 3, "bad.toml:4"),
        ):
            run = subprocess.run(
                [TRAIN, self.asset, *map(str, options)], capture_output=True, text=True, env=self.server.environment
            )
            self.assertEqual(run.returncode, code, run.stderr)
            self.assertIn(phrase, run.stderr)


if __name__ == "__main__":
    unittest.main()
