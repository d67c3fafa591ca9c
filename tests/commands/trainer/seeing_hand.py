# SPDX-License-Identifier: GPL-3.0-or-later
"""A hand that does the trainer's exercises with mouse and keys, and knows what is seen in the window and nothing else."""
import time

import numpy as np

from trainer_case import pixels

SCENE = slice(105, 590)  # rows between texts and buttons, of 720
WARNING = slice(0, 45)  # of those, which a warning takes
YELLOW = np.array([255, 214, 64]) / 255  # of the mark that is due and of a line
DEEPER = 12  # notches of the wheel with which a clumsy hand presses, half a millimetre each


class SeeingHand:
    """On a window of 1280x720 pixels; `x(*command)` runs a command in its display and returns what that prints."""

    def __init__(self, x, window):
        self.x, self.window = x, window

    def key(self, *keys, delay=12):
        self.x("xdotool", "key", "--delay", delay, *keys)

    def point(self, pixel):
        self.x("xdotool", "mousemove", "--window", self.window, *map(int, pixel))

    def look(self):
        """Rows from above of (r, g, b)."""
        dump = self.x("xwd", "-silent", "-id", self.window)
        return np.frombuffer(pixels(dump), np.uint8).reshape(720, 1280, 3).astype(int)

    def yellow(self, warned=True):
        """Pixels (n, 2), x and y, of the mark that is due and of the line."""
        seen = self.look()[SCENE]
        brightest = seen.max(-1)
        alike = np.abs(seen / brightest[..., None].clip(1) - YELLOW).max(-1) < 0.12
        if warned:
            alike[WARNING] = False
        y, x = np.nonzero(alike & (brightest > 150))
        return np.column_stack([x, y + SCENE.start])

    def due(self):
        """Where the mark that is due is seen; None where there is none."""
        pixels = self.yellow()
        return np.median(pixels, axis=0) if len(pixels) > 8 else None

    @staticmethod
    def wait_for(look):
        """What is seen, once it is: a busy machine draws late."""
        end = time.monotonic() + 20
        while (seen := look()) is None or seen is False:
            assert time.monotonic() < end, "what was waited for is not seen"
            time.sleep(0.2)
        return seen

    def rest(self):
        """Until nothing moves in the picture, or six seconds: a busy machine takes its time."""
        end, before = time.monotonic() + 6, self.look()[SCENE]
        while time.monotonic() < end:
            time.sleep(0.25)
            now = self.look()[SCENE]
            if np.abs(now - before).mean() < 0.3:
                return
            before = now

    def begin(self):
        """Away from everything, and not after a countdown."""
        self.point((30, 300))
        self.key("Return")
        time.sleep(1)

    def hold(self, deeper):
        """Presses where it is, and the wheel, if it is a clumsy hand."""
        self.x("xdotool", "mousedown", 1)
        time.sleep(0.3)
        if deeper:
            self.x("xdotool", "click", "--repeat", deeper, 4)
        time.sleep(1.2)

    def let_go(self):
        self.x("xdotool", "mouseup", 1)
        time.sleep(0.4)

    def touch(self, deeper=0):
        """Presses each mark that becomes due, until none is seen, for a minute at most."""
        self.begin()
        self.wait_for(self.due)
        end = time.monotonic() + 60
        while time.monotonic() < end and (due := self.due()) is not None:
            self.point(due)
            self.rest()  # the tool goes there
            self.hold(deeper)
            time.sleep(0.2)
            self.let_go()

    def trace(self, deeper=0):
        """Drags along the line and a little beyond its end."""
        self.begin()
        self.wait_for(self.due)
        way = self.line()
        beyond = way[-1] + np.arange(1, 4)[:, None] * (way[-1] - way[-2])
        self.point(way[0])
        self.rest()
        self.hold(deeper)
        for pixel in (*way[1:], *beyond):
            self.point(pixel)
            time.sleep(0.15)
        self.let_go()

    def line(self):
        """Pixels six apart along the yellow line, from the end where the ball is."""
        left = self.yellow(warned=False)[::2].astype(float)
        crowd = (np.linalg.norm(left[:, None] - left, axis=2) < 12).sum(1)  # the ball is where most is yellow
        step, way = 6, [left[np.argmax(crowd)]]
        while True:
            distance = np.linalg.norm(left - way[-1], axis=1)
            left, distance = left[distance > step], distance[distance > step]
            if not len(left) or distance.min() > 3 * step:
                return np.array(way)
            way.append(left[np.argmin(distance)])

    def answer(self, pixel, deeper=0):
        """Presses there and says that it is here."""
        self.begin()
        self.point(pixel)
        self.rest()
        self.hold(deeper)
        self.rest()
        self.key("m")
        self.let_go()

    def lead_scope(self, waits=False, scrapes=False):
        """Ahead through the endoscope's picture, by the wheel and by W in turn, until the result is there, for two minutes at most.
        `waits`: after every three millimetres, until the picture rests; `scrapes`: drags the tip to all sides after every 24."""
        self.point((30, 300))
        self.key("v")
        end, steps = time.monotonic() + 120, 0
        while time.monotonic() < end and not self.sees_result():
            self.x("xdotool", "click", "--repeat", 3, "--delay", 60, 4)
            if waits:
                self.rest()
            self.key(*["w"] * 6, delay=40)
            if waits:
                self.rest()
            steps += 1
            for aside in ((400, 0), (-400, 0), (0, 400), (0, -400)) if scrapes and steps % 4 == 0 else ():
                self.drag(1, *aside)
                time.sleep(0.5)

    def sees_result(self):
        """Whether its page lies over the endoscope's picture, which is round: left of that its choices are as yellow as marks."""
        x, y = self.yellow().T
        return ((x < 280) & (y > 500)).sum() > 100

    def drag(self, button, dx, dy):
        """From the picture's middle."""
        self.point((640, 360))
        self.x("xdotool", "mousedown", button)
        for _ in range(10):
            self.x("xdotool", "mousemove_relative", "--", dx // 10, dy // 10)
            time.sleep(0.03)
        self.x("xdotool", "mouseup", button)
        time.sleep(0.5)
