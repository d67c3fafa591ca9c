# SPDX-License-Identifier: Apache-2.0
"""Changes bytes of a made-up patient's asset at random and looks at what touch makes of it."""
import csv
import os
import pathlib
import random
import subprocess
import sys

sys.path.insert(0, "..")
from sample_asset import SampleAsset  # noqa: E402

TOUCH = pathlib.Path(os.environ["PALPATE_BIN"]) / "palpate-touch"
OK, INVALID = 0, 3
FELT = ("device", "mm"), ("tool", "mm"), ("force", "n")
SUPERBLOCK = 48  # bytes with which an HDF5 file begins, before what is in it
HEADERS = 65536  # bytes in which HDF5 keeps most of what it says of datasets


class DamagedBytes(SampleAsset):
    def felt(self, asset):
        """Exit code, message, and tick by tick where device and tool were, last the force."""
        log = self.folder / "log.csv"
        log.unlink(missing_ok=True)
        done = subprocess.run([TOUCH, asset, "--script", "press", "--seconds", "0.5", "--virtual-clock", "--log", log, "--quiet"],
                              capture_output=True, text=True, timeout=60)
        if done.returncode != OK:
            return done.returncode, done.stderr, None
        with open(log) as rows:
            return OK, "", [[row[f"{what}_{axis}_{unit}"] for what, unit in FELT for axis in "xyz"] for row in csv.DictReader(rows)]

    def try_changes(self, count, seed):
        """1 to 4 bytes at a time, half of them in the headers: refused with what is damaged, or the same to the last digit."""
        code, message, whole = self.felt(self.asset)
        self.assertEqual(code, OK, message)
        self.assertGreater(sum(any(float(value) for value in tick[-3:]) for tick in whole), 100, "ticks with force")
        bytes_of_asset, draw, refused = self.asset.read_bytes(), random.Random(seed), 0
        damaged = self.folder / "damaged.vtkhdf"
        for _ in range(count):
            changed, places = bytearray(bytes_of_asset), []
            for _ in range(draw.randint(1, 4)):
                places.append(draw.randrange(len(changed) if draw.random() < 0.5 else min(HEADERS, len(changed))))
                changed[places[-1]] ^= draw.randint(1, 255)
            damaged.write_bytes(changed)
            code, message, felt = self.felt(damaged)
            if code == OK:
                self.assertEqual(felt, whole, f"bytes {places} of seed {seed}")
                continue
            refused += 1
            self.assertEqual(code, INVALID, f"bytes {places} of seed {seed}: {message}")
            self.assertIn(str(damaged), message, f"bytes {places} of seed {seed}")
            if min(places) >= SUPERBLOCK:
                self.assertIn(f"{damaged}: /", message, f"no dataset or group is named; bytes {places} of seed {seed}")
        print(f"{refused} of {count} damaged assets refused, the others felt the same", file=sys.stderr)
        self.assertGreater(refused, 0)
