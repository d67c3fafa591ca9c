# SPDX-License-Identifier: GPL-3.0-or-later
"""The exercises that come with the demo's cases, done in a real window with mouse and keys alone: by a good hand, by a clumsy one, by
an idle one, with the score that each deserves."""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
sys.path.insert(0, f"{os.environ['PALPATE_SOURCE']}/tests/commands")
from seeing_hand import DEEPER, SeeingHand  # noqa: E402
from x_server import NEEDED, XServer  # noqa: E402

TRAIN = pathlib.Path(os.environ["PALPATE_BIN"]) / "palpate-train"
CASES = pathlib.Path(os.environ["PALPATE_BUILD"]) / "tests" / "demo_cases"  # of commands.demo_cases
TOOLS = pathlib.Path(os.environ["PALPATE_SOURCE"]) / "sample_data" / "tools.py"
EXERCISES = pathlib.Path(os.environ["PALPATE_SOURCE"]) / "pipelines" / "exercises"
GOOD, BAD = 80, 60  # of 100: a good hand has more, a clumsy one less


@unittest.skipUnless(TRAIN.exists(), "PALPATE_VISUAL is off")
@unittest.skipUnless(all(map(shutil.which, NEEDED)), "PALPATE: xvfb, xdotool, x11-apps or imagemagick is missing")
class DemoExercises(unittest.TestCase):
    case = None

    @classmethod
    def setUpClass(cls):
        built = CASES / f"{cls.case}.vtkhdf"
        if not built.exists():
            raise unittest.SkipTest("PALPATE: commands.demo_cases, which builds the demo's cases, has not run")
        cls.server = cls.enterClassContext(XServer("1280x720"))
        cls.folder = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory()))
        cls.asset = cls.folder / built.name
        cls.asset.symlink_to(built)
        shutil.copy(EXERCISES / f"{cls.case}.toml", cls.folder / f"{cls.case}-exercises.toml")

    def x(self, *command):
        return subprocess.run([*map(str, command)], env=self.server.environment, check=True, capture_output=True, timeout=90).stdout

    def attempt(self, exercise, act, *options):
        """How an exercise ended that `act(hand)` did, its metrics and how it lay on the patient."""
        command = [TRAIN, self.asset, "--exercise", exercise, "--size", "1280x720", "--attempts", self.folder / "attempts", "--quiet", "--json", "-", *options]
        train = subprocess.Popen([*map(str, command)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=self.server.environment)
        self.addCleanup(train.communicate)
        self.addCleanup(train.kill)
        window = self.x("xdotool", "search", "--sync", "--onlyvisible", "--name", f"Palpate: {self.case}").split()[0].decode()
        self.x("xdotool", "windowfocus", "--sync", window)
        hand = SeeingHand(self.x, window)
        hand.wait_for(lambda: hand.look().max() > 100)  # drawn
        act(hand)
        time.sleep(0.3)
        self.x("xdotool", "key", "q")
        out, err = train.communicate(timeout=60)
        self.assertEqual(train.returncode, 0, err)
        (attempt,) = json.loads(out)["attempts"]
        return attempt["ending"], attempt["metrics"], attempt["exercise"]

    def do_well(self, exercise, act, *options, ending="all reached"):
        ended, metrics, _ = self.attempt(exercise, act, *options)
        self.assertEqual(ended, ending, metrics)
        self.assertGreater(metrics["score"], GOOD, metrics)

    def do_badly(self, exercise, act, *options):
        _, metrics, _ = self.attempt(exercise, act, *options)
        self.assertLess(metrics["score"], BAD, metrics)
        return metrics

    def idle(self, exercise, *options):
        ended, metrics, _ = self.attempt(exercise, SeeingHand.begin, *options)
        self.assertEqual((ended, metrics["score"]), ("cut short", 0))

    def touch_and_trace(self):
        for exercise, act in (("touch", SeeingHand.touch), ("trace", SeeingHand.trace)):
            with self.subTest(exercise):
                self.do_well(exercise, act)
                clumsy = self.do_badly(exercise, lambda hand, act=act: act(hand, deeper=DEEPER))
                self.assertGreater(clumsy["time_above_limit_s"], 1)
                self.idle(exercise)

    def find(self, turn):
        """A good hand knows from a mark of its teacher's where it is; `turn` is how the view is moved so that it is seen."""
        ended, clumsy, hidden = self.attempt("find", lambda hand: hand.answer((640, 360), deeper=DEEPER))
        self.assertEqual(ended, "not found")
        self.assertLess(clumsy["score"], BAD)
        self.assertGreater(clumsy["peak_force_n"], hidden["most_force_n"])
        there = self.folder / "there.toml"
        there.write_text(f'schema = 1\n[[exercise]]\nname = "there"\ntask = "touch"\nplaces_mm = {hidden["places_mm"]}\n')
        seen = []
        self.attempt("there", lambda hand: (hand.begin(), hand.drag(*turn), hand.point((30, 300)), hand.rest(), seen.append(hand.wait_for(hand.due))),
                     "--exercises", there)
        self.do_well("find", lambda hand: (hand.begin(), hand.drag(*turn), hand.answer(seen[0])), ending="found")
        self.idle("find")


class Liver(DemoExercises):
    case = "liver"

    def test_marks_and_a_line(self):
        self.touch_and_trace()

    def test_the_hidden_tumour(self):
        self.find((2, 0, 160))  # the organ's upper part from behind the texts

    def test_the_edge_held_back(self):
        def retract(hand, steps):
            hand.begin()
            hand.key(*["w"] * steps, delay=60)  # half a millimetre each
            time.sleep(1)
            hand.key("j")
            time.sleep(2.5)
            hand.key(*["s"] * 12, delay=120)
            time.sleep(2.5)
            hand.key("j")
            time.sleep(2.5)
            hand.key(*["s"] * steps, delay=60)
            time.sleep(0.5)

        forceps = "--instrument", "forceps"
        self.do_well("retract", lambda hand: retract(hand, 40), *forceps)
        slipped = self.do_badly("retract", lambda hand: retract(hand, 20), *forceps)
        self.assertGreaterEqual(slipped["misses"], 1)
        self.idle("retract", *forceps)


class Nasopharynx(DemoExercises):
    case = "nasopharynx"

    def test_marks_and_a_line(self):
        self.touch_and_trace()

    def test_the_hidden_tumour(self):
        self.find((2, -200, 0))

    def test_a_whole_scope_begins_in_free_space(self):
        subprocess.run([sys.executable, TOOLS, self.folder], check=True, stdout=subprocess.DEVNULL)
        run = subprocess.run([TRAIN, self.asset, "--instrument", self.folder / "endoscope.stl", "--seconds", "2", "--quiet", "--json", "-"],
                             capture_output=True, text=True, env=self.server.environment)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertNotIn("starts_inside", json.loads(run.stdout)["statuses"])

    def test_the_scope_by_its_own_picture(self):
        for waits in (False, True):
            with self.subTest(waits=waits):
                self.do_well("scope", lambda hand, waits=waits: hand.lead_scope(waits))
        scraped = self.do_badly("scope", lambda hand: hand.lead_scope(scrapes=True))
        self.assertGreater(scraped["time_above_limit_s"], 0.2)
        self.idle("scope")


del DemoExercises  # has no tests of its own

if __name__ == "__main__":
    unittest.main()
