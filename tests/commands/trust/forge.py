# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes every digest of a changed asset anew, by formats/asset/SPEC.md alone: what a forger does."""
import hashlib

import numpy

MECHANICS = ("rest_positions", "tetrahedra", "regions", "material_regions", "materials", "relaxation_regions", "relaxation",
             "fixed_nodes", "contact_nodes")


def sha256(data):
    return hashlib.sha256(data).hexdigest()


def put(node, name, value):
    node.attrs.modify(name, numpy.array(value.encode(), node.attrs[name].dtype))


def tie_surface(body, vertices, triangles):
    put(body["obb_tree"], "surface_sha256",
        sha256(f"vertices {sha256(vertices.tobytes())}\ntriangles {sha256(triangles.tobytes())}\n".encode()))


def tie(asset):
    for body in asset["palpate/bodies"].get("rigid", {}).values():
        tie_surface(body, body["vertices"][...], body["triangles"][...])
    for body in asset["palpate/bodies"].get("deformable", {}).values():
        positions = body["rest_positions"][...]
        tie_surface(body, positions[body["surface_nodes"][...].clip(0, len(positions) - 1)], body["surface_triangles"][...])
        lines = "".join(f"{name} {sha256(body[name][...].tobytes())}\n" for name in MECHANICS if name in body)
        put(body["compliance"], "mechanics_sha256", sha256((lines + f"element_order {body.attrs['element_order']}\n").encode()))


def digest(asset):
    manifest = {}

    def visit(_, node):
        if "sha256" in node.attrs:
            manifest[node.name] = sha256(node[...].tobytes())
            put(node, "sha256", manifest[node.name])
        for name in set(node.attrs) - {"sha256", "manifest_sha256", "signature", "public_key"}:
            attribute = node.attrs.get_id(name)
            value = numpy.empty(attribute.shape, attribute.dtype)
            attribute.read(value)
            manifest[f"{node.name}@{name}"] = sha256(value.tobytes())

    asset.visititems(visit)
    put(asset["palpate"], "manifest_sha256", sha256("".join(f"{key} {manifest[key]}\n" for key in sorted(manifest)).encode()))


def rehash(asset):
    tie(asset)
    digest(asset)
