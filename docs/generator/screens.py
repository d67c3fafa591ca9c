#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Takes the pictures that pages show: the trainer's screens, of the demo's cases in real windows of three sizes, and a report.

    docs/generator/screens.py [SCREEN | report ...]        (pipelines/demo.sh before it; all of them without a name)

PALPATE_BIN has the programs, build/release/bin without it. Each screen is reached as a user would, by mouse and keys, in an X server
of its own; software rendering leaves out detail in large windows, and the pictures show that. The report is as Chromium shows it.
"""
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(SOURCE / "tests/commands"), str(SOURCE / "tests/commands/pages")]
from browser import CHROMIUM, QUIET  # noqa: E402
from x_server import XServer  # noqa: E402

BIN = Path(os.environ.get("PALPATE_BIN", SOURCE / "build/release/bin"))
SIZES = ((1280, 720), (1920, 1080), (3840, 2160))  # pixels
ON_THE_ORGAN = 0.52, 0.50  # of the window


class Trainer:
    """The trainer in a window, and a hand at mouse and keyboard. Places are shares of the window."""

    def __init__(self, server, case, folder, *options):
        self.server = server
        self.size = tuple(map(int, server.size.split("x")))
        command = [BIN / "palpate", "train", SOURCE / f"build/demo/{case}.vtkhdf", "--size", server.size, "--quiet", *map(str, options)]
        self.process = subprocess.Popen(command, env=server.environment, cwd=folder, stdout=subprocess.DEVNULL)
        self.window = self.x("xdotool", "search", "--sync", "--onlyvisible", "--name", f"Palpate: {case}").split()[0].decode()
        self.x("xdotool", "windowfocus", "--sync", self.window)
        self.wait(4)

    def x(self, *command):
        return subprocess.run([*map(str, command)], env=self.server.environment, check=True, capture_output=True, timeout=60).stdout

    def wait(self, seconds):
        time.sleep(seconds * (1 if self.size[0] < 3840 else 2.5))

    def point(self, x, y):
        self.x("xdotool", "mousemove", "--window", self.window, int(x * self.size[0]), int(y * self.size[1]))

    def keys(self, *keys):
        for key in keys:
            self.x("xdotool", "key", key)
            self.wait(0.6)

    def press(self, x, y, seconds=1.5):
        """Presses the organ under a place and stays there."""
        self.point(x, y)
        self.wait(1.5)
        self.x("xdotool", "mousedown", 1)
        self.wait(seconds)

    def let_go(self):
        self.x("xdotool", "mouseup", 1)
        self.wait(1)

    def take(self, path):
        dump = self.x("xwd", "-silent", "-id", self.window)
        subprocess.run(["convert", "xwd:-", "-quality", "75", path], input=dump, check=True)

    def close(self):
        self.process.terminate()
        self.process.wait()


def after(case, *keys, seconds=1, options=()):
    """A screen that so many keys lead to, so many seconds later."""

    def reach(server, folder):
        trainer = Trainer(server, case, folder, "--attempts", folder / "attempts", *options)
        trainer.keys(*keys)
        trainer.wait(seconds)
        return trainer

    return reach


COUNTDOWN = 4  # s, of an exercise, and a little


def press(server, folder):
    trainer = after("liver", "BackSpace")(server, folder)
    trainer.press(*ON_THE_ORGAN)
    return trainer


def result(server, folder):
    trainer = SCREENS["touch"](server, folder)
    for mark in ((0.420, 0.642), (0.353, 0.396), (0.467, 0.410)):  # the first three
        trainer.press(*mark)
        trainer.let_go()
    trainer.keys("e")
    trainer.wait(1)
    return trainer


def way(server, folder):
    trainer = result(server, folder)
    trainer.keys("space")
    return trainer


def again(server, folder):
    trainer = result(server, folder)
    trainer.keys("F4")
    trainer.wait(3)
    trainer.keys("space")
    return trainer


def found(server, folder):
    trainer = after("liver", "2", seconds=COUNTDOWN)(server, folder)
    trainer.press(*ON_THE_ORGAN)
    trainer.keys("m")
    trainer.let_go()
    return trainer


def playback(server, folder):
    trainer = played(server, folder, "--script", "slide", "--seconds", "6")
    trainer.keys("space")
    return trainer


def played(server, folder, *hand):
    """A recording of what `palpate touch` does to the liver with these options."""
    recording = folder / "run.h5"
    subprocess.run([BIN / "palpate", "touch", SOURCE / "build/demo/liver.vtkhdf", *hand, "--virtual-clock", "--record", recording, "--quiet",
                    "--force"], check=True, stdout=subprocess.DEVNULL)
    return Trainer(server, "liver", folder, "--play", recording)


def forceps(server, folder):
    """To its end, where the rim is drawn out."""
    return played(server, folder, "--instrument", "forceps", "--depth", "20", "--seconds", "3.8")


FORCEPS = "--instrument", "forceps"

SCREENS = {
    "start": after("liver"),
    "head": after("nasopharynx"),
    "trainee": after("liver", "F3"),
    "press": press,
    "stiffness": after("liver", "BackSpace", "g"),
    "touch": after("liver", "1", seconds=COUNTDOWN),
    "paused": after("liver", "1", "Return", "space"),
    "result": result,
    "way": way,
    "again": again,
    "found": found,
    "trace": after("liver", "3", seconds=COUNTDOWN),
    "scope": after("nasopharynx", "1", "v", seconds=COUNTDOWN),
    "retract": after("liver", "1", seconds=COUNTDOWN, options=FORCEPS),
    "teacher": after("liver", "F2"),
    "scan": after("nasopharynx", "BackSpace", "c", "x"),
    "hidden": after("liver", "BackSpace", "t"),
    "endoscope": after("nasopharynx", "BackSpace", "v", "v"),
    "playback": playback,
    "forceps": forceps,
}


PICTURES = SOURCE / "docs/pictures"


def take_screen(name, size, picture):
    """Pictures a screen in a window of that size."""
    with tempfile.TemporaryDirectory() as folder, XServer("{}x{}".format(*size)) as server:
        trainer = SCREENS[name](server, Path(folder))
        trainer.take(picture)
        trainer.close()


def take_report(picture):
    """Pictures the upper part of the head's report as a browser shows it."""
    with tempfile.TemporaryDirectory() as folder:
        shot = Path(folder) / "report.png"
        subprocess.run([CHROMIUM, *QUIET, f"--user-data-dir={folder}/profile", "--hide-scrollbars", "--window-size=1280,900",
                        f"--screenshot={shot}", (SOURCE / "build/demo/nasopharynx.html").as_uri()],
                       check=True, capture_output=True, timeout=120)
        subprocess.run(["convert", shot, "-quality", "75", picture], check=True)


def main():
    chosen = sys.argv[1:] or [*SCREENS, "report"]
    for name in chosen:
        if name == "report":
            take_report(PICTURES / "report.webp")
        else:
            for size in SIZES:
                picture = PICTURES / "screens" / str(size[1]) / f"{name}.webp"
                picture.parent.mkdir(parents=True, exist_ok=True)
                take_screen(name, size, picture)
        print(name, flush=True)


if __name__ == "__main__":
    main()
