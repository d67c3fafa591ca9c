# SPDX-License-Identifier: Apache-2.0
"""Where a command may write, and that an output appears whole or not at all."""
import contextlib
import os
import pathlib
import re
import shutil
import signal
import socket
import stat
import subprocess
import sys
import tempfile
import threading
import time
import unittest

sys.path.insert(0, "..")
import small_disk  # noqa: E402
import test_asset_commands as assets  # noqa: E402

BIN, OK, FAILED, INVALID = assets.BIN, assets.OK, assets.FAILED, assets.INVALID
# Programs that run in it find no files without names.
PLAIN_DISK = dict(os.environ, LD_PRELOAD=str(pathlib.Path(os.environ["PALPATE_BUILD"]) / "tests" / "plain_disk.so"))


class Outputs(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        assets.write_tetrahedron_surface(self.folder / "skull.vtp", 40)

    def obb(self, output, *arguments, **options):
        return assets.run(BIN / "palpate-obb", self.folder / "skull.vtp", "-o", output, *arguments, **options)

    def written(self):
        made = self.folder / "reference.obb.h5"
        self.assertEqual(self.obb(made, "--quiet").returncode, OK)
        return made.read_bytes()

    def assertRefused(self, output, kind, *arguments):
        before = os.lstat(output)
        for force in ((), ("--force",)):
            refused = self.obb(output, *force, *arguments)
            self.assertEqual(refused.returncode, INVALID, refused.stderr)
            self.assertIn(f"{output}: {kind}", refused.stderr)
        self.assertEqual(stat.S_IFMT(os.lstat(output).st_mode), stat.S_IFMT(before.st_mode))

    def staged(self, folder=None):
        return sorted(p.name for p in (folder or self.folder).iterdir() if p.name.startswith(".part"))

    def test_a_name_that_no_disk_takes_is_refused_with_it_and_what_to_do(self):
        long = "n" * 300
        for refused, code in ((self.obb(self.folder / f"{long}.h5"), FAILED), (assets.run(BIN / "palpate-inspect", long), INVALID)):
            self.assertEqual(refused.returncode, code, refused.stderr)
            self.assertRegex(refused.stderr, f"{long}.*: File name too long; check the path")

    def test_a_device_a_folder_and_a_socket_are_refused_by_their_kind(self):
        self.assertRefused("/dev/null", "is a device")
        self.assertRefused(self.folder, "is a folder")
        path = self.folder / "socket"
        with socket.socket(socket.AF_UNIX) as listening:
            listening.bind(str(path))
            self.assertRefused(path, "is a socket")
        self.assertEqual(self.staged(), [])

    def test_a_link_to_a_device_is_refused(self):
        link = self.folder / "nothing.obb.h5"
        link.symlink_to("/dev/null")
        self.assertRefused(link, "is a device")

    def test_a_dash_is_no_file(self):
        refused = self.obb("-", cwd=self.folder)
        self.assertEqual(refused.returncode, INVALID, refused.stderr)
        self.assertIn("/dev/stdout", refused.stderr)
        self.assertFalse((self.folder / "-").exists())

    def test_a_pipe_gets_the_whole_file(self):
        self.assertPipeGetsAll(os.environ)

    def test_a_pipe_gets_the_whole_file_where_files_need_names(self):
        private = self.folder / "tmp"
        private.mkdir()
        self.assertPipeGetsAll(dict(PLAIN_DISK, TMPDIR=str(private)))
        self.assertEqual(list(private.iterdir()), [])

    def assertPipeGetsAll(self, env):
        expected, pipe = self.written(), self.folder / "pipe.obb.h5"
        os.mkfifo(pipe)
        got = []
        reader = threading.Thread(target=lambda: got.append(pipe.read_bytes()))
        reader.start()
        made = self.obb(pipe, env=env)
        reader.join(timeout=60)
        self.assertEqual((made.returncode, got), (OK, [expected]), made.stderr)
        self.assertTrue(stat.S_ISFIFO(pipe.stat().st_mode))

    def test_standard_output_may_be_a_pipe(self):
        made = subprocess.run([BIN / "palpate-obb", self.folder / "skull.vtp", "-o", "/dev/stdout", "--quiet", "--json",
                               self.folder / "result.json"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=60)
        self.assertEqual((made.returncode, made.stdout), (OK, self.written()), made.stderr)

    def test_a_reader_that_goes_is_an_error_and_nothing_is_left(self):
        private = self.folder / "tmp"
        private.mkdir()
        ran = subprocess.run(["sh", "-c", '"$0" "$1" -o /dev/stdout --quiet --json "$2" | true', BIN / "palpate-obb",
                              self.folder / "skull.vtp", self.folder / "result.json"], env=dict(os.environ, TMPDIR=str(private)),
                             stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=60)
        self.assertIn("Broken pipe", ran.stderr)
        self.assertNotIn("/proc/self", ran.stderr)
        self.assertEqual(list(private.iterdir()), [])

    def waiting(self, env):
        """A process that has its JSON staged and is held up at its output, a pipe that nobody reads, and what is staged."""
        private, pipe = self.folder / "tmp", self.folder / "pipe.obb.h5"
        private.mkdir()
        os.mkfifo(pipe)
        running = subprocess.Popen([BIN / "palpate-obb", self.folder / "skull.vtp", "-o", pipe, "--quiet", "--json",
                                    self.folder / "result.json"], env=dict(env, TMPDIR=str(private)), stderr=subprocess.DEVNULL)
        self.addCleanup(running.wait)
        self.addCleanup(running.kill)
        # Both files are there, with a name or without one, and one is open twice: it is to be copied into the pipe.
        files = pathlib.Path(f"/proc/{running.pid}/fd")

        def ours():
            names = []
            for file in files.iterdir():
                with contextlib.suppress(OSError):  # closed meanwhile
                    names.append(os.readlink(file))
            return [name for name in names if re.match(rf"{self.folder}/(tmp/)?(#|\.part)", name)]

        end = time.monotonic() + 60
        while len(ours()) < 3 and time.monotonic() < end:
            time.sleep(0.02)
        self.assertEqual(len(ours()), 3)
        return running, self.staged() + self.staged(private)

    def require_nameless(self):
        try:
            os.close(os.open(self.folder, os.O_TMPFILE | os.O_RDWR))
        except OSError as error:
            self.skipTest(f"no files without names here: {error.strerror}")

    def test_an_interrupt_before_a_pipe_is_read_leaves_nothing(self):
        self.require_nameless()
        for env, count in ((os.environ, 0), (PLAIN_DISK, 2)):
            with self.subTest(staged=count), tempfile.TemporaryDirectory() as folder:
                before, self.folder = self.folder, pathlib.Path(folder)
                shutil.copy(before / "skull.vtp", folder)
                running, staged = self.waiting(env)
                self.assertEqual(len(staged), count, staged)
                running.terminate()
                self.assertEqual(running.wait(timeout=60), 130)
                self.assertEqual(self.staged() + self.staged(self.folder / "tmp"), [])
                self.folder = before

    def test_a_killed_process_leaves_nothing(self):
        self.require_nameless()
        running, staged = self.waiting(os.environ)
        self.assertEqual(staged, [])
        running.kill()
        running.wait()
        self.assertEqual(self.staged() + self.staged(self.folder / "tmp"), [])
        self.assertFalse((self.folder / "result.json").exists())

    def test_what_a_link_leads_to_is_replaced_whole(self):
        elsewhere = self.folder / "elsewhere"
        elsewhere.mkdir()
        file, link = elsewhere / "tree.obb.h5", self.folder / "link.obb.h5"
        link.symlink_to(file)
        self.assertEqual(self.obb(link).returncode, OK)  # which is not there yet
        self.assertEqual(self.obb(link).returncode, INVALID)
        file.write_text("old")
        self.assertEqual(self.obb(link, "--force").returncode, OK)
        self.assertTrue(link.is_symlink())
        self.assertEqual(file.read_bytes(), self.written())
        self.assertEqual(self.staged(elsewhere), [])

    def test_a_circle_of_links_is_refused(self):
        (self.folder / "a.obb.h5").symlink_to(self.folder / "b.obb.h5")
        (self.folder / "b.obb.h5").symlink_to(self.folder / "a.obb.h5")
        self.assertEqual(self.obb(self.folder / "a.obb.h5").returncode, INVALID)

    def test_what_a_killed_process_left_where_files_need_names_is_removed_by_the_next_and_what_lives_is_not(self):
        running, staged = self.waiting(PLAIN_DISK)
        self.assertRegex(" ".join(staged), rf"^\.part-[0-9a-f]{{8}}-{running.pid}\.0-result\.json "
                                           rf"\.part-[0-9a-f]{{8}}-{running.pid}\.0-pipe\.obb\.h5$")
        here = self.staged()
        elsewhere = self.folder / ".part-00000000-1.0-of-another-machine"  # whose locks may not be seen here
        elsewhere.write_text("staged")
        self.assertEqual(self.obb(self.folder / "one.obb.h5").returncode, OK)
        self.assertEqual(self.staged(), sorted([elsewhere.name, *here]))
        elsewhere.unlink()
        running.send_signal(signal.SIGKILL)
        running.wait()
        self.assertEqual(self.staged(), here)
        self.assertEqual(self.obb(self.folder / "two.obb.h5").returncode, OK)
        self.assertEqual(self.staged(), [])

    def test_a_disk_without_locks_or_files_without_names_gets_whole_files(self):
        made = self.obb(self.folder / "one.obb.h5", env=dict(PLAIN_DISK, NO_LOCKS="1"))
        self.assertEqual(made.returncode, OK, made.stderr)
        self.assertEqual((self.folder / "one.obb.h5").read_bytes(), self.written())
        self.assertEqual(self.staged(), [])

    def test_a_file_of_another_that_looks_staged_is_kept(self):
        for name in (".party-plan", ".part-of-mine", "part1-x"):
            (self.folder / name).write_text("mine")
        self.assertEqual(self.obb(self.folder / "one.obb.h5").returncode, OK)
        for name in (".party-plan", ".part-of-mine", "part1-x"):
            self.assertEqual((self.folder / name).read_text(), "mine")

    def assertFailsAndKeeps(self, earlier, made):
        self.assertEqual(made.returncode, FAILED, made.stderr)
        self.assertIn("could not be written", made.stderr)
        self.assertNotIn("/proc/self", made.stderr)
        self.assertEqual(earlier.read_text(), "earlier")
        self.assertEqual(self.staged(earlier.parent), [])

    def test_a_quota_leaves_the_earlier_file(self):
        earlier = self.folder / "tree.obb.h5"
        earlier.write_text("earlier")
        limited = subprocess.run(["sh", "-c", 'ulimit -f 1; exec "$0" "$@"', BIN / "palpate-obb", self.folder / "skull.vtp", "-o",
                                  earlier, "--force"], text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=60)
        self.assertFailsAndKeeps(earlier, limited)

    @unittest.skipUnless(os.geteuid() == 0, "mounting a small disk needs root")
    def test_a_full_disk_leaves_the_earlier_file(self):
        disk = small_disk.mounted(self, self.folder / "disk", "4k")
        earlier = disk / "tree.obb.h5"
        earlier.write_text("earlier")
        self.assertFailsAndKeeps(earlier, self.obb(earlier, "--force"))

    @unittest.skipUnless(os.geteuid() == 0, "giving up rights needs root")
    def test_a_folder_that_must_not_be_written_to_is_named(self):
        locked = self.folder / "locked"
        locked.mkdir()
        os.chmod(self.folder, 0o755)
        earlier = locked / "tree.obb.h5"
        earlier.write_text("earlier")
        os.chmod(locked, 0o555)
        refused = self.obb(earlier, "--force", user="nobody", extra_groups=[])
        os.chmod(locked, 0o755)
        self.assertFailsAndKeeps(earlier, refused)
        self.assertIn("Permission denied", refused.stderr)

    @unittest.skipUnless(shutil.which("strace"), "strace is not installed")
    def test_a_power_cut_finds_the_old_file_or_the_new_one(self):
        # Content before the name, the name before success: in this order, to the disk.
        for env in (os.environ, PLAIN_DISK):
            trace, output = self.folder / "trace", self.folder / "tree.obb.h5"
            traced = subprocess.run(["strace", "-f", "-y", "-e", "trace=fsync,rename", "-o", trace, BIN / "palpate-obb",
                                     self.folder / "skull.vtp", "-o", output, "--force"], stdout=subprocess.PIPE,
                                    stderr=subprocess.PIPE, text=True, env=env)
            if "ptrace" in traced.stderr:
                self.skipTest("processes must not be traced here")
            calls = [line.split(maxsplit=1)[1] for line in trace.read_text().splitlines() if "(" in line]
            named = [i for i, call in enumerate(calls) if call.startswith("rename(") and call.split('"')[3] == str(output)]
            self.assertEqual(len(named), 1, calls)
            kept = [call.startswith("fsync(") and call.endswith("= 0") for call in calls]
            holds = lambda call: f"<{self.folder}>" not in call  # not the folder's names, but the file's content
            self.assertTrue(any(kept[i] and holds(calls[i]) for i in range(named[0])), calls)
            self.assertTrue(any(kept[i] and not holds(calls[i]) for i in range(named[0], len(calls))), calls)


if __name__ == "__main__":
    unittest.main()
