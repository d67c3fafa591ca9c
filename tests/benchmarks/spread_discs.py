#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How much more tissue gives way to a narrower disc than to a wider one, beside what their radii say of a half-space.

    spread_discs.py ASSET [--places N]

Loads are spread over discs of 2.5 and 3.5 edges (formats/model/contact/load_shares.cpp) at places drawn evenly over the surface where it
is flat (normals within 32 degrees) and gives way; what the body as a whole adds is the same for both discs. Told for R² as it is, and with
other multiples of the edge squared. Needs an asset whose first elastic body is of one material and has a dense compliance. A disc is what
lies within its reach, where the load shares' own goes over the surface: they differ beside folds, which are not flat.
"""
import argparse
import pathlib

import h5py
import numpy as np

DISCS = 2.5, 3.5  # reach, in edges
SPREAD = 0.76654  # c_R E* R, of local_indentation.cpp


class Surface:
    def __init__(self, body):
        nodes, self.triangles = body["surface_nodes"][...], body["surface_triangles"][...]
        block = {node: k for k, node in enumerate(body["contact_nodes"][...])}
        self.block = np.array([block.get(node, -1) for node in nodes])
        self.at, self.compliance = body["rest_positions"][...][nodes], body["compliance/dense"][...]
        corners = self.at[self.triangles]
        self.across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        self.middle, self.area = corners.mean(axis=1), np.linalg.norm(self.across, axis=1) / 2
        self.areas, normals = np.zeros(len(nodes)), np.zeros((len(nodes), 3))
        for corner in self.triangles.T:
            np.add.at(self.areas, corner, self.area / 3)
            np.add.at(normals, corner, self.across)
        self.normals = normals / np.linalg.norm(normals, axis=1)[:, None]
        ends = np.vstack([self.triangles[:, [k, (k + 1) % 3]] for k in range(3)])
        ends = ends[(self.block[ends] >= 0).all(axis=1)]
        lengths = np.sort(np.linalg.norm(self.at[ends[:, 0]] - self.at[ends[:, 1]], axis=1))
        self.edge = lengths[len(lengths) // 4]

    def shares(self, vertex, reach):
        """Vertices of the disc about a vertex and their shares; None where part of it does not give way."""
        squared = ((self.at - self.at[vertex]) ** 2).sum(axis=1)
        inside = np.flatnonzero((squared < reach**2) & (self.normals @ self.normals[vertex] > 0.3))
        weights = self.areas[inside] * (1 - squared[inside] / reach**2) ** 2
        return (inside, weights / weights.sum()) if (self.block[inside] >= 0).all() else None

    def gives_way(self, triangle, reach):
        """Along the normal, per force, on the mean of all places in a triangle, mm/N; None where part does not."""
        discs = [self.shares(vertex, reach) for vertex in self.triangles[triangle]]
        if any(disc is None for disc in discs):
            return None
        normal = self.across[triangle] / np.linalg.norm(self.across[triangle])
        total = 0
        for i, (here, shares) in enumerate(discs):
            for j, (there, others) in enumerate(discs):
                rows, columns = (3 * self.block[v][:, None] + np.arange(3) for v in (here, there))
                block = self.compliance[np.ix_(rows.ravel(), columns.ravel())].reshape(len(here), 3, len(there), 3)
                total += np.einsum("a,i,aibj,j,b", shares, normal, block, normal, others) / (6 if i == j else 12)
        return total

    def is_flat(self, triangle):
        near = np.linalg.norm(self.middle - self.middle[triangle], axis=1) < DISCS[-1] * self.edge
        normals = self.across[near] / np.linalg.norm(self.across[near], axis=1)[:, None]
        return (normals @ self.across[triangle]).min() / np.linalg.norm(self.across[triangle]) > 0.85


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("asset", type=pathlib.Path)
    parser.add_argument("--places", type=int, default=400, help="drawn; those that are not flat are left out")
    arguments = parser.parse_args()
    with h5py.File(arguments.asset) as file:
        body = file["palpate/bodies/deformable/0"]
        surface, (modulus, ratio) = Surface(body), body["materials"][0]
        held = body["rest_positions"][...][body["fixed_nodes"][...]]
    drawn = np.random.default_rng(0).choice(len(surface.area), min(arguments.places, len(surface.area)), replace=False)
    flat = [t for t in drawn if surface.is_flat(t)]
    found = [[surface.gives_way(t, disc * surface.edge) for disc in DISCS] for t in flat]
    kept = [(t, narrow - wide) for t, (narrow, wide) in zip(flat, found) if narrow is not None and wide is not None]
    more = [difference for _, difference in kept]
    own = [2 * np.sqrt(surface.area[t] / np.sqrt(3)) for t, _ in kept]  # edge of an equilateral triangle as large
    to_held = [np.linalg.norm(held - surface.middle[t], axis=1).min() for t, _ in kept]
    low, median, high = np.percentile(more, [25, 50, 75])
    print(f"{arguments.asset.stem}: edge {surface.edge:.2f} mm, there {np.median(own):.2f} mm; {len(more)} places, "
          f"narrower disc gives way more by {median:.3f} mm/N ({low:.2f} to {high:.2f} in the middle half)")
    print(f"correlation with that edge {np.corrcoef(more, own)[0, 1]:.2f}, with the distance to held nodes {np.corrcoef(more, to_held)[0, 1]:.2f}")
    for multiple in 0, 1, 2, 3:
        radii = [surface.edge * np.sqrt(disc**2 + multiple) for disc in DISCS]
        print(f"R² + {multiple} edge²: {SPREAD * (1 - ratio**2) / modulus * (1 / radii[0] - 1 / radii[1]):.3f} mm/N")


if __name__ == "__main__":
    main()
