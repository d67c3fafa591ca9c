#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs a sanitized program and prints how its memory grew, from the tenth of its time on, when all is begun, to its end.

watch_memory.py PROGRAM ARGUMENT ...        Ends with 1 if it fails or grows by more than a hundredth. Needs xvfb.
"""
import os
import pathlib
import statistics
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests/commands"))
sys.dont_write_bytecode = True
from x_server import XServer  # noqa: E402

MOST_GROWTH = 0.01
SAMPLES_A_SECOND = 2
SANITIZERS = {
    # What was freed is kept for a while, so that its use is seen: little, for it counts as memory until it is full.
    "ASAN_OPTIONS": "quarantine_size_mb=1:detect_leaks=1",
    "UBSAN_OPTIONS": "print_stacktrace=1",
}


def resident_kb(process):
    try:
        lines = pathlib.Path(f"/proc/{process.pid}/status").read_text().splitlines()
    except FileNotFoundError:
        return None
    return next((int(line.split()[1]) for line in lines if line.startswith("VmRSS:")), None)


def main(command):
    with XServer() as server:
        begun = time.monotonic()
        process = subprocess.Popen(command, env={**server.environment, **SANITIZERS})
        memory = []
        while process.poll() is None:
            if (now := resident_kb(process)) is not None:
                memory.append(now)
            time.sleep(1 / SAMPLES_A_SECOND)
        seconds = time.monotonic() - begun
    tenth = len(memory) // 10
    if tenth == 0:
        print(f"{os.path.basename(command[0])}: exit {process.returncode} after {seconds:.0f} s: too short to tell growth", flush=True)
        return 1
    early, late = statistics.median(memory[tenth:2 * tenth]), statistics.median(memory[-tenth:])
    growth = late / early - 1
    print(f"{os.path.basename(command[0])}: {seconds:.0f} s, exit {process.returncode}, {early / 1024:.1f} MB after a tenth of it, "
          f"{late / 1024:.1f} MB at its end: {100 * growth:+.2f} %", flush=True)
    return 1 if process.returncode != 0 or growth > MOST_GROWTH else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
