# SPDX-License-Identifier: Apache-2.0
"""An X server of a test's own."""
import os
import subprocess

# What drives and pictures a window in it.
NEEDED = ("Xvfb", "xdotool", "xwd", "convert")


class XServer:
    """An Xvfb of our own; -noreset keeps it when its last client leaves."""

    def __init__(self, size="1400x800"):
        self.size = size  # pixels

    def __enter__(self):
        reader, writer = os.pipe()
        self.process = subprocess.Popen(
            ["Xvfb", "-displayfd", str(writer), "-screen", "0", f"{self.size}x24", "-nolisten", "tcp", "-noreset"],
            pass_fds=[writer],
            stderr=subprocess.DEVNULL,
        )
        os.close(writer)
        with os.fdopen(reader) as stream:
            self.environment = dict(os.environ, DISPLAY=":" + stream.readline().strip())
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait()
