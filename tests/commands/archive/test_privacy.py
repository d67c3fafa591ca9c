# SPDX-License-Identifier: GPL-3.0-or-later
"""palpate verify --privacy: every kind of leak is found where it was planted, and nothing in what Palpate makes of a scan."""
import os
import pathlib
import subprocess
import tarfile
import tempfile
import unittest

import h5py

from test_export import CHEST  # first: it says where the next ones are
from sample_asset import SampleAsset
from test_import import COUNT, dicom_slice, metaimage, nifti, nrrd

BIN = pathlib.Path(os.environ["PALPATE_BIN"])
HEAD = pathlib.Path(os.environ.get("PALPATE_DATA", "")) / "head_ct_cranium" / "head_ct_cranium.nrrd"
OK, USAGE, CONTRACT = 0, 2, 4
PERSON = {"USER": "jane_roe", "LOGNAME": "jane_roe", "HOSTNAME": "theatre7.hospital"}
SECRETS = ("jane_roe", "theatre7", "ROE^JANE", "PID-77123", "19610203", "1961-02-03", "roe@hospital", "/home/jane",
           "1.2.826.0.1.99", "Saint Elsewhere")


class Privacy(SampleAsset):
    def verify(self, *files, code):
        result = subprocess.run([BIN / "palpate-verify", "--privacy", *map(str, files)], text=True, stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, timeout=120, env={**os.environ, **PERSON})
        self.assertEqual(result.returncode, code, result.stdout + result.stderr)
        return result.stdout

    def found(self, name, content, *kinds):
        """Writes a file in which exactly these kinds are to be found."""
        path = self.folder / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        said = self.verify(path, code=CONTRACT)
        rows = [line for line in said.splitlines() if line.startswith(f"{path}: ")]
        self.assertEqual({row[len(str(path)) + 2:].split(": ")[1] for row in rows}, set(kinds), said)
        for secret in SECRETS:
            self.assertNotIn(secret, said.replace(str(path), ""))
        path.unlink()
        return said

    def test_leaks_in_text_are_found_line_by_line(self):
        said = self.found("case.log", "fine\nreading /home/jane/ct/volume.nrrd\n", "path")
        self.assertIn("case.log: line 2: path: /h... (25 characters)", said)
        for name, text, kind in (
                ("a.json", '{"volume": "/data/roe/ct.nii"}', "path"), ("b.html", "<p>C:\\Users\\jane\\ct</p>", "path"),
                ("b2.html", '<a href="file:///home/jane/x">', "path"),
                ("c.json", '{"by": "jane_roe"}', "user name"), ("d.log", "on theatre7.hospital, 2 cores", "host name"),
                ("e.txt", "ask jane.roe@hospital.example.org", "e-mail address"), ("f.txt", "born on 1961-02-03", "date of birth"),
                ("g.html", "<td>Roe^Jane</td>", "person's name"), ("h.json", '{"patient_id": "PID-77123"}', "patient field"),
                ("i.log", "StudyDate: 20010203", "study field"), ("j.json", '"1.2.826.0.1.99.55.1234567890.1"', "UID")):
            with self.subTest(name):
                self.found(name, text, kind)
        self.found("one_line.html", "x" * 5000 + " /home/jane/ct " + "y" * 5000, "path")

    def test_what_tells_nobody_is_no_finding(self):
        path = self.folder / "clean.txt"
        path.write_text("<b>max |C - C^T| 1e-7</b> https://example.org/home/page </div> a/home/b /VTKHDF/Points 10:30 2.25.123456789\n"
                        "1.2.840.10008.5.1.4.1.1.66.4 palpate 0.1.0 liver.nrrd /usr/bin/env janeiro\n")
        self.assertIn("1 files searched, 0 findings", self.verify(path, code=OK))
        path.unlink()

    def test_leaks_in_headers_are_found(self):
        voxels = bytes(n % 2 for n in range(COUNT))
        self.found("a.nrrd", nrrd(voxels), "header field")
        said = self.found("b.nii", nifti(voxels), "header field")
        for field in ("descrip", "aux_file", "intent_name"):
            self.assertIn(f"field {field}", said)
        self.found("c.mha", metaimage(voxels), "header field")
        clean = nifti(voxels)[:148] + bytes(104) + nifti(voxels)[252:328] + bytes(16) + nifti(voxels)[344:]
        self.found("d.nii", clean[:14] + b"roe".ljust(18, b"\0") + clean[32:], "header field")
        extension = clean.replace(b"Saint Elsewhere Dr Who", b"/home/jane/ct/volumes.")
        self.assertIn("header extension", self.found("e.nii", extension, "path"))

    def test_leaks_in_dicom_are_found(self):
        said = self.found("a.dcm", dicom_slice(1, uid="1.2.826.0.1.99.55.1234567890.1"), "UID", "date", "study attribute",
                          "person's name", "patient attribute", "date of birth")
        for where in ("(0010,0010) PatientName", "(0010,0020) PatientID", "(0010,0030) PatientBirthDate", "(0008,0080) Inst",
                      "(0008,103e) SeriesDescription"):
            self.assertIn(where, said)

    def test_leaks_in_hdf5_are_found(self):
        self.assertIn("0 findings", self.verify(self.asset, code=OK))
        for plant, kind in ((lambda file: file.attrs.__setitem__("made_by", "jane_roe"), "user name"),
                            (lambda file: file["/palpate"].attrs.__setitem__("from", "/home/jane/ct"), "path"),
                            (lambda file: file.create_dataset("/palpate/note", data="born 1961-02-03"), "date of birth"),
                            (lambda file: file.create_group("/palpate/Roe^Jane"), "person's name")):
            path = self.folder / "planted.vtkhdf"
            path.write_bytes(self.asset.read_bytes())
            with h5py.File(path, "r+") as file:
                plant(file)
            # What no trainer would load has a scan that cannot be looked at.
            loads = subprocess.run([BIN / "palpate-inspect", path], capture_output=True).returncode == OK
            self.found(path.name, path.read_bytes(), kind, *([] if loads else ["not looked at"]))

    def test_leaks_in_bytes_and_folders_are_found(self):
        self.found("a.bin", b"\0\1\2" + b"/home/jane/ct/volume.nrrd" + b"\0" * 9, "path")
        folder = self.folder / "out"
        (folder / "deep").mkdir(parents=True)
        (folder / "fine.txt").write_text("fine")
        (folder / "deep/log.txt").write_text("jane_roe")
        self.assertIn("2 files searched, 1 findings", self.verify(folder, code=CONTRACT))

    def test_several_files_are_for_privacy_only(self):
        result = subprocess.run([BIN / "palpate-verify", self.asset, self.asset], stderr=subprocess.PIPE, text=True)
        self.assertEqual(result.returncode, USAGE)
        self.assertIn("one asset", result.stderr)

    @unittest.skipUnless(HEAD.exists(), f"no {HEAD}")
    def test_a_face_is_found_in_volume_and_asset_until_it_is_taken_away(self):
        home = self.folder / "head"
        home.mkdir()
        self.assertIn("its voxels: face", self.verify(HEAD, code=CONTRACT))
        defaced = home / "defaced.nrrd"
        subprocess.run([BIN / "palpate-import", HEAD, "--deface", "-o", defaced], check=True, capture_output=True)
        self.verify(defaced, code=OK)
        case = home / "case.toml"
        case.write_text(f'schema = 1\nname = "head"\n[input]\nvolume = "{HEAD}"\n[[structure]]\nname = "skull"\nrecipe = "bone"\n'
                        '[[rigid]]\nname = "skull"\nmax_triangles = 200000\n')
        asset = home / "case.vtkhdf"
        for stage in ("import volume", "segment", "surface skull", "pack"):
            subprocess.run([BIN / "palpate-build", case, "-o", asset, "--stage", stage], check=True, capture_output=True)
        self.assertIn("its scan: face", self.verify(asset, code=CONTRACT))
        seen = subprocess.run([BIN / "palpate-inspect", asset, "--json", "-"], check=True, capture_output=True, text=True).stdout
        self.assertIn("shows a face", seen)

    @unittest.skipUnless(CHEST.exists(), f"no {CHEST}")
    def test_what_palpate_makes_of_a_scan_tells_nobody(self):
        home = self.folder / "made"
        home.mkdir()
        with tempfile.TemporaryDirectory() as scans:
            with tarfile.open(CHEST) as archive:
                archive.extractall(scans)
            (home.parent / "case.toml").write_text(
                f'schema = 1\nname = "chest"\n[input]\nvolume = "{scans}"\n'
                '[[structure]]\nname = "bone"\nrecipe = "bone"\n'
                '[[structure]]\nname = "body"\nrecipe = "threshold"\nlower_hu = -200\nkeep_largest = true\n'
                '[[structure]]\nname = "lump"\nrecipe = "sphere"\ninside = "body"\ncenter_mm = [0.0, 140.0, -640.0]\nradius_mm = 25.0\n'
                '[[rigid]]\nname = "bone"\nmax_triangles = 20000\n'
                '[[deformable]]\nname = "lump"\nmesh = { cell_size_mm = 9.0 }\n'
                'fixed = [{ box_mm = [-100.0, 150.0, -700.0, 100.0, 200.0, -600.0] }]\n'
                '[[deformable.region]]\nlabel = "lump"\ntissue = "liver"\n')
            built = subprocess.run([BIN / "palpate-build", self.folder / "case.toml", "-o", home / "case.vtkhdf"], text=True,
                                   stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=500)
        self.assertEqual(built.returncode, OK, built.stdout)
        made = sorted(path for path in home.rglob("*") if path.is_file())
        self.assertGreater(len(made), 10)
        # A stage's request names the files that it is run on again with; docs/archive.md says to leave these out.
        requests = [path for path in made if path.name.endswith(".request.json")]
        self.assertGreater(len(requests), 3)
        self.verify(*requests, code=CONTRACT)
        self.assertIn(" 0 findings", self.verify(*sorted(set(made) - set(requests)), code=OK))


if __name__ == "__main__":
    unittest.main()
