# SPDX-License-Identifier: GPL-3.0-or-later
"""A disk of its own for a test that fills it."""
import subprocess


def mounted(test, folder, size):
    """Mounts a disk of `size` ("4k") at a new `folder` until the test ends, or skips it; needs root."""
    folder.mkdir()
    made = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "none", folder], stderr=subprocess.PIPE, text=True)
    if made.returncode != 0:
        test.skipTest(f"no small disk can be mounted: {made.stderr.strip()}")
    test.addCleanup(subprocess.run, ["umount", folder], check=True)
    return folder
