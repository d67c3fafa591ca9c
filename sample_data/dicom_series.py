#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes a volume as a CT series of a made-up patient, as a hospital's archive would hand it out.

    sample_data/dicom_series.py VOLUME.nrrd FOLDER

VOLUME is NRRD in LPS with HU, raw or gzip, as sample_data's phantoms and `palpate import` write it. FOLDER gets one file a slice, in
explicit little endian, with a name, a birth date and a hospital in it that nobody has. Equal input gives equal bytes.
"""
import gzip
import hashlib
import pathlib
import re
import struct
import sys

TYPES = {"float": "f", "double": "d", "short": "h", "int16": "h", "signed short": "h", "unsigned char": "B", "int": "i"}


def read_nrrd(path):
    """Size, directions times spacing, origin (mm, LPS), and values, columns first."""
    header, _, data = path.read_bytes().partition(b"\n\n")
    fields = dict(line.split(": ", 1) for line in header.decode().splitlines() if ": " in line)
    if fields.get("space") != "left-posterior-superior":
        sys.exit(f"dicom_series.py: {path}: space is {fields.get('space')}, expected left-posterior-superior")
    triples = [[float(x) for x in found.split(",")] for found in re.findall(r"\(([^)]*)\)", fields["space directions"] + fields["space origin"])]
    data = gzip.decompress(data) if fields["encoding"] in ("gzip", "gz") else data
    values = struct.unpack(f"<{len(data) // struct.calcsize(TYPES[fields['type']])}{TYPES[fields['type']]}", data)
    return list(map(int, fields["sizes"].split())), triples[:3], triples[3], values


def element(group, number, kind, value):
    value = value if isinstance(value, bytes) else value.encode()
    value += (b"\0" if kind == "UI" else b" ") * (len(value) % 2)
    length = b"\0\0" + struct.pack("<I", len(value)) if kind in ("OW", "OB") else struct.pack("<H", len(value))
    return struct.pack("<HH", group, number) + kind.encode() + length + value


def numbers(values):
    return "\\".join(f"{value:.6f}".rstrip("0").rstrip(".") for value in values)


def slice_of(k, size, axes, origin, values, uid):
    short = lambda value: struct.pack("<H", value)
    length = [sum(x * x for x in axis) ** 0.5 for axis in axes]
    along = [[x / length[a] for x in axes[a]] for a in (0, 1)]
    place = [origin[c] + k * axes[2][c] for c in range(3)]
    voxels = struct.pack(f"<{len(values)}h", *(max(-1024, round(value)) for value in values))
    data = b"".join([
        element(8, 0x16, "UI", "1.2.840.10008.5.1.4.1.1.2"), element(8, 0x18, "UI", f"{uid}.{k + 1}"), element(8, 0x20, "DA", "20240131"),
        element(8, 0x30, "TM", "101500"), element(8, 0x50, "SH", "A-1"), element(8, 0x60, "CS", "CT"), element(8, 0x80, "LO", "No Hospital"),
        element(8, 0x90, "PN", "Nobody^Doctor"), element(8, 0x103E, "LO", "portal venous"), element(0x10, 0x10, "PN", "Phantom^Paula"),
        element(0x10, 0x20, "LO", "PHANTOM-1"), element(0x10, 0x30, "DA", "19600101"), element(0x10, 0x40, "CS", "F"),
        element(0x18, 0x50, "DS", numbers(length[2:])), element(0x20, 0x0D, "UI", f"{uid}.0"), element(0x20, 0x0E, "UI", f"{uid}.9001"),
        element(0x20, 0x10, "SH", "1"), element(0x20, 0x11, "IS", "3"), element(0x20, 0x13, "IS", str(k + 1)),
        element(0x20, 0x32, "DS", numbers(place)), element(0x20, 0x37, "DS", numbers(along[0] + along[1])),
        element(0x20, 0x52, "UI", f"{uid}.9002"), element(0x28, 2, "US", short(1)), element(0x28, 4, "CS", "MONOCHROME2"),
        element(0x28, 0x10, "US", short(size[1])), element(0x28, 0x11, "US", short(size[0])),
        element(0x28, 0x30, "DS", numbers([length[1], length[0]])), element(0x28, 0x100, "US", short(16)),
        element(0x28, 0x101, "US", short(16)), element(0x28, 0x102, "US", short(15)), element(0x28, 0x103, "US", short(1)),
        element(0x28, 0x1052, "DS", "0"), element(0x28, 0x1053, "DS", "1"), element(0x7FE0, 0x10, "OW", voxels)])
    meta = element(2, 1, "OB", b"\0\1") + element(2, 2, "UI", "1.2.840.10008.5.1.4.1.1.2") + element(2, 3, "UI", f"{uid}.{k + 1}") + \
        element(2, 0x10, "UI", "1.2.840.10008.1.2.1") + element(2, 0x12, "UI", "1.2.826.0.1.3680043.2.1143")
    return b"\0" * 128 + b"DICM" + element(2, 0, "UL", struct.pack("<I", len(meta))) + meta + data


def main(volume, folder):
    size, axes, origin, values = read_nrrd(pathlib.Path(volume))
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True)
    uid = f"2.25.{int(hashlib.sha256(pathlib.Path(volume).read_bytes()).hexdigest()[:24], 16)}"
    area = size[0] * size[1]
    for k in range(size[2]):
        (folder / f"{k + 1:04}.dcm").write_bytes(slice_of(k, size, axes, origin, values[k * area:(k + 1) * area], uid))
    print(f"{folder}: {size[2]} slices of {size[0]} x {size[1]}")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
