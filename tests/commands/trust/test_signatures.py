# SPDX-License-Identifier: GPL-3.0-or-later
"""palpate pack --sign and --trusted, judged by the openssl command."""
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import h5py

sys.path.insert(0, "..")
import test_asset_commands as assets  # noqa: E402
from forge import rehash  # noqa: E402

BIN, OK, INVALID, run = assets.BIN, assets.OK, assets.INVALID, assets.run


def openssl(*arguments):
    return subprocess.run(["openssl", *map(str, arguments)], check=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT).stdout


@unittest.skipUnless(shutil.which("openssl"), "openssl is not installed")
class Signatures(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        cls.folder = pathlib.Path(temporary.name)
        for name in ("lab", "stranger"):
            openssl("genpkey", "-algorithm", "ed25519", "-out", cls.folder / f"{name}.pem")
            openssl("pkey", "-in", cls.folder / f"{name}.pem", "-pubout", "-out", cls.folder / f"{name}.pub.pem")
        assets.write_block(cls.folder / "wall.vtu")
        condensed = run(BIN / "palpate-condense", cls.folder / "wall.vtu", "--material", "1:5,0.45", "--fixed", "plane:0,0,1,0,0,-1",
                        "-o", cls.folder / "wall.body.h5")
        assert condensed.returncode == OK, condensed.stderr
        cls.asset, cls.plain = cls.folder / "signed.vtkhdf", cls.folder / "plain.vtkhdf"
        for path, extra in ((cls.asset, ("--sign", cls.folder / "lab.pem")), (cls.plain, ())):
            packed = run(BIN / "palpate-pack", "--name", "case", "--deformable", f"wall={cls.folder / 'wall.body.h5'}", "-o", path, *extra)
            assert packed.returncode == OK, packed.stderr

    def trusting(self, command, asset, name, *more):
        return run(BIN / f"palpate-{command}", asset, "--trusted", self.folder / f"{name}.pub.pem", *more)

    def touch(self, asset, name):
        return self.trusting("touch", asset, name, "--script", "press", "--seconds", 0.05, "--virtual-clock", "--quiet")

    def test_openssl_agrees_with_the_signature(self):
        with h5py.File(self.asset) as file:
            head = {name: file["palpate"].attrs[name].decode() for name in ("manifest_sha256", "signature", "public_key")}
        message, signature = self.folder / "message", self.folder / "signature"
        message.write_text(f"palpate asset\nmanifest_sha256 {head['manifest_sha256']}\n")
        signature.write_bytes(bytes.fromhex(head["signature"]))
        said = openssl("pkeyutl", "-verify", "-pubin", "-inkey", self.folder / "lab.pub.pem", "-rawin", "-in", message, "-sigfile", signature)
        self.assertIn(b"Success", said)
        self.assertIn(head["public_key"], run(BIN / "palpate-inspect", self.asset).stdout)

    def test_who_trusts_the_key_loads_the_asset(self):
        for ran in (self.trusting("verify", self.asset, "lab"), self.touch(self.asset, "lab")):
            self.assertEqual(ran.returncode, OK, ran.stderr)

    def test_who_trusts_another_or_finds_no_signature_does_not(self):
        for asset, name, reason in ((self.asset, "stranger", "is signed by"), (self.plain, "lab", "is not signed")):
            for refused in (self.trusting("verify", asset, name), self.touch(asset, name)):
                self.assertEqual(refused.returncode, INVALID, refused.stderr)
                self.assertIn(reason, refused.stderr)

    def test_a_change_with_every_digest_made_anew_breaks_the_signature(self):
        forged = self.folder / "forged.vtkhdf"
        shutil.copy(self.asset, forged)
        with h5py.File(forged, "r+", libver=("v110", "v110")) as file:
            file["palpate/haptics"].attrs["max_force"] = 2.5
            rehash(file)
        for refused in (self.touch(forged, "lab"), run(BIN / "palpate-inspect", forged), run(BIN / "palpate-verify", forged)):
            self.assertEqual(refused.returncode, INVALID, refused.stderr)
            self.assertIn("signature that is false", refused.stderr)

    def test_a_file_without_a_key_is_named(self):
        refused = run(BIN / "palpate-verify", self.asset, "--trusted", self.folder / "lab.pem")
        self.assertEqual(refused.returncode, INVALID, refused.stderr)
        self.assertIn("lab.pem: holds no public keys alone", refused.stderr)


if __name__ == "__main__":
    unittest.main()
