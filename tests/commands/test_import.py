# SPDX-License-Identifier: GPL-3.0-or-later
"""palpate import: series lists and choices, label names, overlaps, and nothing of the patient in any output."""
import gzip
import json
import os
import pathlib
import pty
import struct
import subprocess
import tempfile
import unittest

BIN = pathlib.Path(os.environ["PALPATE_BIN"])
OK, USAGE, INVALID = 0, 2, 3
SIZE = (4, 5, 6)
COUNT = 4 * 5 * 6

# What must never come out again, planted in headers, comments, file names and folders.
IDENTITY = ["ROE^JANE", "PID-77123", "19610203", "Saint Elsewhere", "1.2.826.0.1.99", "portal venous Roe", "jane_roe",
            "Dr Who"]


def element(group, number, vr, value):
    value = value if isinstance(value, bytes) else value.encode()
    value += (b"\0" if vr == "UI" else b" ") * (len(value) % 2)
    length = b"\0\0" + struct.pack("<I", len(value)) if vr in ("OW", "OB") else struct.pack("<H", len(value))
    return struct.pack("<HH", group, number) + vr.encode() + length + value


def dicom_slice(k, uid="1.2.826.0.1.99.5", number="7", description="portal venous Roe", position=None):
    """One CT slice of SIZE in explicit little endian, at z = 2 k mm, full of a patient's data."""
    us = lambda value: struct.pack("<H", value)
    voxels = struct.pack("<20h", *(20 * k + n for n in range(20)))
    data = b"".join([
        element(8, 0x16, "UI", "1.2.840.10008.5.1.4.1.1.2"), element(8, 0x18, "UI", f"1.2.826.0.1.99.{k}"),
        element(8, 0x20, "DA", "19610203"), element(8, 0x60, "CS", "CT"), element(8, 0x80, "LO", "Saint Elsewhere"),
        element(8, 0x90, "PN", "Dr Who"), element(8, 0x103E, "LO", description), element(16, 0x10, "PN", "ROE^JANE"),
        element(16, 0x20, "LO", "PID-77123"), element(16, 0x30, "DA", "19610203"), element(0x20, 0xD, "UI", "1.2.826.0.1.99"),
        element(0x20, 0xE, "UI", uid), element(0x20, 0x11, "IS", number),
        element(0x20, 0x32, "DS", f"10\\20\\{2 * k if position is None else position}"),
        element(0x20, 0x37, "DS", "1\\0\\0\\0\\1\\0"), element(0x28, 2, "US", us(1)), element(0x28, 4, "CS", "MONOCHROME2"),
        element(0x28, 0x10, "US", us(SIZE[1])), element(0x28, 0x11, "US", us(SIZE[0])), element(0x28, 0x30, "DS", "0.5\\0.5"),
        element(0x28, 0x100, "US", us(16)), element(0x28, 0x101, "US", us(16)), element(0x28, 0x102, "US", us(15)),
        element(0x28, 0x103, "US", us(1)), element(0x28, 0x1052, "DS", "-1024"), element(0x28, 0x1053, "DS", "1"),
        element(0x7FE0, 0x10, "OW", voxels)])
    meta = element(2, 2, "UI", "1.2.840.10008.5.1.4.1.1.2") + element(2, 3, "UI", "1.2.3") + \
        element(2, 0x10, "UI", "1.2.840.10008.1.2.1")
    return b"\0" * 128 + b"DICM" + element(2, 0, "UL", struct.pack("<I", len(meta))) + meta + data


def nifti(voxels):
    """uint8 NIfTI with a patient in descrip, aux_file, intent_name and a comment extension."""
    header = bytearray(348)
    struct.pack_into("<i", header, 0, 348)
    struct.pack_into("<8h", header, 40, 3, *SIZE, 1, 1, 1, 1)
    struct.pack_into("<hh", header, 70, 2, 8)
    struct.pack_into("<8f", header, 76, 1, 1, 1, 1, 0, 0, 0, 0)
    struct.pack_into("<80s24s", header, 148, b"ROE^JANE PID-77123", b"jane_roe")
    struct.pack_into("<hh", header, 252, 0, 1)
    struct.pack_into("<12f", header, 280, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0)
    struct.pack_into("<16s4s", header, 328, b"19610203", b"n+1\0")
    comment = b"Saint Elsewhere Dr Who".ljust(40)
    struct.pack_into("<f", header, 108, 352 + 48)
    return bytes(header) + b"\1\0\0\0" + struct.pack("<ii", 48, 6) + comment + voxels


def nrrd(voxels, fields="", kind="unsigned char"):
    return (f"NRRD0004\n# ROE^JANE Saint Elsewhere\ntype: {kind}\ndimension: 3\nspace: left-posterior-superior\n"
            f"sizes: {SIZE[0]} {SIZE[1]} {SIZE[2]}\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nencoding: raw\n"
            f"space origin: (0,0,0)\ncontent: Dr Who\nPatientID:=PID-77123\nStudyDate:=19610203\n{fields}\n"
            ).encode() + voxels


def metaimage(voxels):
    return (f"Comment = ROE^JANE\nObjectType = Image\nNDims = 3\nName = PID-77123\nDimSize = {SIZE[0]} {SIZE[1]} {SIZE[2]}\n"
            "AcquisitionDate = 19610203\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n").encode() + voxels


def vti(voxels):
    return ("<!-- ROE^JANE PID-77123 19610203 --><VTKFile type=\"ImageData\"><ImageData WholeExtent=\"0 3 0 4 0 5\" "
            "Origin=\"0 0 0\" Spacing=\"1 1 1\"><Piece Extent=\"0 3 0 4 0 5\"><PointData><DataArray type=\"UInt8\" "
            "Name=\"Dr Who\" format=\"ascii\">" + " ".join(map(str, voxels)) +
            "</DataArray></PointData></Piece></ImageData></VTKFile>").encode()


class Import(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        self.labels = bytes(5 if 30 <= n < 60 else 1 if n < 7 else 0 for n in range(COUNT))

    def run_import(self, *arguments):
        return subprocess.run([BIN / "palpate-import", *map(str, arguments)], text=True, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, timeout=60)

    def on_a_terminal(self, *arguments):
        master, terminal = pty.openpty()
        with subprocess.Popen([BIN / "palpate-import", *map(str, arguments)], stdout=terminal, stderr=terminal):
            os.close(terminal)
            shown = b""
            try:
                while more := os.read(master, 4096):
                    shown += more
            except OSError:  # the other end is closed
                pass
        os.close(master)
        return shown.decode()

    def write(self, name, content):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
        return path

    def series(self, name, count, **fields):
        for k in range(count):
            self.write(f"{name}/{k}.dcm", dicom_slice(k, **fields))
        return self.folder / name

    def names(self, *arguments):
        result = self.run_import("--labels", *arguments, "-o", self.folder / "l.seg.nrrd", "--force", "--json", "-")
        self.assertEqual(result.returncode, OK, result.stderr)
        return [label["name"] for label in json.loads(result.stdout)["labels"]]

    def test_several_series_are_listed_and_chosen(self):
        self.series("in/a", 6)
        self.series("in/b", 4, uid="1.2.826.0.1.99.6", number="3", description="arterial")
        output = self.folder / "v.nrrd"
        refused = self.run_import(self.folder / "in", "-o", output)
        self.assertEqual(refused.returncode, INVALID)
        for phrase in ("holds 2 series", "7: CT 6 slices of 5 x 4, 0.5 x 0.5 x 2 mm", "palpate import ... --series 3"):
            self.assertIn(phrase, refused.stderr)
        self.assertNotIn("arterial", refused.stderr)
        self.assertFalse(output.exists())

        listed = self.run_import(self.folder / "in", "--list", "--json", "-")
        rows = json.loads(listed.stdout)["series"]
        self.assertEqual([(row["number"], row["slices"]) for row in rows], [("3", 4), ("7", 6)])
        self.assertEqual([rows[0][f"spacing_{axis}_mm"] for axis in "ijk"], [0.5, 0.5, 2])
        for arguments in (["--list"], ["--list", "--json", "-"]):
            self.assertNotIn("arterial", self.run_import(self.folder / "in", *arguments).stdout)
        self.assertIn("arterial", self.on_a_terminal(self.folder / "in", "--list"))
        self.assertIn("arterial", self.on_a_terminal(self.folder / "in", "-o", output))
        self.assertNotIn("arterial", self.on_a_terminal(self.folder / "in", "--list", "--json", "-"))
        for wanted in ("3", "arterial", "1.2.826.0.1.99.6"):
            result = self.run_import(self.folder / "in", "--series", wanted, "-o", output, "--force", "--json", "-")
            self.assertEqual(json.loads(result.stdout)["grid"]["size"], [4, 5, 4])

    def test_a_list_written_to_a_file_holds_no_free_text(self):
        self.series("in", 6)
        file = self.folder / "list.json"
        self.assertEqual(self.run_import(self.folder / "in", "--list", "--json", file).returncode, OK)
        self.assertEqual(json.loads(file.read_text())["series"][0]["slices"], 6)
        for text in IDENTITY:
            self.assertNotIn(text, file.read_text())

    def test_gaps_are_refused_with_their_place_and_accepted_on_request(self):
        folder = self.series("in", 6)
        (folder / "3.dcm").unlink()
        output = self.folder / "v.nrrd"
        refused = self.run_import(folder, "-o", output)
        self.assertEqual(refused.returncode, INVALID)
        self.assertIn("between the slices at 4.00 and 8.00 mm along the normal, 2.dcm and 4.dcm", refused.stderr)
        result = self.run_import(folder, "--accept-gaps", "-o", output, "--json", "-")
        answer = json.loads(result.stdout)
        self.assertEqual(answer["grid"]["size"], [4, 5, 6])
        self.assertIn("5 slices interpolated onto 6", answer["notes"][0])

    def test_wrong_combinations_are_usage_errors(self):
        image = self.write("l.nii", nifti(self.labels))
        for arguments in ([image], [image, "--list", "-o", "v.nrrd"], [image, "-o", "v.nrrd", "--label-names", "1=a"],
                          [image, "-o", "v.nrrd", "--labels", "--overlaps", "both"],
                          [image, "-o", "v.nrrd", "--overlaps", "later"], [image, "-o", "v.nrrd", "--series", "3"],
                          [image, "-o", "v.nrrd", "--accept-gaps"],
                          [self.write("v.nrrd", nrrd(self.labels)), "-o", "w.nrrd", "--nifti-frame", "qform"]):
            self.assertEqual(self.run_import(*arguments).returncode, USAGE, arguments)

    def test_labels_are_named_by_file_table_or_value(self):
        bare = self.write("l.nii", nifti(self.labels))
        self.assertEqual(self.names(bare), ["label_1", "label_5"])
        self.assertEqual(self.names(bare, "--label-names", "totalsegmentator:v2/total"), ["spleen", "liver"])
        self.assertEqual(self.names(bare, "--label-names", "5=liver"), ["liver"])
        table = self.write("t.ctbl", b"1 spleen 0 0 255 255\n5 liver 255 0 0 255\n")
        self.assertEqual(self.names(bare, "--label-names", table), ["spleen", "liver"])
        fields = "Segment0_Name:=Liver\nSegment0_LabelValue:=5\nSegment1_Name:=milt\nSegment1_LabelValue:=1\n"
        self.assertEqual(self.names(self.write("l.seg.nrrd", nrrd(self.labels, fields))), ["milt", "Liver"])
        unnamed = self.run_import("--labels", bare, "-o", self.folder / "u.seg.nrrd")
        self.assertIn("does not name 2 of its 2 labels", unnamed.stderr)
        wrong = self.run_import("--labels", bare, "--label-names", "totalsegmentator:v2/totl", "-o", self.folder / "w.seg.nrrd")
        self.assertEqual(wrong.returncode, INVALID)
        self.assertIn("v2/total", wrong.stderr)

    def outputs_of(self, path, as_labels):
        output, answer = self.folder / ("out.seg.nrrd" if as_labels else "out.nrrd"), self.folder / "out.json"
        arguments = ["--labels"] if as_labels else []
        result = self.run_import(path, *arguments, "-o", output, "--json", answer, "--force")
        self.assertEqual(result.returncode, OK, result.stderr)
        header, _, packed = output.read_bytes().partition(b"\n\n")
        return header + gzip.decompress(packed) + answer.read_bytes() + result.stdout.encode() + result.stderr.encode()

    def test_nothing_of_the_patient_reaches_an_output(self):
        inputs = {
            "dicom": self.series("jane_roe/dicom", 6),
            "nifti": self.write("jane_roe/v.nii", nifti(self.labels)),
            "nrrd": self.write("jane_roe/v.nrrd", nrrd(self.labels)),
            "metaimage": self.write("jane_roe/v.mha", metaimage(self.labels)),
            "vti": self.write("jane_roe/v.vti", vti(self.labels)),
        }
        planted = b"".join(path.read_bytes() for path in (self.folder / "jane_roe").rglob("*.*")).decode("latin1")
        for text in set(IDENTITY) - {"jane_roe"}:
            self.assertIn(text, planted, "not planted")
        for kind, path in inputs.items():
            for as_labels in (False, True) if kind != "dicom" else (False,):
                with self.subTest(kind=kind, as_labels=as_labels):
                    outputs = self.outputs_of(path, as_labels).decode("latin1")
                    for text in IDENTITY:
                        self.assertNotIn(text, outputs)


if __name__ == "__main__":
    unittest.main()
