# SPDX-License-Identifier: GPL-3.0-or-later
"""The blind hand on a made-up plate whose compliance is known in closed form."""
import unittest

import numpy as np
from blind_hand import Hand, Surface, search

SIZE, TUMOUR = 160.0, np.array([100.0, 0.0, 60.0])  # mm


def plate():
    """A square whose front is the plane y = 0."""
    a, b = np.meshgrid(np.arange(0, SIZE + 1, 8.0), np.arange(0, SIZE + 1, 8.0), indexing="ij")
    vertices = np.column_stack([a.ravel(), np.zeros(a.size), b.ravel()])
    n = len(a)
    corner = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    return Surface(vertices, np.concatenate([np.column_stack([corner, corner + n, corner + 1]), np.column_stack([corner + 1, corner + n, corner + n + 1])]))


class MadeUpHand(Hand):
    """Presses on a plate that gives way near a finger, bends as a whole, much more at its far end, and may hide something stiff."""

    def __init__(self, stiffer):
        super().__init__(None, None, None)
        self.stiffer = stiffer

    def compliance(self, a, b):
        def bend(p):
            return 1 + 3 * (p[..., 0] / SIZE) ** 2

        def soft(p):
            return 1 - self.stiffer * np.exp(-(np.linalg.norm(p - TUMOUR, axis=-1) / 14) ** 2)

        near = 15 / (1 + (np.linalg.norm(a - b, axis=-1) / 8) ** 2)
        return near * np.sqrt(soft(a) * soft(b)) + 5 * np.sqrt(bend(a) * bend(b))

    def press(self, *fingers):
        points = [p for p, _ in fingers]
        c = np.array([[self.compliance(p, q) for q in points] for p in points]).transpose(2, 0, 1)
        depth = np.full((len(points[0]), len(points)), self.depth)
        return [(f, self.depth + 0 * f) for f in np.linalg.solve(c, depth[..., None])[..., 0].T]


class BlindHand(unittest.TestCase):
    def test_finds_what_is_stiff_and_not_what_bends_less(self):
        answer = search(MadeUpHand(stiffer=0.4), plate())
        self.assertTrue(answer.found)
        self.assertLess(np.linalg.norm(answer.place - TUMOUR), 5)

    def test_finds_nothing_where_nothing_is(self):
        self.assertFalse(search(MadeUpHand(stiffer=0), plate()).found)

    def test_sees_the_front_alone(self):
        surface = plate()
        points, normals = surface.places(np.arange(4, SIZE, 8.0), [20.0])
        self.assertEqual(len(points), 20)
        self.assertLess(np.abs(normals - [0, -1, 0]).max(), 1e-9)
        turned = Surface(surface.vertices, surface.triangles[:, ::-1])
        self.assertEqual(len(turned.places([20.0], [20.0])[0]), 0)


if __name__ == "__main__":
    unittest.main()
