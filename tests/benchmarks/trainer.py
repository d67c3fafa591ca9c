#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How the trainer's window keeps up, and what it leaves to the haptic loop: a table of the demo's cases, for an idle machine.

    tests/benchmarks/trainer.py [SECONDS]        (pipelines/demo.sh before it; 20 s a run without a number)

Each case is touched by the real clock without a window, then in a window of 1280x720 pixels in an X server of its own, the tool at
rest beside the organ and pressing it. PALPATE_BIN has the programs, build/release/bin without it.
"""
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "tests/commands"))
from x_server import XServer  # noqa: E402

BIN = Path(os.environ.get("PALPATE_BIN", SOURCE / "build/release/bin"))
AWAY = "0 0 0 -5000\n3600 0 0 -5000\n"  # mm: a hand that touches nothing


def result(command, environment=None):
    ran = subprocess.run([*map(str, command), "--json", "-", "--quiet"], check=True, capture_output=True, text=True, env=environment)
    return json.loads(ran.stdout)


def us(run):
    return f"{run['tick_us']['p50']:.1f} / {run['tick_us']['p99']:.0f}"


def row(case, seconds, hands):
    asset = SOURCE / f"build/demo/{case}.vtkhdf"
    touched = {hand: result([BIN / "palpate-touch", asset, "--script", script, "--seconds", seconds]) for hand, script in hands.items()}
    shown = {}
    with XServer("1280x720") as server:
        for hand, script in hands.items():
            command = [BIN / "palpate-train", asset, "--script", script, "--seconds", seconds, "--size", "1280x720"]
            shown[hand] = result(command, server.environment)
    first = min(run["first_frame_s"] for run in shown.values())
    for hand in hands:
        run, detail = shown[hand], shown[hand]["detail"]
        yield (case, hand, f"{first:.2f}", f"{run['frames_per_second']:.0f}", f"{detail['level']} of {detail['levels']}",
               f"{run['shown_late_ms']['p50']:.0f} / {run['shown_late_ms']['p99']:.0f}", f"{run['ticks'] / seconds:.0f}", us(touched[hand]), us(run))


def main():
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 20.0
    head = ("case", "tool", "first frame, s", "frames/s", "detail", "shown late, ms: p50 / p99", "ticks/s", "tick alone, us: p50 / p99", "beside the window")
    print(f"| {' | '.join(head)} |\n|{'---|' * 2}{'--:|' * (len(head) - 2)}")
    with tempfile.TemporaryDirectory() as folder:
        away = Path(folder) / "away.txt"
        away.write_text(AWAY)
        for case in ("liver", "nasopharynx"):
            for cells in row(case, seconds, {"at rest": away, "pressing": "press"}):
                print(f"| {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
