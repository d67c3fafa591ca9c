#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Whole tools at four tasks: a peg into a hole, a peg along a slot, a scope through a nose, a burr on a skull.

    whole_tool_tasks.py HEAD [-o whole_tool_tasks.svg]     (HEAD: the demo's nasopharynx.vtkhdf; PALPATE_BIN has the programs)
    whole_tool_tasks.py HEAD --at-random SECONDS
    whole_tool_tasks.py HEAD --felt

Force and torque on the device with each way to feel a whole tool, drawn over time, and a table. Peg, hole and slot are square, with 0.2 and
0.3 mm to spare at each side and a bevelled mouth; the hand is off by more than that, in place and in turn. The scope is led through the places
of the demo's exercise `scope` and keeps the direction from the last to the first; walls of tissue are felt by `continuous` alone. Depth: of points
of the peg's surface below that of the block, at the worst, by distances to its planes. On a virtual clock; the ticks are this machine's.

At random, three tools are pushed, slid and turned on the skull in the hand of a simulated Premium whose gimbal has motors, with `continuous`. Energy: what the hand was
given more than it gave from one free tick to the next, of what the springs held at most in between; of visits that held a twentieth of the
most of any.

Felt: the pegs in the hand of a simulated Premium without and with motors in its gimbal. Rough: the second difference of torque from tick to
tick, root mean square. Energy as at random.
"""
import argparse
import os
import pathlib
import subprocess
import sys
import tempfile
import tomllib

import h5py
import matplotlib
import numpy as np
from matplotlib.figure import Figure

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / folder) for folder in ("tests/benchmarks", "tests/commands", "sample_data")]
from plot_condensation import STYLE  # noqa: E402
from recorded import kept  # noqa: E402
from tools import TOOLS, lathe, stl  # noqa: E402

PROGRAMS = pathlib.Path(os.environ.get("PALPATE_BIN", "build/release/bin"))
SCHEMES = {"continuous": "#3d84d6", "shell": "#d8732a", "cones": "#9a59b5", "features": "#c4a000", "solid": "#2f9e77"}
BEVEL, DEEP = 1.0, 25.0  # of the pocket, mm
POINTS = 300  # of a curve
UNSOLVED, UNSETTLED = 1 << 3, 1 << 7  # of a tick's status
COLUMNS = ("force", "torque", "device_position", "orientation", "tool_position", "tool_orientation", "status", "contact_count", "tick_ns")
SPRINGS = (("coupling_stiffness", "haptics"), ("torsional_stiffness", "tool"))  # N/mm and N mm/rad
ROWS = """| task | scheme | force at most, N | its largest step in a tick | torque at most, N mm | its largest step | deepest, mm | unsolved / unsettled, of ticks in contact | p50 / p99 / p99.9 in contact, µs |
|---|---|--:|--:|--:|--:|--:|--:|--:|"""

RANDOM_ROWS = """| tool | visits | force at most, N | its largest step in a tick | torque at most, N mm | a visit's gain, of what it held | of the most held | unsolved / unsettled | p50 / p99 / p99.9 in contact, µs |
|---|--:|--:|--:|--:|--:|--:|--:|--:|"""

FELT_ROWS = """| task | scheme | device | force at most, N | torque at most, N mm | its largest step in a tick | rough, N mm | turned at most, degrees | gain, of what was held |
|---|---|---|--:|--:|--:|--:|--:|--:|"""


def pocket(half_x, half_y):
    """A block, its top at z = 0, with a rectangular pocket whose mouth is bevelled."""
    def ring(x, y, z):
        return [(-x, -y, z), (x, -y, z), (x, y, z), (-x, y, z)]
    rings = [ring(half_x + 15, half_y + 15, -DEEP - 10), ring(half_x + 15, half_y + 15, 0), ring(half_x + BEVEL, half_y + BEVEL, 0),
             ring(half_x, half_y, -BEVEL), ring(half_x, half_y, -DEEP)]
    return lathe((0, 0, -DEEP - 10), rings, (0, 0, -DEEP))


def depth_in_block(points, half_x, half_y):
    """How far points are below the surface of that block, mm; above it negative. Near edges it is less than that."""
    x, y, z = np.abs(points[:, 0]), np.abs(points[:, 1]), points[:, 2]
    beyond = [np.minimum(at - half, (at - half - BEVEL - z) / np.sqrt(2)) for at, half in ((x, half_x), (y, half_y))]
    return np.minimum(np.maximum.reduce([*beyond, -DEEP - z]), -z)


def turn(axis, degrees):
    """Quaternions x, y, z, w."""
    half = np.radians(np.asarray(degrees)) / 2
    return np.column_stack([*(component * np.sin(half) for component in axis), np.cos(half)])


def after(second, first):
    """The quaternions of turning by `first` and then by `second`."""
    u, v, a, b = second[:, :3], first[:, :3], second[:, 3:], first[:, 3:]
    return np.hstack([a * v + b * u + np.cross(u, v), a * b - np.sum(u * v, axis=1, keepdims=True)])


def matrix_of(quaternion):
    x, y, z, w = quaternion
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def along(knots, values):
    """Straight between values at knots (s), every millisecond."""
    t = np.arange(0, knots[-1] + 5e-4, 1e-3)
    return t, np.column_stack([np.interp(t, knots, column) for column in np.asarray(values, float).T])


def peg_in_hole():
    # Aside and tilted, down, turned to either side, and up.
    t, pose = along([0, 2, 2.3, 2.8, 3.8, 4.3, 6.3], [[8, 0], [-20, 0], [-20, 0], [-20, 8], [-20, -8], [-20, 0], [8, 0]])
    place = np.column_stack([np.full(len(t), 0.6), np.full(len(t), -0.3), pose[:, 0]])
    return np.column_stack([t, place, after(turn((0, 1, 0), np.full(len(t), 3.0)), turn((0, 0, 1), pose[:, 1]))])


def peg_in_slot():
    # Down, to and fro along x, swaying across by more than there is room, and turning.
    t, pose = along([0, 1, 3, 5, 6], [[8, 0], [-15, 0], [-15, 20], [-15, -20], [8, 0]])
    sway = np.sin(2 * np.pi * 1.5 * np.clip(t - 1, 0, 4))
    place = np.column_stack([pose[:, 1], 3 * sway, pose[:, 0]])
    return np.column_stack([t, place, turn((0, 0, 1), 15 * np.sin(2 * np.pi * np.clip(t - 1, 0, 4)))])


def scope_through_nose():
    exercise = next(each for each in tomllib.loads((ROOT / "pipelines/exercises/nasopharynx.toml").read_text())["exercise"]
                    if each["name"] == "scope")
    places = np.array(exercise["places_mm"])
    shaft = (places[0] - places[-1]) / np.linalg.norm(places[0] - places[-1])
    places = np.vstack([places[0] + 40 * shaft, places])
    knots = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(places, axis=0), axis=1)) / 20])  # 20 mm/s
    t, place = along([*knots, knots[-1] + 0.5], [*places, places[-1]])
    axis = np.cross([0, 0, 1], shaft)
    held = turn(axis / np.linalg.norm(axis), np.full(len(t), np.degrees(np.arccos(shaft[2]))))
    return np.column_stack([t, place, held])


def run(asset, tool, scheme, folder, *script):
    """The recording's COLUMNS, by tick, and its SPRINGS."""
    record = folder / "run.h5"
    done = subprocess.run([PROGRAMS / "palpate-touch", asset, "--instrument", tool, "--scheme", scheme, "--virtual-clock", "--record", record,
                           "--force", "--quiet", *map(str, script)], capture_output=True, text=True, timeout=1200)
    if done.returncode:
        sys.exit(f"whole_tool_tasks.py: {done.stderr.strip()}")
    return {name: kept(record, f"ticks/{name}") for name in COLUMNS} | {name: h5py.File(record)[group].attrs[name] for name, group in SPRINGS}


def samples_of(triangles, apart=0.5):
    """Points of triangles, no farther than that from the next, mm."""
    points = []
    for a, b, c in np.asarray(triangles, float):
        count = int(np.ceil(max(np.linalg.norm(b - a), np.linalg.norm(c - a), np.linalg.norm(c - b)) / apart))
        i, j = np.meshgrid(*[np.arange(count + 1)] * 2)
        u, v = i[i + j <= count] / count, j[i + j <= count] / count
        points.append(a + np.outer(u, b - a) + np.outer(v, c - a))
    return np.unique(np.vstack(points), axis=0)


def deepest_in_block(ticks, points, half_x, half_y, every=10):
    return max(depth_in_block(points @ matrix_of(q).T + at, half_x, half_y).max()
               for at, q in zip(ticks["tool_position"][::every], ticks["tool_orientation"][::every]))


def spent_in(ticks, which):
    """What some ticks took, µs: p50 / p99 / p99.9."""
    return " / ".join(f"{value / 1000:.0f}" for value in np.percentile(ticks["tick_ns"][which], [50, 99, 99.9]))


def row(task, scheme, ticks, deepest):
    force, torque = (np.linalg.norm(ticks[name], axis=1) for name in ("force", "torque"))
    step = [np.linalg.norm(np.diff(ticks[name], axis=0), axis=1).max() for name in ("force", "torque")]
    touches = ticks["contact_count"] > 0
    told = " / ".join(str(np.count_nonzero(ticks["status"][touches] & bit)) for bit in (UNSOLVED, UNSETTLED))
    spent = spent_in(ticks, touches)
    return (f"| {task} | `{scheme}` | {force.max():.2f} | {step[0] / force.max():.1%} | {torque.max():.1f} | {step[1] / torque.max():.1%} | "
            f"{deepest} | {told} of {np.count_nonzero(touches)} | {spent} |")


def draw(axes, scheme, ticks):
    seconds = len(ticks["force"]) / 1000
    edges = np.linspace(0, len(ticks["force"]), POINTS + 1).astype(int)
    for axis, name in zip(axes, ("force", "torque")):
        size = np.linalg.norm(ticks[name], axis=1)
        most = [size[a:b].max() for a, b in zip(edges, edges[1:]) if b > a]
        axis.plot(np.linspace(0, seconds, len(most)), most, color=SCHEMES[scheme], lw=1.2, label=scheme)


def gains(ticks):
    """Of each visit: work on the hand, and what the springs held at most, N mm."""
    before, after_it = ticks["orientation"][:-1], ticks["orientation"][1:]
    after_it = np.where(np.sum(before * after_it, axis=1, keepdims=True) < 0, -after_it, after_it)
    turn = 2 * (before[:, 3:] * after_it[:, :3] - after_it[:, 3:] * before[:, :3] - np.cross(after_it[:, :3], before[:, :3]))
    mean = {name: (ticks[name][1:] + ticks[name][:-1]) / 2 for name in ("force", "torque")}
    work = np.sum(mean["force"] * np.diff(ticks["device_position"], axis=0) + mean["torque"] * turn, axis=1)
    held = sum(np.sum(ticks[name] ** 2, axis=1) / (2 * ticks[spring])
               for name, spring in (("force", "coupling_stiffness"), ("torque", "torsional_stiffness")))
    free = np.flatnonzero(ticks["contact_count"] == 0)
    return np.array([(work[i:j].sum(), held[i:j].max()) for i, j in zip(free, free[1:]) if j > i + 1])


def at_random(head, seconds):
    print(RANDOM_ROWS, flush=True)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for tool in ("probe", "endoscope", "drill"):
            (folder / f"{tool}.stl").write_bytes(stl(tool, TOOLS[tool]()))
            ticks = run(head, folder / f"{tool}.stl", "continuous", folder, "--body", "skull", "--device", "premium-6dof", "--script", "random",
                        "--seconds", seconds, "--record-seconds", seconds)
            visits = gains(ticks)
            telling = visits[visits[:, 1] > visits[:, 1].max() / 20]
            force, step = (np.linalg.norm(of, axis=1).max() for of in (ticks["force"], np.diff(ticks["force"], axis=0)))
            print(f"| {tool} | {len(visits)} | {force:.2f} | {step:.2f} | {np.linalg.norm(ticks['torque'], axis=1).max():.2f} | "
                  f"{np.max(telling[:, 0] / telling[:, 1]):.2%} | {visits[:, 0].max() / visits[:, 1].max():.2%} | "
                  f"{np.count_nonzero(ticks['status'] & UNSOLVED)} / {np.count_nonzero(ticks['status'] & UNSETTLED)} | {spent_in(ticks, ticks['contact_count'] > 0)} |", flush=True)


def block(folder, of, half_x, half_y):
    """The asset of a pocket."""
    (folder / f"{of}.stl").write_bytes(stl(of, pocket(half_x, half_y)))
    for command in (["surface", "--surface-file", folder / f"{of}.stl", "--min-triangles", "1", "-o", folder / f"{of}.vtp"],
                    ["pack", "--name", of, "--rigid", f"{of}={folder / of}.vtp", "-o", folder / f"{of}.vtkhdf"]):
        subprocess.run([PROGRAMS / "palpate", *command, "--quiet"], check=True, stdout=subprocess.DEVNULL)
    return folder / f"{of}.vtkhdf"


def script(folder, of, rows):
    np.savetxt(folder / f"{of}.txt", rows, fmt="%.9g")
    return "--script", folder / f"{of}.txt"


def felt():
    print(FELT_ROWS, flush=True)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "peg.stl").write_bytes(stl("peg", TOOLS["peg"]()))
        for of, halves, rows in (("hole", (5.2, 5.2), peg_in_hole()), ("slot", (30, 5.3), peg_in_slot())):
            asset, hand = block(folder, of, *halves), script(folder, of, rows)
            for scheme in SCHEMES:
                for device in ("premium", "premium-6dof"):
                    ticks = run(asset, folder / "peg.stl", scheme, folder, *hand, "--device", device)
                    force, torque, step, rough = (np.linalg.norm(vectors, axis=1) for vectors in (
                        ticks["force"], ticks["torque"], np.diff(ticks["torque"], axis=0), np.diff(ticks["torque"], 2, axis=0)))
                    turn = np.degrees(2 * np.arccos(np.minimum(1, np.abs(np.sum(ticks["orientation"] * rows_at(rows, len(force)), axis=1)))))
                    visits = gains(ticks)
                    print(f"| peg in a {of} | `{scheme}` | `{device}` | {force.max():.2f} | {torque.max():.1f} | {step.max():.2f} | "
                          f"{np.sqrt(np.mean(rough**2)):.3f} | {turn.max():.1f} | {visits[:, 0].max() / visits[:, 1].max():.2%} |", flush=True)


def rows_at(rows, count):
    """The quaternions that a script of one row a millisecond wishes in the ticks, which begin at the first millisecond."""
    return rows[np.minimum(np.arange(1, count + 1), len(rows) - 1), 4:]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("head", type=pathlib.Path)
    parser.add_argument("-o", "--output", type=pathlib.Path, default=pathlib.Path("whole_tool_tasks.svg"))
    parser.add_argument("--at-random", type=float, metavar="SECONDS")
    parser.add_argument("--felt", action="store_true")
    arguments = parser.parse_args()
    if arguments.felt:
        return felt()
    if arguments.at_random:
        return at_random(arguments.head, arguments.at_random)
    print(ROWS, flush=True)
    with tempfile.TemporaryDirectory() as name, matplotlib.rc_context(STYLE):
        folder = pathlib.Path(name)
        for tool in ("peg", "endoscope", "drill"):
            (folder / f"{tool}.stl").write_bytes(stl(tool, TOOLS[tool]()))

        # title, asset, tool, script, half widths of the pocket
        tasks = [("peg in a hole", block(folder, "hole", 5.2, 5.2), "peg", script(folder, "peg_in_hole", peg_in_hole()), (5.2, 5.2)),
                 ("peg along a slot", block(folder, "slot", 30, 5.3), "peg", script(folder, "peg_in_slot", peg_in_slot()), (30, 5.3)),
                 ("scope through a nose", arguments.head, "endoscope", script(folder, "scope", scope_through_nose()), None),
                 ("burr on a skull", arguments.head, "drill", ("--body", "skull", "--script", "slide", "--seconds", "4"), None)]
        figure = Figure(figsize=(9, 2.1 * len(tasks)), layout="constrained")
        grid = figure.subplots(len(tasks), 2)
        points = samples_of(TOOLS["peg"]())
        for axes, (title, asset, tool, hand, halves) in zip(grid, tasks):
            for scheme in SCHEMES:
                ticks = run(asset, folder / f"{tool}.stl", scheme, folder, *hand)
                print(row(title, scheme, ticks, f"{deepest_in_block(ticks, points, *halves):.3f}" if halves else "–"), flush=True)
                draw(axes, scheme, ticks)
            axes[0].set_title(f"{title}: force, N")
            axes[1].set_title("torque, N mm")
        for axis in grid[-1]:
            axis.set_xlabel("s")
        grid[0][0].legend(frameon=False)
        figure.savefig(arguments.output, transparent=True, metadata={"Date": None})


if __name__ == "__main__":
    main()
