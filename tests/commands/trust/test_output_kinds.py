# SPDX-License-Identifier: Apache-2.0
"""What is no place for an output is refused by its kind before work begins, and stdout carries one thing alone."""
import contextlib
import os
import pathlib
import socket
import stat
import sys
import unittest

sys.path.insert(0, "..")
import sample_asset  # noqa: E402
import test_asset_commands as assets  # noqa: E402

BIN, OK, INVALID = assets.BIN, assets.OK, assets.INVALID


@contextlib.contextmanager
def no_files(folder):
    """Paths of what is no file, and what each is said to be."""
    pipe, path, link, inner = (folder / name for name in ("pipe", "socket", "link", "inner"))
    os.mkfifo(pipe)
    link.symlink_to(pipe)
    inner.mkdir()
    with socket.socket(socket.AF_UNIX) as listening:
        listening.bind(str(path))
        yield {pipe: "is a pipe", link: "is a pipe", path: "is a socket", inner: "is a folder", "/dev/null": "is a device"}
    for made in (pipe, path, link):
        made.unlink()
    inner.rmdir()


class Kinds(sample_asset.SampleAsset):
    writer = "write_sample_case"

    def assertRefusesEach(self, program, *arguments, but=()):
        """Without waiting for a pipe's reader, and leaving all as it was, with --force too."""
        with no_files(self.folder) as kinds:
            for target, kind in kinds.items():
                if kind in but:
                    continue
                before = os.lstat(target)
                for force in ((), ("--force",)):
                    with self.subTest(program=program, target=target, force=force):
                        refused = assets.run(BIN / program, *arguments, target, *force)
                        self.assertEqual((refused.returncode, refused.stdout), (INVALID, ""), refused.stderr)
                        self.assertIn(f"{target}: {kind}", refused.stderr)
                        self.assertEqual(refused.stderr.count("\n"), 1, refused.stderr)
                self.assertEqual((os.lstat(target).st_ino, os.lstat(target).st_mode), (before.st_ino, before.st_mode))

    def touch(self, *arguments):
        return assets.run(BIN / "palpate-touch", self.asset, "--seconds", 0.05, "--virtual-clock", *arguments)

    def test_a_recording_needs_a_file(self):
        self.assertRefusesEach("palpate-touch", self.asset, "--seconds", 0.05, "--virtual-clock", "--record")

    @unittest.skipUnless((BIN / "palpate-train").exists(), "the trainer is not built here")
    def test_a_recording_of_the_trainer_needs_a_file(self):
        self.assertRefusesEach("palpate-train", self.asset, "--record")

    def test_a_recording_is_not_sent_through_stdout(self):
        refused = self.touch("--record", "/dev/stdout")
        self.assertEqual((refused.returncode, refused.stdout), (INVALID, ""), refused.stderr)
        self.assertIn("/dev/stdout: is a pipe", refused.stderr)

    def test_a_recording_goes_where_a_link_leads(self):
        link, file = self.folder / "run.h5", self.folder / "elsewhere.h5"
        link.symlink_to(file)
        made = self.touch("--record", link, "--record-seconds", 1)
        self.assertEqual(made.returncode, OK, made.stderr)
        self.assertTrue(link.is_symlink() and stat.S_ISREG(file.stat().st_mode))


if __name__ == "__main__":
    unittest.main()
