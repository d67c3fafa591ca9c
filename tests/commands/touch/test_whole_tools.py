# SPDX-License-Identifier: Apache-2.0
"""palpate touch --instrument: whole instruments and the case's rod, which turn by themselves and give torque."""

import csv
import json
import math
import os
import pathlib
import subprocess
import sys
import unittest

import h5py

sys.path.insert(0, "..")
from sample_asset import TESTS, SampleAsset  # noqa: E402

TOUCH = pathlib.Path(os.environ["PALPATE_BIN"]) / "palpate-touch"
TOOLS = pathlib.Path(os.environ["PALPATE_SOURCE"]) / "sample_data" / "tools.py"
NONE = [0, 0, 0, 0]
UPRIGHT = [0, 0, 0, 1]
LOGGED = 1e-6  # of a quaternion in a log, which has six decimals
HAND_TORSION = 270  # N mm/rad, of the hand that holds a simulated device
COUPLING, TORSION = 0.4, 450  # N/mm, the sample's; N mm/rad, the default
FACETS = 0.05  # relative: what the skull's facets and the peg's points are off their lever of 4 mm
SINKS = 0.15  # mm, that facets are below their sphere and points give way

# Lowered onto the skull, whose top (40, 10, 25) is 4 mm beside the middle of the peg's lower face.
BESIDE_THE_TOP = "0 36 10 30 {0}\n0.5 36 10 23 {0}\n0.6 36 10 23 {0}\n1 36 10 30 {0}\n"


def norm(vector):
    return math.hypot(*vector)


class WholeTools(SampleAsset):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        subprocess.run([sys.executable, TOOLS, cls.folder], check=True, stdout=subprocess.DEVNULL)
        cls.peg = cls.folder / "peg.stl"  # 10 x 10 x 40 mm

    def touch(self, *options, asset=None):
        return subprocess.run([TOUCH, asset or self.asset, *map(str, options)], capture_output=True, text=True, timeout=120)

    def result(self, *options):
        run = self.touch(*options, "--json", "-")
        self.assertEqual(run.returncode, 0, run.stderr)
        return json.loads(run.stdout)

    def hand(self, text):
        path = self.folder / "hand.txt"
        path.write_text(text)
        return path

    def logged(self, *options):
        """The run's result, and of each tick what the columns of its log say."""
        log = self.folder / "run.csv"
        result = self.result("--virtual-clock", *options, "--log", log, "--force")
        with open(log, newline="") as file:
            return result, list(csv.DictReader(file))

    def quaternion(self, row, of):
        return [float(row[f"{of}_q{part}"]) for part in "xyzw"]

    def assert_same_turn(self, found, expected):
        # q and -q turn alike.
        sign = math.copysign(1, sum(a * b for a, b in zip(found, expected)))
        for a, b in zip(found, expected):
            self.assertAlmostEqual(sign * a, b, delta=LOGGED)

    def test_a_hand_at_random_turns_an_instrument_but_not_where_a_shaft_is_given(self):
        for shaft in ([], ["--shaft", "0,0,1"]):
            _, rows = self.logged("--instrument", self.peg, "--script", "random", "--seconds", 3, *shaft)
            turns = {tuple(self.quaternion(row, "device")) for row in rows}
            self.assertEqual(len(turns) > 100, not shaft)

    def test_a_peg_beside_the_top_is_turned_by_its_lever_and_the_result_says_how(self):
        script = self.hand(BESIDE_THE_TOP.format("0 0 0 1"))
        result, rows = self.logged("--instrument", self.peg, "--script", script, "--scheme", "shell")
        self.assertEqual(result["scheme"], "shell")
        self.assertEqual(result["statuses"], {})
        peak = result["peak"]
        # 2 mm into the skull; 4 mm beside the middle, upwards: r x f = (4, 0, 0) x (0, 0, f).
        force, torque = peak["force_n"], peak["torque_n_mm"]
        self.assertAlmostEqual(force[2], COUPLING * 2, delta=COUPLING * SINKS)
        self.assertAlmostEqual(torque[1], -4 * force[2], delta=4 * FACETS * force[2])
        self.assertLess(abs(torque[0]), 0.2 * abs(torque[1]))
        self.assertGreaterEqual(result["torque_peak_n_mm"], norm(torque))
        # The spring of torsion is turned by what it gives.
        self.assertEqual(peak["device_orientation"], UPRIGHT)
        angle = 2 * math.asin(norm(peak["tool_orientation"][:3]))
        self.assertAlmostEqual(TORSION * angle, norm(torque), delta=1e-3 * norm(torque))
        # And the linear one is drawn by what it gives.
        drawn = [COUPLING * (a - b) for a, b in zip(peak["tool_mm"], peak["device_mm"])]
        for f, d in zip(force, drawn):
            self.assertAlmostEqual(f, d, delta=1e-6)
        # The log has the same.
        row = rows[round(1000 * peak["t_s"]) - 1]
        for axis, value in zip("xyz", torque):
            self.assertAlmostEqual(float(row[f"torque_{axis}_n_mm"]), value, delta=1e-3)
        self.assert_same_turn(self.quaternion(row, "device"), UPRIGHT)
        self.assert_same_turn(self.quaternion(row, "tool"), peak["tool_orientation"])
        self.assertEqual(norm([float(rows[0][f"torque_{axis}_n_mm"]) for axis in "xyz"]), 0)

    def test_a_peg_feels_bone_and_tissue_by_itself(self):
        script = self.hand(BESIDE_THE_TOP.format("0 0 0 1"))
        result, _ = self.logged("--instrument", self.peg, "--script", script)
        self.assertEqual(result["scheme"], "continuous")
        self.assertEqual(result["statuses"], {})
        self.assertLess(result["penetration"]["tool_mm"], 0.01)
        force, torque = result["peak"]["force_n"], result["peak"]["torque_n_mm"]
        self.assertAlmostEqual(force[2], COUPLING * 2, delta=COUPLING * 0.4)  # what its flat face has between spheres
        self.assertAlmostEqual(torque[1] / force[2], -4, delta=1)
        on_wall = self.result("--virtual-clock", "--instrument", self.peg, "--script", "press", "--body", "wall", "--seconds", 3)
        self.assertGreater(on_wall["force_peak_n"], 0.005)
        self.assertEqual({contact["body"] for contact in on_wall["peak"]["contacts"]}, {"wall"})

    def test_a_peg_is_pushed_off_where_it_is_near_bone_before_it_meets_it(self):
        script = self.hand(BESIDE_THE_TOP.format("0 0 0 1"))
        for scheme in ("cones", "features"):
            with self.subTest(scheme=scheme):
                result, _ = self.logged("--instrument", self.peg, "--script", script, "--scheme", scheme, "--contact-stiffness", 20)
                self.assertEqual(result["scheme"], scheme)
                self.assertEqual(result["penetration"]["tool_mm"], 0)
                force, torque = result["peak"]["force_n"], result["peak"]["torque_n_mm"]
                # The sample's largest force, 3.3 N, on 20 N/mm: it is felt from 0.165 mm off on.
                self.assertGreater(force[2], COUPLING * 2)
                self.assertLess(force[2], COUPLING * (2 + 0.165 + SINKS))
                self.assertAlmostEqual(torque[1] / force[2], -4, delta=0.4)

    def test_a_solid_peg_is_turned_by_its_lever_and_stays_outside(self):
        script = self.hand(BESIDE_THE_TOP.format("0 0 0 1"))
        result, _ = self.logged("--instrument", self.peg, "--script", script, "--scheme", "solid")
        self.assertEqual(result["statuses"], {})
        self.assertEqual(result["penetration"]["tool_mm"], 0)
        force, torque = result["peak"]["force_n"], result["peak"]["torque_n_mm"]
        self.assertAlmostEqual(force[2], COUPLING * 2, delta=COUPLING * SINKS)
        self.assertAlmostEqual(torque[1], -4 * force[2], delta=4 * FACETS * force[2])

    def test_a_device_with_motors_in_its_gimbal_is_turned_and_any_other_is_said_not_to_be(self):
        script = self.hand(BESIDE_THE_TOP.format("0 0 0 1"))
        turned = {}
        for device in ("premium", "premium-6dof"):
            run = self.touch("--virtual-clock", "--instrument", self.peg, "--script", script, "--device", device, "--json", "-")
            self.assertEqual(run.returncode, 0, run.stderr)
            result = json.loads(run.stdout)
            self.assertEqual(result["statuses"], {})
            self.assertEqual(result["torque_is_felt"], device == "premium-6dof")
            self.assertEqual("renders no torque" in run.stderr, device == "premium")
            x, y, z, w = result["peak"]["device_orientation"]
            self.assertLess(norm((x, z)), 0.2 * abs(y) + 1e-9)
            turned[device] = 2 * math.asin(math.copysign(1, w) * y)
            torque = result["peak"]["torque_n_mm"][1]
        self.assertAlmostEqual(turned["premium"], 0, delta=1e-9)
        # In about as long as the hand takes to settle: as far as its spring bears the torque.
        self.assertAlmostEqual(turned["premium-6dof"], torque / HAND_TORSION, delta=0.3 * abs(torque) / HAND_TORSION)
        # What is felt is replayed from what was recorded.
        record = self.folder / "felt.h5"
        self.result("--virtual-clock", "--instrument", self.peg, "--script", script, "--device", "premium-6dof", "--record", record)
        self.assertEqual(self.result("--replay", record)["replay"]["different_ticks"], 0)

    def test_a_script_of_eight_columns_turns_the_tool_and_one_of_seven_turns_it_every_millisecond(self):
        half = math.sqrt(0.5)
        quarter_turn = self.hand(f"0 40 10 60 0 0 0 1\n1, 40, 10, 60, {half:.9f}, 0, 0, {half:.9f}\n")
        for device in ([], ["--device", "touch"]):
            with self.subTest(device=device):
                _, rows = self.logged("--instrument", self.peg, "--script", quarter_turn, *device)
                self.assertEqual(len(rows), 1000)
                for tick in (0, 250, 499, 999):
                    angle = math.pi / 2 * 1e-3 * (tick + 1)
                    expected = [math.sin(angle / 2), 0, 0, math.cos(angle / 2)]
                    for of in ("device", "tool"):  # in the air they are turned alike
                        self.assert_same_turn(self.quaternion(rows[tick], of), expected)
        ticks = self.hand("40 10 60 0 0 0 1\n40 10 60 1 0 0 0\n40 10 60 0 1 0 0\n")
        _, rows = self.logged("--instrument", self.peg, "--script", ticks)
        for row, expected in zip(rows, (UPRIGHT, [1, 0, 0, 0], [0, 1, 0, 0]), strict=True):
            self.assert_same_turn(self.quaternion(row, "device"), expected)

    def test_a_script_with_a_quaternion_that_is_none_is_refused_with_its_line(self):
        for rows, message in (("40 10 60 0 0 0 1\n40 10 60 0 0 0 2\n", "hand.txt, line 2: a quaternion of length 2"),
                              ("40 10 60 0 0 0 1\n40 10 60\n", "hand.txt, line 2: 3 numbers")):
            run = self.touch("--instrument", self.peg, "--virtual-clock", "--script", self.hand(rows))
            self.assertEqual(run.returncode, 3, run.stderr)
            self.assertIn(message, run.stderr)

    def test_the_rod_turns_where_it_is_asked_to_and_is_held_by_its_device_otherwise(self):
        # Pressed with its tip alone a rod has no lever.
        script = self.hand(BESIDE_THE_TOP.format("0 0 0 1"))
        rod = self.result("--virtual-clock", "--instrument", "rod", "--rod-length", 20, "--script", script)
        held = self.result("--virtual-clock", "--script", script)
        self.assertEqual(rod["scheme"], "continuous")
        self.assertEqual(held["torque_peak_n_mm"], 0)
        self.assertEqual(held["peak"]["tool_orientation"], NONE)
        self.assertEqual(held["peak"]["device_orientation"], UPRIGHT)
        self.assertAlmostEqual(norm(rod["peak"]["tool_orientation"]), 1, delta=1e-9)
        self.assertAlmostEqual(rod["force_peak_n"], held["force_peak_n"], delta=0.01)

    def test_without_a_tool_shell_holds_the_cases_ball_and_says_what_is_not_felt(self):
        script = self.hand("0 40 10 30\n0.5 40 10 24\n1 40 10 30\n")
        run = self.touch("--virtual-clock", "--scheme", "shell", "--script", script, "--json", "-")
        self.assertEqual(run.returncode, 0, run.stderr)
        # A ball of 1.5 mm, 2.5 mm deep on a coupling of 0.4 N/mm: held by the bone's surface at the most, at least
        # by one point of its shell, which gives way by 10 N/mm and is up to 0.04 mm nearer than the ball (0.5 mm
        # between points, 24 corners around).
        force = json.loads(run.stdout)["force_peak_n"]
        self.assertLessEqual(force, 2.5 * 0.4)
        self.assertGreaterEqual(force, (2.5 - 0.04) / (1 / 0.4 + 1 / 10))
        self.assertIn("nothing is felt of 'wall'", run.stderr)

    def test_two_tools_turn_each_by_itself(self):
        script = self.hand(BESIDE_THE_TOP.format("0 0 0 1"))
        second = self.folder / "second.txt"
        second.write_text(script.read_text().replace(" 36 ", " 44 "))
        run = self.result("--virtual-clock", "--instrument", self.peg, "--script", script, "--second", second, "--scheme", "shell")
        for tool, sign in ((run, -1), (run["second"], 1)):
            force, torque = tool["peak"]["force_n"], tool["peak"]["torque_n_mm"]
            self.assertAlmostEqual(sign * torque[1], 4 * force[2], delta=4 * FACETS * force[2])

    def recorded(self, name, *options):
        path = self.folder / name
        run = self.result("--virtual-clock", *options, "--record", path, "--record-seconds", 5)
        return path, run

    def test_a_recording_holds_the_tool_and_alone_replays_bit_for_bit(self):
        shell = ("--instrument", self.peg, "--script", self.hand(BESIDE_THE_TOP.format("0.1 0.2 0.3 0.927362")), "--voxel", 0.5,
                 "--torsional-stiffness", 300, "--scheme", "shell")
        rod = ("--instrument", "rod", "--rod-length", 20, "--scheme", "continuous", "--seconds", 1, "--max-torque", 50)
        solid = ("--instrument", self.peg, "--script", self.hand(BESIDE_THE_TOP.format("0.1 0.2 0.3 0.927362")), "--scheme", "solid")
        spheres = ("--instrument", self.peg, "--script", self.hand(BESIDE_THE_TOP.format("0.1 0.2 0.3 0.927362")))
        cones, features = ((*spheres, "--scheme", scheme) for scheme in ("cones", "features"))
        for name, options in (("shell.h5", shell), ("rod.h5", rod), ("solid.h5", solid), ("spheres.h5", spheres), ("cones.h5", cones),
                              ("features.h5", features)):
            with self.subTest(tool=name):
                path, run = self.recorded(name, *options)
                again = self.result("--replay", path)
                self.assertEqual(again["replay"]["ticks"], 1000)
                self.assertEqual(again["replay"]["different_ticks"], 0)
                self.assertEqual(again["replay"]["largest_difference_n_mm"], 0)
                for key in ("force_peak_n", "torque_peak_n_mm", "peak", "scheme", "penetration"):
                    self.assertEqual(run[key], again[key])
        with h5py.File(self.folder / "shell.h5") as file:
            self.assertEqual(file["tool"].attrs["voxel"], 0.5)
            self.assertEqual(file["tool"].attrs["torsional_stiffness"], 300)
            self.assertEqual(file["tool/vertices"].attrs["unit"].decode(), "mm")
            self.assertEqual(file["tool/vertices"][:, 2].min(), 0)
            self.assertEqual(file["tool/vertices"][:, 2].max(), 40)
        with h5py.File(self.folder / "rod.h5") as file:
            self.assertEqual(file["tool"].attrs["max_torque"], 50)
            self.assertEqual(list(file["tool"]), [])

    def test_a_changed_torque_ends_with_exit_code_4_and_the_tick(self):
        path, _ = self.recorded("changed.h5", "--instrument", self.peg, "--script", self.hand(BESIDE_THE_TOP.format("0 0 0 1")))
        with h5py.File(path, "r+") as file:
            torque = file["ticks/torque"][500]
            self.assertGreater(norm(torque), 1)
            torque[1] += 1e-6
            file["ticks/torque"][500] = torque
        run = self.touch("--replay", path, "--json", "-")
        self.assertEqual(run.returncode, 4, run.stderr)
        self.assertIn("tick 500 of tool 0", run.stderr)
        self.assertIn("N mm", run.stderr)
        replay = json.loads(run.stdout)["replay"]
        self.assertEqual(replay["different_ticks"], 1)
        self.assertEqual(replay["first_difference"]["tick"], 500)
        self.assertEqual(replay["first_difference"]["recorded_n_mm"], list(torque))
        self.assertEqual(replay["largest_difference_n"], 0)
        self.assertAlmostEqual(replay["largest_difference_n_mm"], 1e-6, delta=1e-9)

    def test_refusals_name_the_culprit_and_the_next_step(self):
        path, _ = self.recorded("refusals.h5", "--instrument", self.peg, "--seconds", 0.1)
        open_surface = self.folder / "open.stl"
        open_surface.write_text("solid open\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
                                "endloop\nendfacet\nendsolid open\n")
        peg = ["--instrument", self.peg]
        cases = [
            (["--instrument", self.folder / "none.stl"], 3, ["none.stl: cannot be read", "check the path"]),
            (["--instrument", open_surface], 3, ["open.stl", "edge"]),
            (["--instrument", self.asset], 3, ["sample.vtkhdf"]),
            ([*peg, "--scheme", "twice"], 2, ["--instrument: with --scheme twice", "continuous, shell, cones, features or solid"]),
            (["--instrument", "rod", "--rod-length", 20, "--scheme", "single"], 2, ["--instrument: with --scheme single", "continuous, shell, cones, features or solid"]),
            ([*peg, "--voxel", 2], 2, ["--voxel: with --scheme continuous", "--scheme shell beside it"]),
            (["--instrument", "rod"], 3, ["its tool has no shaft", "--rod-length"]),
            (["--voxel", 2], 2, ["--voxel: without --instrument", "--instrument rod or a file beside it"]),
            (["--max-torque", 10], 2, ["--max-torque: without --instrument", "--instrument rod or a file beside it"]),
            ([*peg, "--scheme", "shell", "--voxel", 0], 3, ["--voxel: is 0", "0.1 to 10"]),
            ([*peg, "--scheme", "shell", "--shell-points", 10], 3, ["--shell-points: is 10", "100 to 100000"]),
            (["--instrument", "rod", "--rod-length", 20, "--torsional-stiffness", 0], 3, ["--torsional-stiffness: is 0", "1 to 100000"]),
            ([*peg, "--scheme", "shell", "--body", "wall"], 2, ["--body: 'wall' is not rigid", "a rigid body", "'shell' feels no other"]),
            (["--scheme", "shell", "--body", "wall"], 2, ["--body: 'wall' is not rigid"]),
            ([*peg, "--body", "skul"], 2, ["no body 'skul'", "'skull'"]),
            ([*peg, "--replay", path], 2, ["--replay", "--instrument"]),
            ([*peg, "--scheme", "solid", "--voxel", 0.5], 2, ["--voxel: with --scheme solid", "--scheme shell beside it"]),
            ([*peg, "--scheme", "solid", "--contact-stiffness", 5], 2, ["--contact-stiffness: with --scheme solid", "--scheme shell, cones or features"]),
            ([*peg, "--scheme", "solid", "--body", "wall"], 2, ["--body: 'wall' is not rigid", "'solid' feels no other"]),
        ]
        for options, code, messages in cases:
            with self.subTest(options=options):
                clock = [] if "--replay" in options else ["--virtual-clock", "--seconds", 0.1]
                run = self.touch(*clock, *options)
                self.assertEqual(run.returncode, code, run.stderr)
                for message in messages:
                    self.assertIn(message, run.stderr)

    def test_a_case_without_rigid_bodies_is_not_for_shell(self):
        soft = self.folder / "soft.vtkhdf"
        subprocess.run([TESTS / "write_sample_asset", soft, "soft"], check=True)
        for options in (["--instrument", self.peg, "--scheme", "shell"], ["--scheme", "shell"], ["--scheme", "cones"], ["--scheme", "features"], ["--scheme", "solid"]):
            run = self.touch("--virtual-clock", *options, asset=soft)
            self.assertEqual(run.returncode, 3, run.stderr)
            self.assertIn("no rigid body", run.stderr)
            self.assertIn("'continuous'", run.stderr)


if __name__ == "__main__":
    unittest.main()
