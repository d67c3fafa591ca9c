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
APART = ((2, 0), (0, 2), (2, 2), (2, -2))  # steps from one finger to the other
# How far from its middle a stiff place is felt, as a Gaussian's standard deviation, and what it is held against, mm: by two fingers, by one.
WIDTH, AROUND = 15.0, 60.0
WIDTH_ALONE, AROUND_ALONE = 12.0, 55.0
LEAST_PAIRS, LEAST_PLACES = 30, 25  # around it, or the place is at the organ's end
# Of a place's evidence: beyond it is a tumour. Of 20 healthy organs that are not judged (blind_search.py --seed 1, --seed 17) the
# most had 5.4; of 20 with a tumour 18 had 6.1 or more, and these were found.
THRESHOLD = 5.75
LEAST_CONTRAST = 0.1  # ln: less is felt as none, however sure it is; of those tumours the least had 0.18


@dataclass
class Answer:
    place: np.ndarray  # mm, what the hand suspects most
    evidence: float  # how many standard errors its stiffness is from none, by one finger and by two: their geometric mean
    contrast: float  # ln, of the stiffness there to that around it
    presses: int

    @property
    def found(self):
        return self.evidence > THRESHOLD and self.contrast > LEAST_CONTRAST


def neighbours(points):
    """Pairs of places that are APART from one another on the grid."""
    index = {tuple(np.floor(p[[0, 2]] / STEP).astype(int)): i for i, p in enumerate(points)}
    return np.array([(i, index[x + dx, z + dz]) for (x, z), i in index.items() for dx, dz in APART if (x + dx, z + dz) in index])


def feel(hand, points, normals):
    """Presses with one finger, then with two at once: how far each place gives way (mm/N), pairs of places, and how far tissue does
    between them (mm/N).

    One place gives way by c_aa f, two by c_aa f_a + c_ab f_b: what an organ does as a whole, bending where it is thin or far from what
    holds it, is in both c_aa and c_ab, so that c_aa + c_bb - 2 c_ab is left with what the tissue near the two places does."""
    ((force, sunk),) = hand.press((points, normals))
    alone = sunk / force
    pairs = neighbours(points)
    a, b = pairs.T
    (force_a, sunk_a), (force_b, sunk_b) = hand.press((points[a], normals[a]), (points[b], normals[b]))
    between = ((sunk_a - alone[a] * force_a) / force_b + (sunk_b - alone[b] * force_b) / force_a) / 2
    return alone, pairs, alone[a] + alone[b] - 2 * between


def last_coefficient(columns, right, weight):
    """By weighted least squares, and its standard error."""
    columns, right = columns * weight[:, None], right * weight
    inverse = np.linalg.inv(columns.T @ columns)
    found = inverse @ (columns.T @ right)
    variance = ((right - columns @ found) ** 2).sum() / (len(right) - columns.shape[1])
    return found[-1], np.sqrt(variance * inverse[-1, -1])


def stiffer_alone(place, points, alone):
    """By how much (ln) a place gives way less to one finger than around it, and its standard error; None at the organ's end.

    As stiffer_between(), but what the organ does as a whole is in it too: a quadratic, which leaves what is as small as a tumour."""
    away = np.linalg.norm(points - place, axis=1)
    near = away < AROUND_ALONE
    if near.sum() < LEAST_PLACES:
        return None
    x, _, z = ((points[near] - place) / AROUND_ALONE).T
    bump = np.exp(-(away[near] ** 2) / (2 * WIDTH_ALONE**2))
    columns = np.stack([np.ones(len(x)), x, z, x * x, x * z, z * z, -bump], 1)
    return last_coefficient(columns, np.log(alone[near]), np.exp(-((away[near] / AROUND_ALONE) ** 2)))


def stiffer_between(place, points, pairs, softness):
    """By how much (ln) tissue is stiffer at a place than around it, and its standard error; None at the organ's end.

    Least squares, near pairs counting more: softness is that of even tissue, which falls with one over the fingers' distance, less a
    Gaussian about the place at each finger."""
    a, b = points[pairs[:, 0]], points[pairs[:, 1]]
    away = np.linalg.norm((a + b) / 2 - place, axis=1)
    near = away < AROUND
    if near.sum() < LEAST_PAIRS:
        return None
    a, b = a[near], b[near]
    bump = sum(np.exp(-((finger - place) ** 2).sum(1) / (2 * WIDTH**2)) for finger in (a, b)) / 2
    columns = np.stack([np.ones(len(a)), 1 / np.linalg.norm(a - b, axis=1), -bump], 1)
    return last_coefficient(columns, np.log(softness[near]), np.exp(-((away[near] / AROUND) ** 2)))


def evidence_of(*found):
    """The geometric mean of how many standard errors each is from none; none where one of them is not stiffer, or at the organ's end."""
    if any(one is None for one in found):
        return -np.inf
    return np.prod([max(0.0, value / error) for value, error in found]) ** (1 / len(found))


def search(hand, surface):
    """Presses all over the surface and answers with the place that is stiffer than what is around it beyond doubt."""
    low, high = surface.vertices.min(0), surface.vertices.max(0)
    points, normals = surface.places(*(np.arange(np.ceil(low[k] / STEP), np.floor(high[k] / STEP)) * STEP + STEP / 2 for k in (0, 2)))
    alone, pairs, softness = feel(hand, points, normals)
    by_one = [stiffer_alone(point, points, alone) for point in points]
    by_two = [stiffer_between(point, points, pairs, softness) for point in points]
    evidence = np.array([evidence_of(*found) for found in zip(by_one, by_two)])
    best = np.argmax(evidence)
    # Between the grid's places: the mean of those near the best, by how far they come up to it.
    weight = np.maximum(evidence - 0.6 * evidence[best], 0) * (np.linalg.norm(points - points[best], axis=1) < 2 * STEP)
    place = (weight[:, None] * np.where(weight > 0, points.T, 0).T).sum(0) / weight.sum()
    return Answer(place, evidence[best], by_two[best][0], len(points) + len(pairs))
