# SPDX-License-Identifier: Apache-2.0
"""What is no place for an output is refused by its kind before work begins, and stdout carries one thing alone."""
import contextlib
import json
import os
import pathlib
import socket
import stat
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, "..")
import sample_asset  # noqa: E402
import test_asset_commands as assets  # noqa: E402

BIN, OK, USAGE, INVALID = assets.BIN, assets.OK, assets.USAGE, assets.INVALID
RESULT = "peak_memory_bytes"  # of every command's result


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

    def test_the_message_of_a_failure_goes_to_no_device_socket_or_folder(self):
        self.assertRefusesEach("palpate-inspect", self.folder / "absent", "--error-file", but=("is a pipe",))

    def fail(self, *arguments, **options):
        return assets.run(BIN / "palpate-inspect", self.folder / "absent", "--error-file", *arguments, **options)

    def test_the_message_of_a_failure_replaces_a_file_only_if_forced(self):
        kept = self.folder / "kept.txt"
        kept.write_text("kept")
        refused = self.fail(kept)
        self.assertEqual((refused.returncode, kept.read_text()), (INVALID, "kept"))
        self.assertIn(f"{kept}: exists already", refused.stderr)
        failed = self.fail(kept, "--force")
        self.assertEqual(failed.returncode, INVALID)
        self.assertIn("absent: no such file", failed.stderr)
        self.assertEqual(kept.read_text(), failed.stderr)
        self.assertIn("absent: no such file", self.fail("/dev/stdout").stdout)
        early = self.fail(kept, "--force", "--request", self.folder / "none.json")
        self.assertIn("none.json: no such file", early.stderr)
        self.assertEqual(kept.read_text(), early.stderr)

    def test_the_message_of_a_failure_is_no_file_named_dash(self):
        refused = self.fail("-", cwd=self.folder)
        self.assertEqual(refused.returncode, INVALID)
        self.assertIn("-: is no file", refused.stderr)
        self.assertFalse((self.folder / "-").exists())

    def test_where_nothing_fails_there_is_no_message(self):
        made = assets.run(BIN / "palpate-inspect", self.asset, "--error-file", self.folder / "none.txt")
        self.assertEqual((made.returncode, (self.folder / "none.txt").exists()), (OK, False), made.stderr)

    def test_a_folder_of_results_is_no_file_or_anything_else(self):
        file, nowhere = self.folder / "file", self.folder / "nowhere"
        file.write_text("kept")
        nowhere.symlink_to(self.folder / "absent")
        for program, *arguments in (("palpate-batch", file, "-o"), ("palpate-batch", file, "--check", "-o"), ("palpate-bench", "puncture", "-o"),
                                    ("palpate-build", file, "-o", self.folder / "case.vtkhdf", "--parts")):
            self.assertRefusesEach(program, *arguments, but=("is a folder",))
            for target, said in ((file, f"{file}: is a file"), (file / "below", f"{file}: is a file"), ("-", "-: is no folder"),
                                 (nowhere, f"{nowhere}: is a link that leads nowhere")):
                refused = assets.run(BIN / program, *arguments, target, cwd=self.folder)
                self.assertEqual(refused.returncode, INVALID, refused.stderr)
                self.assertIn(said, refused.stderr)
        self.assertEqual(file.read_text(), "kept")
        file.unlink()
        nowhere.unlink()

    def test_a_build_names_the_kind_of_what_its_links_lead_to(self):
        for name, ending in (("case.vtkhdf", ".vtkhdf"), ("case.html", ".html")):
            link = self.folder / name
            with no_files(self.folder) as kinds:
                for target, kind in kinds.items():
                    link.symlink_to(target)
                    for force in ((), ("--force",)):
                        refused = assets.run(BIN / "palpate-build", self.asset, "-o", self.folder / "case.vtkhdf", *force)
                        self.assertEqual(refused.returncode, INVALID, refused.stderr)
                        self.assertIn(f"{ending}: {kind}", refused.stderr)
                    link.unlink()

    def test_a_key_is_a_file_and_nobody_waits_for_the_writer_of_a_pipe(self):
        signing = (("palpate-pack", "--name", "case", "--rigid", f"skull={self.surface()}", "-o", self.folder / "signed.vtkhdf", "--sign"),
                   ("palpate-build", self.asset, "-o", self.folder / "built.vtkhdf", "--sign"))
        trusting = (("palpate-touch", self.asset, "--trusted"), ("palpate-verify", self.asset, "--trusted"))
        for program, *arguments in signing + trusting:
            self.assertRefusesEach(program, "--quiet", *arguments)
        self.assertFalse((self.folder / "signed.vtkhdf").exists())

    def surface(self):
        assets.write_tetrahedron_surface(self.folder / "skull.vtp", 40)
        return self.folder / "skull.vtp"

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

    def assertAlone(self, made):
        """What went to stdout is no command's result, which stderr has."""
        self.assertEqual(made.returncode, OK, made.stderr)
        self.assertNotIn(RESULT, made.stdout)
        self.assertIn(RESULT, made.stderr)

    def test_a_log_is_alone_in_stdout(self):
        made = self.touch("--log", "/dev/stdout")
        self.assertAlone(made)
        columns = {line.count(",") for line in made.stdout.splitlines()}
        self.assertEqual((len(columns), made.stdout.count("\n")), (1, 51), made.stdout[-200:])

    def test_a_curve_is_alone_in_stdout(self):
        made = self.touch("--curve", "/dev/stdout")
        self.assertAlone(made)
        self.assertTrue(made.stdout.startswith("<svg") and made.stdout.endswith("</svg>\n"), made.stdout[-200:])

    def test_json_is_alone_in_stdout_by_whatever_name(self):
        for name in ("-", "/dev/stdout", "/dev/fd/1"):
            made = self.touch("--json", name)
            self.assertEqual(made.returncode, OK, made.stderr)
            self.assertEqual(json.loads(made.stdout)["ticks"], 50)

    def test_an_empty_path_is_a_usage_error(self):
        for option in ("--json", "--error-file", "--log", "--curve", "--record", "--replay", "--trusted"):
            for words in ((option, ""), (f"{option}=",)):
                refused = self.touch(*words)
                self.assertEqual((refused.returncode, refused.stdout), (USAGE, ""), refused.stderr)
                self.assertIn(option, refused.stderr)
        refused = assets.run(BIN / "palpate-inspect", "")
        self.assertEqual(refused.returncode, USAGE)
        self.assertIn("file: is given an empty path", refused.stderr)

    def test_stdout_takes_one_output(self):
        for outputs in (("--log", "/dev/stdout", "--json", "-"), ("--log", "/dev/stdout", "--curve", "/proc/self/fd/1"),
                        ("--json", "/dev/stdout", "--curve", "/dev/stdout")):
            refused = self.touch(*outputs)
            self.assertEqual((refused.returncode, refused.stdout), (USAGE, ""), refused.stderr)
            self.assertIn("another output goes to stdout as well", refused.stderr)

    def test_quiet_leaves_out_what_an_output_keeps_from_stdout(self):
        made = self.touch("--log", "/dev/stdout", "--quiet")
        self.assertEqual((made.returncode, made.stderr), (OK, ""))
        self.assertNotIn(RESULT, made.stdout)


class Stdout(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        assets.write_tetrahedron_surface(self.folder / "skull.vtp", 40)

    def pack(self, output, *arguments, **streams):
        command = [BIN / "palpate-pack", "--name", "case", "--rigid", f"skull={self.folder / 'skull.vtp'}", "-o", output, *arguments]
        return subprocess.run(command, timeout=60, **{"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **streams})

    def test_an_asset_is_alone_in_stdout_a_pipe_or_a_file(self):
        self.assertEqual(self.pack(self.folder / "named.vtkhdf").returncode, OK)
        expected = (self.folder / "named.vtkhdf").read_bytes()
        piped = self.pack("/dev/stdout")
        self.assertEqual((piped.returncode, piped.stdout), (OK, expected), piped.stderr)
        self.assertIn(RESULT.encode(), piped.stderr)
        with open(self.folder / "kept.vtkhdf", "wb") as file:
            kept = self.pack("/dev/stdout", "--force", stdout=file)
        self.assertEqual((kept.returncode, (self.folder / "kept.vtkhdf").read_bytes()), (OK, expected), kept.stderr)
        self.assertIn(RESULT.encode(), kept.stderr)

    def init(self, output, *arguments):
        return assets.run(BIN / "palpate-init", self.folder / "skull.vtp", "-o", output, *arguments)

    def test_a_case_file_is_no_pipe(self):
        pipe = self.folder / "pipe.toml"
        os.mkfifo(pipe)
        for force in ((), ("--force",)):
            refused = self.init(pipe, *force)
            self.assertEqual(refused.returncode, INVALID)
            self.assertIn("pipe.toml: is a pipe (expected a file name)", refused.stderr)
        self.assertEqual(sorted(os.listdir(self.folder)), ["pipe.toml", "skull.vtp"])

    def test_a_result_that_stdout_does_not_take_is_told(self):
        for program, *arguments in (("palpate-pack", "--name", "case", "--rigid", f"skull={self.folder / 'skull.vtp'}", "-o",
                                     self.folder / "case.vtkhdf", "--force", "--quiet"), ("palpate-pack", "--version"), ("palpate-pack", "--help"),
                                    ("palpate-pack", "--xml"), ("palpate", "--version"), ("palpate", "--help")):
            with self.subTest(program=program, arguments=arguments), open("/dev/full", "w") as full:
                ran = subprocess.run([BIN / program, *arguments], stdout=full, stderr=subprocess.PIPE, text=True, timeout=60)
                self.assertEqual(ran.returncode, assets.FAILED)
                self.assertEqual(ran.stderr.count("\n"), 1)
                self.assertIn(f"{program}: stdout: could not be written: No space left on device", ran.stderr)
        self.assertTrue((self.folder / "case.vtkhdf").exists())


if __name__ == "__main__":
    unittest.main()
