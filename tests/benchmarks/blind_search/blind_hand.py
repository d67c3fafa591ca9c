# SPDX-License-Identifier: GPL-3.0-or-later
"""A hand that searches an organ for what it hides and knows forces alone.

It sees what a trainee sees, the organ's outer surface from the front, and presses places of a regular grid with 'palpate touch', by one
finger and by two. It reads the surface's shape from the asset and nothing else there: neither regions nor materials nor what can be felt.
"""
import subprocess
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np

EYE = np.array([0.0, -1.0, 0.0])  # the patient's front, LPS
FACING = 0.5  # least cosine between a normal and EYE: what a tool from the front reaches


@dataclass
class Surface:
    """What is seen of an organ: vertices (n, 3) in mm and triangles (t, 3), counter-clockwise from outside."""

    vertices: np.ndarray
    triangles: np.ndarray

    @classmethod
    def seen(cls, asset, body="liver"):
        with h5py.File(asset) as file:
            bodies = file["palpate/bodies/deformable"]
            (one,) = [bodies[key] for key in bodies if bodies[key].attrs["name"].decode().rstrip("\0") == body]
            return cls(one["rest_positions"][:][one["surface_nodes"][:]], one["surface_triangles"][:])

    def corners(self):
        return (self.vertices[self.triangles[:, c]] for c in range(3))

    def normals(self):
        """Of the triangles, as long as twice their areas."""
        a, b, c = self.corners()
        return np.cross(b - a, c - a)

    def under(self, x, z):
        """The foremost point over (x, z), or None."""
        a, b, c = (corner[:, [0, 2]] for corner in self.corners())
        p = np.array([x, z])
        double = np.cross(b - a, c - a)
        with np.errstate(divide="ignore", invalid="ignore"):
            weights = np.stack([np.cross(c - b, p - b), np.cross(a - c, p - c), np.cross(b - a, p - a)], 1) / double[:, None]
        hit = np.flatnonzero((weights >= 0).all(1))
        if not len(hit):
            return None
        points = sum(weights[hit, k, None] * self.vertices[self.triangles[hit, k]] for k in range(3))
        return points[np.argmin(points[:, 1])]

    def normal_near(self, point, within=8.0):
        """Unit, of the surface within so many mm, so that a facet's edge does not turn the press."""
        centres = self.vertices[self.triangles].mean(1)
        near = np.linalg.norm(centres - point, axis=1) < within
        near &= self.normals() @ EYE > 0
        if not near.any():
            return None
        normal = self.normals()[near].sum(0)
        return normal / np.linalg.norm(normal)

    def places(self, xs, zs):
        """Points and normals where a tool from the front reaches the surface over the grid."""
        found = []
        for i, x in enumerate(xs):
            for z in zs[:: 1 if i % 2 else -1]:  # to and fro
                point = self.under(x, z)
                normal = None if point is None else self.normal_near(point)
                if normal is not None and normal @ EYE >= FACING:
                    found.append((point, normal))
        return np.array([p for p, _ in found]), np.array([n for _, n in found])


@dataclass
class Hand:
    """Presses of `depth` mm with one or two tools of `radius` mm; scratch files go to `folder`."""

    touch: Path
    asset: Path
    folder: Path
    radius: float = 5.0
    depth: float = 5.0

    OUTSIDE, AWAY, IN, HOLD, OUT = 8.0, 0.03, 0.15, 0.02, 0.1  # mm; s between places, in, at full depth, out

    def script(self, name, points, normals):
        """A file that presses place after place, and the last tick at full depth of each."""
        rows, deepest, t = [], [], 0.0
        for p, n in zip(points, normals):
            outside, inside = p + n * (self.radius + self.OUTSIDE), p + n * (self.radius - self.depth)
            for seconds, where in ((self.AWAY, outside), (self.IN, inside), (self.HOLD, inside), (self.OUT, outside)):
                t += seconds
                rows.append((t, *where))
            deepest.append(int(round(1000 * (t - self.OUT))) - 1)
        path = self.folder / name
        np.savetxt(path, np.vstack([(0.0, *rows[0][1:]), rows]), fmt="%.5f")
        return path, np.array(deepest), t

    def press(self, *fingers):
        """For each finger's (points, normals), all pressed at once: force (N) along the normal and how far the tool sank in (mm)."""
        scripts = [self.script(f"hand{i}.txt", *finger) for i, finger in enumerate(fingers)]
        deepest, seconds = scripts[0][1:]
        recording = self.folder / "hand.h5"
        command = [self.touch, self.asset, "--script", scripts[0][0], "--virtual-clock", "--record", recording, "--record-seconds",
                   f"{seconds + 1:.0f}", "--quiet", "--json", self.folder / "touch.json", "--force"]
        if len(fingers) > 1:
            command += ["--second", scripts[1][0]]
        subprocess.run(command, check=True, capture_output=True, text=True)
        with h5py.File(recording) as run:
            rows = [deepest * len(fingers) + tool for tool in range(len(fingers))]
            force, at = run["ticks/force"][:], run["ticks/tool_position"][:]
            tools = run["ticks/tool"][:]
        recording.unlink()
        assert all((tools[row] == tool).all() for tool, row in enumerate(rows))
        return [((force[row] * normals).sum(1), self.radius - ((at[row] - points) * normals).sum(1))
                for row, (points, normals) in zip(rows, fingers)]


STEP = 8.0  # mm, of the grid
APART = 2  # steps between two fingers
CORE, GAP, RIM = 14.0, 22.0, 60.0  # mm: pairs up to CORE away speak for a place, those from GAP to RIM for what is around it
LEAST_PAIRS = 12  # within CORE, or the place is at the organ's edge
# ln: a contrast beyond it is a tumour. Healthy organs that are not judged had 0.13 at most, those with a tumour 0.15 at least:
# blind_search.py --calibrate.
THRESHOLD = 0.14


@dataclass
class Answer:
    place: np.ndarray  # mm, what the hand suspects most
    contrast: float  # ln
    presses: int

    @property
    def found(self):
        return self.contrast > THRESHOLD


def neighbours(points):
    """Pairs of places that are APART steps from one another along the grid."""
    index = {tuple(np.floor(p[[0, 2]] / STEP).astype(int)): i for i, p in enumerate(points)}
    return np.array([(i, index[x + dx, z + dz]) for (x, z), i in index.items() for dx, dz in ((APART, 0), (0, APART)) if (x + dx, z + dz) in index])


def search(hand, surface):
    """Presses with one finger, then with two at once, and asks where tissue gives way least between two fingers.

    One place gives way by c_aa f, two by c_aa f_a + c_ab f_b: what an organ does as a whole, bending where it is thin or far from what
    holds it, is in both c_aa and c_ab, so that c_aa + c_bb - 2 c_ab is left with what the tissue near the two places does."""
    low, high = surface.vertices.min(0), surface.vertices.max(0)
    points, normals = surface.places(*(np.arange(np.ceil(low[k] / STEP), np.floor(high[k] / STEP)) * STEP + STEP / 2 for k in (0, 2)))
    ((force, sunk),) = hand.press((points, normals))
    alone = sunk / force
    a, b = neighbours(points).T
    (force_a, sunk_a), (force_b, sunk_b) = hand.press((points[a], normals[a]), (points[b], normals[b]))
    between = ((sunk_a - alone[a] * force_a) / force_b + (sunk_b - alone[b] * force_b) / force_a) / 2
    softness = np.log(alone[a] + alone[b] - 2 * between)
    middles = (points[a] + points[b]) / 2
    contrast = np.full(len(points), -np.inf)
    for i, point in enumerate(points):
        away = np.linalg.norm(middles - point, axis=1)
        near, around = away < CORE, (away > GAP) & (away < RIM)
        if near.sum() >= LEAST_PAIRS:  # beside its surroundings and the whole organ, half and half
            contrast[i] = (np.median(softness) + np.median(softness[around])) / 2 - softness[near].mean()
    best = np.argmax(contrast)
    near = (np.linalg.norm(points - points[best], axis=1) < 1.5 * CORE) & (contrast > 0.5 * contrast[best])
    place = (contrast[near, None] * points[near]).sum(0) / contrast[near].sum()
    return Answer(place, contrast[best], len(points) + len(a))
