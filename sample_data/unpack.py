#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Unpacks two real volumes from Debian packages into NRRD with LPS geometry.

    sample_data/unpack.py [FOLDER]        (default: build/sample_data)

head_ct.nrrd    head CT of package invesalius-examples, int16 HU, vertex to upper jaw.
                Rows grow to anterior and slices to superior, as the nose and the vertex show. Nothing in the
                file tells left from right: columns are assumed to grow to the patient's left, as in radiology.
liver.seg.nrrd  labels liver, kidney and gallbladder of package libcgal-demo. Columns grow to the patient's
                left, rows to posterior, slices to superior: kidney and gallbladder lie below the dome of the
                liver, the kidney behind it, and the lobe that tapers off is the left one.

Packages are taken from sample_data/cache if they lie there, else downloaded by 'apt-get download', which needs
neither root nor an installation. Outputs appear whole or not at all; whole ones are left alone.
"""
import argparse
import gzip
import math
import os
import pathlib
import plistlib
import re
import subprocess
import sys
import tarfile
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
BYTES_PER_VOXEL = {"short": 2, "unsigned char": 1}
LIVER_LABELS = {255: ("liver", "0.62 0.27 0.22"), 127: ("kidney", "0.73 0.4 0.33"),
                85: ("gallbladder", "0.55 0.63 0.25")}


class UnpackError(Exception):
    pass


def fetch(package, folder):
    """Path of the package's .deb: from the cache, or downloaded into the folder."""
    if cached := sorted((HERE / "cache").glob(f"{package}_*.deb")):
        return cached[-1]
    result = subprocess.run(["apt-get", "download", "-q", package], cwd=folder, text=True,
                            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    downloaded = sorted(folder.glob(f"{package}_*.deb"))
    if result.returncode != 0 or not downloaded:
        raise UnpackError(f"apt-get download {package} failed: {result.stderr.strip()}; "
                          "run 'apt-get update' and check the network")
    return downloaded[-1]


def unpacked(package, folder):
    """Folder with the package's files."""
    target = folder / package
    subprocess.run(["dpkg-deb", "-x", fetch(package, folder), target], check=True)
    return target


def nrrd(kind, size, axes_mm, fields, voxels):
    """An NRRD file's bytes: gzip, LPS, origin 0; the axes are direction times spacing."""
    if len(voxels) != math.prod(size) * BYTES_PER_VOXEL[kind]:
        raise UnpackError(f"found {len(voxels)} bytes of voxels (expected {size} of {kind})")
    axes = " ".join("(" + ",".join(repr(float(x)) for x in axis) + ")" for axis in axes_mm)
    header = ["NRRD0004", f"type: {kind}", "dimension: 3", "space: left-posterior-superior",
              "sizes: " + " ".join(map(str, size)), "space directions: " + axes, "kinds: domain domain domain",
              "endian: little", "encoding: gzip", "space origin: (0,0,0)"]
    header += [f"{key}:={value}" for key, value in fields.items()]
    return "\n".join(header).encode() + b"\n\n" + gzip.compress(voxels, 6, mtime=0)


def head_ct(folder):
    archive = unpacked("invesalius-examples", folder) / "usr/share/doc/invesalius-examples/examples/Cranium.inv3"
    with tarfile.open(archive) as tar:
        members = {pathlib.PurePath(member.name).name: member for member in tar.getmembers()}
        about = plistlib.load(tar.extractfile(members["main.plist"]))
        voxels = tar.extractfile(members["matrix.dat"]).read()
    if about["matrix"]["dtype"] != "int16":
        raise UnpackError(f"Cranium.inv3 holds {about['matrix']['dtype']} (expected int16)")
    x, y, z = about["spacing"]
    return nrrd("short", about["matrix"]["shape"][::-1], [(x, 0, 0), (0, -y, 0), (0, 0, z)], {}, voxels)


def liver(folder):
    package = unpacked("libcgal-demo", folder)
    with tarfile.open(package / "usr/share/doc/libcgal-dev/data.tar.gz") as tar:
        data = gzip.decompress(tar.extractfile("data/images/liver.inr.gz").read())
    header_bytes = 256
    header = dict(re.findall(r"^(\w+)=(.*)$", data[:header_bytes].decode("ascii"), re.M))
    if header.get("TYPE") != "unsigned fixed" or header.get("PIXSIZE") != "8 bits":
        raise UnpackError("liver.inr.gz does not hold bytes")
    size = [int(header[key]) for key in ("XDIM", "YDIM", "ZDIM")]
    x, y, z = (float(header[key]) for key in ("VX", "VY", "VZ"))
    # Two stray voxels of value 84 belong to no structure.
    kept = bytes(value if value in LIVER_LABELS else 0 for value in range(256))
    fields = {"Segmentation_MasterRepresentation": "Binary labelmap",
              "Segmentation_ContainedRepresentationNames": "Binary labelmap|",
              "Segmentation_ReferenceImageExtentOffset": "0 0 0"}
    for n, (value, (name, colour)) in enumerate(sorted(LIVER_LABELS.items())):
        fields |= {f"Segment{n}_ID": f"Segment_{value}", f"Segment{n}_Name": name,
                   f"Segment{n}_LabelValue": value, f"Segment{n}_Layer": 0, f"Segment{n}_Color": colour,
                   f"Segment{n}_Extent": " ".join(f"0 {extent - 1}" for extent in size)}
    return nrrd("unsigned char", size, [(x, 0, 0), (0, y, 0), (0, 0, z)], fields,
                data[header_bytes:].translate(kept))


def is_whole(path):
    """Whether the gzip stream of one of our files ends in the size that its header promises (RFC 1952)."""
    if not path.is_file():
        return False
    data = path.read_bytes()
    header = data.partition(b"\n\n")[0].decode("latin1")
    size = re.search(r"^sizes: (.*)$", header, re.M)
    kind = re.search(r"^type: (.*)$", header, re.M)
    if not size or not kind:
        return False
    voxels = math.prod(map(int, size[1].split())) * BYTES_PER_VOXEL.get(kind[1], 0)
    return int.from_bytes(data[-4:], "little") == voxels


def write_whole(path, data):
    part = path.with_name(f".part{os.getpid()}-{path.name}")
    try:
        with part.open("wb") as stream:
            stream.write(data)
            stream.flush()
            os.fsync(stream.fileno())
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", nargs="?", type=pathlib.Path, default=HERE.parent / "build/sample_data")
    folder = parser.parse_args().folder
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="palpate-sample-data-") as scratch:
        for name, make in (("head_ct.nrrd", head_ct), ("liver.seg.nrrd", liver)):
            if not is_whole(folder / name):
                write_whole(folder / name, make(pathlib.Path(scratch)))
            print(folder / name)


if __name__ == "__main__":
    try:
        main()
    except (UnpackError, OSError, KeyError, tarfile.TarError, subprocess.CalledProcessError) as error:
        sys.exit(f"unpack.py: {error}")
