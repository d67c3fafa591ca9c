# SPDX-License-Identifier: Apache-2.0
"""A in palpate-train's window: the force is heard, in a file that OpenAL Soft writes in place of a loudspeaker."""

import math
import struct
import subprocess
import unittest

import numpy as np

from trainer_case import TRAIN, TrainerCase
from recorded import kept  # found by trainer_case

FELT = 0.03  # N, at least, of the sample that is held pressed
AUDIBLE = 0.001  # of the loudest


def pitches(wav):
    """Of each whole second of a recording that plays: the strongest pitch, Hz, and how loud it is at most, 0 to 1."""
    channels, rate, _, _, bits = struct.unpack("<HIIHH", wav[22:36])
    data = wav[wav.index(b"data") + 8:]
    kind, scale = (np.float32, 1) if bits == 32 else (np.int16, 32768)
    left = np.frombuffer(data[: len(data) // (channels * bits // 8) * (channels * bits // 8)], dtype=kind)[::channels] / scale
    seconds = left[: len(left) // rate * rate].reshape(-1, rate)
    return [(int(np.argmax(np.abs(np.fft.rfft(one * np.hanning(rate))))), float(np.abs(one).max())) for one in seconds]


def settled(wav):
    """The pitch and loudness of the last whole second; nothing before three in a row are heard that are alike."""
    heard = pitches(wav.read_bytes())[-3:] if wav.exists() and wav.stat().st_size > 100 else []
    if len(heard) < 3 or min(loudness for _, loudness in heard) < AUDIBLE:
        return None
    return heard[-1] if max(pitch for pitch, _ in heard) - min(pitch for pitch, _ in heard) <= 1 else None


class Sound(TrainerCase):
    def press(self, **variables):
        """A trainer whose hand holds the sample pressed, and the force that it feels, N."""
        hand, self.recording = self.folder / "hold.txt", self.folder / f"{self.id()}.h5"
        hand.write_text("0 10 10 30\n1 10 10 18\n")
        process = self.launch("--script", hand, "--record", self.recording, "--force",
                              environment=self.server.environment | variables)
        self.find_window()
        return process, self.wait_for(lambda: self.recording.exists() and self.steady_force())

    def forces(self):
        """What the hand has felt, N in each tick."""
        return np.linalg.norm(kept(self.recording, "ticks/force"), axis=1)

    def steady_force(self):
        """What it has felt for a second; nothing before: a starved servo takes the force away, which comes back by and by."""
        last = self.forces()[-1000:]
        return last[-1] if len(last) == 1000 and last[-1] > FELT and np.ptp(last) < 1e-3 else None

    def strike(self, key):
        self.x("xdotool", "key", key)

    def close(self, process):
        self.strike("q")
        return self.finish(process)

    def loudspeaker(self):
        """The file that stands for one, and what makes it do so."""
        wav, settings = self.folder / f"{self.id()}.wav", self.folder / "alsoft.conf"
        settings.write_text(f"[general]\ndrivers = wave\n[wave]\nfile = {wav}\n")
        return wav, {"ALSOFT_CONF": str(settings), "ALSOFT_DRIVERS": "wave"}

    def test_the_force_is_heard_as_a_tone_an_octave_higher_for_four_times_as_much(self):
        wav, variables = self.loudspeaker()
        process, held = self.press(**variables)
        self.strike("a")
        pitch, loudness = self.wait_for(lambda: settled(wav))
        self.close(process)
        self.assertAlmostEqual(pitch, 110 * math.sqrt(held / 0.02), delta=2)
        self.assertGreater(loudness, 0.2)

    def test_it_is_silent_until_asked_and_again_when_turned_off(self):
        wav, variables = self.loudspeaker()
        process, _ = self.press(**variables)
        self.come_to_rest()
        self.assertFalse(wav.exists())
        self.strike("a")
        self.wait_for(lambda: settled(wav))
        self.strike("a")
        self.come_to_rest()
        written, ticks = wav.stat().st_size, len(self.forces())
        self.wait_for(lambda: len(self.forces()) > ticks + 2000)
        self.close(process)
        self.assertEqual(wav.stat().st_size, written)

    def test_a_recording_is_heard_while_it_runs_and_not_while_it_pauses(self):
        hand, run = self.folder / "held.txt", self.folder / "held.h5"
        hand.write_text("0 10 10 30\n0.1 10 10 18\n20 10 10 18\n")
        subprocess.run([TRAIN.with_name("palpate-touch"), self.asset, "--script", hand, "--seconds", "20", "--virtual-clock",
                        "--record", run], check=True, capture_output=True, timeout=60)
        wav, variables = self.loudspeaker()
        process = self.launch("--play", run, "--speed", 0.25, environment=self.server.environment | variables)
        self.find_window()
        self.strike("a")
        pitch, loudness = self.wait_for(lambda: settled(wav))
        self.strike("space")
        self.come_to_rest()
        whole_seconds = lambda: len(pitches(wav.read_bytes()))
        paused = whole_seconds()
        self.wait_for(lambda: whole_seconds() >= paused + 2)
        held = math.hypot(*self.close(process)["last"]["force_n"])
        self.assertGreater(held, FELT)
        self.assertAlmostEqual(pitch, 110 * math.sqrt(held / 0.02), delta=2)
        self.assertGreater(loudness, 0.2)
        self.assertLess(pitches(wav.read_bytes())[-1][1], AUDIBLE)

    def test_without_a_sound_device_all_else_goes_on(self):
        settings = self.folder / "none.conf"
        settings.write_text("[general]\ndrivers = -all\n")
        process, _ = self.press(ALSOFT_CONF=str(settings), ALSOFT_DRIVERS="nothing")
        self.strike("a")
        self.come_to_rest()
        ticks = len(self.forces())
        self.wait_for(lambda: (self.forces()[ticks:] > FELT).any())
        self.close(process)


if __name__ == "__main__":
    unittest.main()
