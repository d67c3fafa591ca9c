# SPDX-License-Identifier: Apache-2.0
"""A in palpate-train's window: the force is heard, in a file that OpenAL Soft writes in place of a loudspeaker."""

import math
import struct
import subprocess
import time
import unittest

import h5py
import numpy as np

from trainer_case import TRAIN, TrainerCase

SECONDS = 6  # of a hand that holds the tool pressed from the first on


def pitches(wav):
    """Of each whole second of a recording that plays: the strongest pitch, Hz, and how loud it is at most, 0 to 1."""
    channels, rate, _, _, bits = struct.unpack("<HIIHH", wav[22:36])
    data = wav[wav.index(b"data") + 8:]
    kind, scale = (np.float32, 1) if bits == 32 else (np.int16, 32768)
    left = np.frombuffer(data[: len(data) // (channels * bits // 8) * (channels * bits // 8)], dtype=kind)[::channels] / scale
    seconds = left[: len(left) // rate * rate].reshape(-1, rate)
    return [(int(np.argmax(np.abs(np.fft.rfft(one * np.hanning(rate))))), float(np.abs(one).max())) for one in seconds]


class Sound(TrainerCase):
    def press(self, keys, **variables):
        """What a hand felt that held the sample pressed while `keys` were struck, N in each tick."""
        hand, run = self.folder / "hold.txt", self.folder / f"{self.id()}.h5"
        hand.write_text(f"0 10 10 30\n1 10 10 18\n{SECONDS + 1} 10 10 18\n")
        process = self.launch("--script", hand, "--seconds", SECONDS, "--record", run, "--force",
                              environment=self.server.environment | variables)
        self.find_window()
        for key in keys:
            self.x("xdotool", "key", key)
            time.sleep(0.5)
        self.finish(process)
        with h5py.File(run) as recorded:
            return np.linalg.norm(recorded["ticks/force"][: recorded["count/ticks"][0]], axis=1)

    def loudspeaker(self):
        """The file that stands for one, and what makes it do so."""
        wav, settings = self.folder / f"{self.id()}.wav", self.folder / "alsoft.conf"
        settings.write_text(f"[general]\ndrivers = wave\n[wave]\nfile = {wav}\n")
        return wav, {"ALSOFT_CONF": str(settings), "ALSOFT_DRIVERS": "wave"}

    def heard(self, keys):
        wav, variables = self.loudspeaker()
        forces = self.press(keys, **variables)
        return (pitches(wav.read_bytes()) if wav.exists() else []), forces

    def test_the_force_is_heard_as_a_tone_an_octave_higher_for_four_times_as_much(self):
        heard, forces = self.heard(["a"])
        held = float(np.median(forces[forces > 0]))
        self.assertGreater(held, 0.03)
        pitch, loudness = heard[-1]
        self.assertAlmostEqual(pitch, 110 * math.sqrt(held / 0.02), delta=2)
        self.assertGreater(loudness, 0.2)

    def test_it_is_silent_until_asked_and_again_when_turned_off(self):
        self.assertEqual(self.heard([])[0], [])
        heard, _ = self.heard(["a", "a"])
        self.assertLess(len(heard), 3)  # nothing is written once it is off

    def test_a_recording_is_heard_while_it_runs_and_not_while_it_pauses(self):
        hand, run = self.folder / "held.txt", self.folder / "held.h5"
        hand.write_text("0 10 10 30\n0.1 10 10 18\n20 10 10 18\n")
        subprocess.run([TRAIN.with_name("palpate-touch"), self.asset, "--script", hand, "--seconds", "20", "--virtual-clock",
                        "--record", run], check=True, capture_output=True, timeout=60)
        wav, variables = self.loudspeaker()
        process = self.launch("--play", run, "--speed", 0.25, environment=self.server.environment | variables)
        self.find_window()
        self.x("xdotool", "key", "a")
        whole_seconds = lambda: len(pitches(wav.read_bytes())) if wav.exists() and wav.stat().st_size > 100 else 0
        self.wait_for(lambda: whole_seconds() >= 2)
        self.x("xdotool", "key", "space")
        self.picture()
        paused = whole_seconds()
        self.wait_for(lambda: whole_seconds() >= paused + 2)
        self.x("xdotool", "key", "q")
        held = math.hypot(*self.finish(process)["last"]["force_n"])
        self.assertGreater(held, 0.03)
        heard = pitches(wav.read_bytes())
        pitch, loudness = heard[1]
        self.assertAlmostEqual(pitch, 110 * math.sqrt(held / 0.02), delta=2)
        self.assertGreater(loudness, 0.2)
        self.assertLess(heard[-1][1], 0.001)

    def test_without_a_sound_device_all_else_goes_on(self):
        settings = self.folder / "none.conf"
        settings.write_text("[general]\ndrivers = -all\n")
        forces = self.press(["a"], ALSOFT_CONF=str(settings), ALSOFT_DRIVERS="nothing")
        self.assertGreater(forces.max(), 0.03)


if __name__ == "__main__":
    unittest.main()
