# SPDX-License-Identifier: GPL-3.0-or-later
"""A second reader and writer of NIfTI, and a reader of NRRD as Palpate writes it. RAS is LPS with x and y turned round."""
import gzip
import re
import struct

HEADER_BYTES = 352
BITS = {2: 8, 4: 16, 16: 32, 512: 16}  # of a voxel, by NIfTI's number of its type
TYPES = {"unsigned char": 2, "uint8": 2, "short": 4, "int16": 4, "float": 16, "unsigned short": 512, "uint16": 512}


def read_nrrd(path):
    """Size, voxel-to-LPS matrix (3 rows of 4) and raw bytes of a packed NRRD; its type in NIfTI's numbers."""
    head, _, data = path.read_bytes().partition(b"\n\n")
    fields = dict(line.split(": ", 1) for line in head.decode().splitlines() if ": " in line)
    size = [int(n) for n in fields["sizes"].split()]
    axes = [[float(x) for x in axis.split(",")] for axis in re.findall(r"\(([^)]*)\)", fields["space directions"])]
    origin = [float(x) for x in fields["space origin"].strip("()").split(",")]
    return size, [[axes[0][r], axes[1][r], axes[2][r], origin[r]] for r in range(3)], gzip.decompress(data), TYPES[fields["type"]]


def write_nifti(target, size, lps, voxels, kind, names=None):
    """Writes what read_nrrd() gives; names of labels, {value: name}, go into a header extension as TotalSegmentator writes it."""
    ras = [[-x for x in lps[0]], [-x for x in lps[1]], lps[2]]
    extension = b""
    if names:
        table = "".join(f'<Label Key="{value}">{name}</Label>' for value, name in names.items()).encode()
        table += bytes(-(8 + len(table)) % 16)
        extension = struct.pack("<2i", 8 + len(table), 0) + table
    header = bytearray(HEADER_BYTES)
    struct.pack_into("<i", header, 0, 348)
    struct.pack_into("<8h", header, 40, 3, *size, 1, 1, 1, 1)
    struct.pack_into("<2h", header, 70, kind, BITS[kind])
    struct.pack_into("<8f", header, 76, 1, *(sum(lps[r][a] ** 2 for r in range(3)) ** 0.5 for a in range(3)), 0, 0, 0, 0)
    struct.pack_into("<3f", header, 108, HEADER_BYTES + len(extension), 1, 0)
    header[123] = 2
    struct.pack_into("<2h", header, 252, 0, 1)
    struct.pack_into("<12f", header, 280, *(x for row in ras for x in row))
    header[344:348] = b"n+1\0"
    header[348] = 1 if names else 0
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_bytes(gzip.compress(bytes(header) + extension + voxels, mtime=0))


def nrrd_as_nifti(source, target):
    write_nifti(target, *read_nrrd(source))


def read_nifti(path):
    """Size, sform as LPS, raw bytes."""
    data = gzip.decompress(path.read_bytes())
    rows = struct.unpack_from("<12f", data, 280)
    ras = [rows[4 * r:4 * r + 4] for r in range(3)]
    return list(struct.unpack_from("<3h", data, 42)), [[-x for x in ras[0]], [-x for x in ras[1]], list(ras[2])], data[HEADER_BYTES:]
