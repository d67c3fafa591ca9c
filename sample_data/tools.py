#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes tools to hold, as closed surfaces in binary STL (mm): the origin is the centre of the tip, +z goes up the shaft.

    sample_data/tools.py [FOLDER]         (default: build/sample_data)

probe.stl      a ball of 3 mm radius, its centre the origin, on a shaft of 4 mm diameter that ends at z = 120
endoscope.stl  a rod of 4 mm diameter whose flat tip is bevelled by 30 degrees, looking to -z and +x; to z = 150
forceps.stl    closed: two jaws of 30 mm with a groove between them, one body, on a shaft of 5 mm diameter; to z = 150
drill.stl      a ball burr of 4 mm diameter with eight twisted flutes, on a shaft of 2.4 mm diameter; to z = 70
peg.stl        a square peg of 10 x 10 x 40; the origin is the centre of its lower face

Files appear whole or not at all, with the same bytes on every machine.
"""
import argparse
import math
import pathlib
import struct
import sys

sys.dont_write_bytecode = True
from unpack import HERE, write_whole  # noqa: E402

SIDES = 48  # of what is round
DIGITS = 4  # of a coordinate: far fewer than a machine's sine may differ in


def circle(radius, z):
    """A ring of SIDES points, counter-clockwise seen from +z; radius and z are numbers or functions of the angle."""
    value = lambda of, angle: of(angle) if callable(of) else of  # noqa: E731
    angles = [2 * math.pi * n / SIDES for n in range(SIDES)]
    return [(value(radius, a) * math.cos(a), value(radius, a) * math.sin(a), value(z, a)) for a in angles]


def lathe(tip, rings, end):
    """Triangles of the surface from point `tip` over the rings, of equally many points each, up to point `end`."""
    def around(ring):
        return zip(ring, ring[1:] + ring[:1])
    triangles = [(tip, b, a) for a, b in around(rings[0])]
    for lower, upper in zip(rings, rings[1:]):
        for (a, b), (c, d) in zip(around(lower), around(upper)):
            triangles += [(a, b, d), (a, d, c)]
    return triangles + [(end, a, b) for a, b in around(rings[-1])]


def ball(radius, first, last, steps):
    """(radius, z) of rings of a ball about the origin; angles in degrees from -z, the ends included."""
    angles = [math.radians(first + (last - first) * n / steps) for n in range(steps + 1)]
    return [(radius * math.sin(a), -radius * math.cos(a)) for a in angles]


def shaft(radius, first, last, step=5.0):
    """(radius, z) of rings of a shaft, the ends included."""
    steps = math.ceil((last - first) / step)
    return [(radius, first + (last - first) * n / steps) for n in range(steps + 1)]


def probe():
    neck = math.degrees(math.asin(2 / 3))
    profile = ball(3, 7.5, 180 - neck, 18) + shaft(2, math.sqrt(5), 120)[1:]
    return lathe((0, 0, -3), [circle(r, z) for r, z in profile], (0, 0, 120))


def endoscope():
    slope, length = math.tan(math.radians(30)), 150
    rings = [circle(r, lambda a, r=r: r * slope * math.cos(a)) for r in (0.5, 1, 1.5, 2)]
    # Along the shaft the bevel fades.
    rings += [circle(2, lambda a, z=z: z + 2 * slope * math.cos(a) * max(0, 1 - z / 5)) for _, z in shaft(2, 0, length)[1:]]
    return lathe((0, 0, 0), rings, (0, 0, length))


def forceps():
    jaws, length, rounding = 30, 150, 1.0

    def section(width, height, z):
        groove = 0.35 * max(0, min(1, (jaws - z) / 5))  # between the jaws, at y = 0, up to the hinge
        def radius(angle):
            ellipse = 1 / math.hypot(math.cos(angle) / width, math.sin(angle) / height)
            return ellipse * (1 - groove * math.exp(-(math.sin(angle) / 0.2) ** 2))
        return circle(radius, z)
    rings = [section(1.2 * r, r, z) for r, z in ball(rounding, 15, 90, 5)]
    for step in range(1, 21):
        share = step / 20
        rings.append(section(1.2 + 1.3 * share, 1 + 1.5 * share, jaws * share))
    rings += [circle(r, z) for r, z in shaft(2.5, jaws, length)[1:]]
    return lathe((0, 0, -rounding), rings, (0, 0, length))


def drill():
    flutes, depth, twist = 8, 0.08, 0.4  # depth relative to the radius; radians of twist for each mm of height
    neck = math.degrees(math.asin(1.2 / 2))
    rings = []
    for r, z in ball(2, 9, 180 - neck, 15):
        fluted = lambda a, r=r, z=z: r * (1 - depth * r / 2 * (1 + math.cos(flutes * (a - twist * z))))  # noqa: E731
        rings.append(circle(fluted, z))
    rings += [circle(r, z) for r, z in shaft(1.2, 1.6, 70)[1:]]
    return lathe((0, 0, -2), rings, (0, 0, 70))


def peg():
    rings = [[(-5, -5, z), (5, -5, z), (5, 5, z), (-5, 5, z)] for z in (0, 40)]
    return lathe((0, 0, 0), rings, (0, 0, 40))


TOOLS = {"probe": probe, "endoscope": endoscope, "forceps": forceps, "drill": drill, "peg": peg}


def normal(a, b, c):
    u, v = [q - p for p, q in zip(a, b)], [q - p for p, q in zip(a, c)]
    cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
    length = math.sqrt(sum(x * x for x in cross))
    return [x / length for x in cross]


def stl(name, triangles):
    """The bytes of binary STL."""
    data = f"Palpate {name}, mm".encode().ljust(80) + struct.pack("<I", len(triangles))
    for corners in triangles:
        corners = [[round(x, DIGITS) + 0.0 for x in corner] for corner in corners]
        data += struct.pack("<12fH", *normal(*corners), *corners[0], *corners[1], *corners[2], 0)
    return data


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", nargs="?", type=pathlib.Path, default=HERE.parent / "build/sample_data")
    folder = parser.parse_args().folder
    folder.mkdir(parents=True, exist_ok=True)
    for name, make in TOOLS.items():
        write_whole(folder / f"{name}.stl", stl(name, make()))
        print(folder / f"{name}.stl")


if __name__ == "__main__":
    try:
        main()
    except OSError as error:
        sys.exit(f"tools.py: {error}")
