# SPDX-License-Identifier: Apache-2.0
"""Rooms and folders of the source tree, and who includes whom, read from the code's own #include lines."""
import re
from collections import defaultdict
from pathlib import Path, PurePosixPath

HALLS = ("formats", "tools", "runtime")
INCLUDE = re.compile(r'^\s*#\s*include\s+([<"])([^>"]+)[>"]', re.MULTILINE)
# What the beginning of a header's name says about the library that it comes from.
LIBRARIES = {
    "boost/": "Boost", "CGAL/": "CGAL", "cblas.h": "OpenBLAS", "cholmod.h": "CHOLMOD", "CLI/": "CLI11",
    "dcmtk/": "DCMTK", "Eigen/": "Eigen", "unsupported/Eigen/": "Eigen", "fmt/": "fmt", "gdcm": "GDCM",
    "hdf5.h": "HDF5", "igtl": "OpenIGTLink", "itk": "ITK", "lapacke.h": "OpenBLAS", "metis.h": "METIS",
    "nlohmann/": "nlohmann-json", "openssl/": "OpenSSL", "spdlog/": "spdlog", "Spectra/": "Spectra",
    "toml++/": "toml++", "vtk": "VTK", "X11/": "X11",
}


def sources(root):
    """The C++ files of the three halls, as paths below `root`."""
    return [PurePosixPath(path.relative_to(root).as_posix())
            for hall in HALLS for path in sorted((root / hall).rglob("*.[ch]pp"))]


def room_of(path):
    """formats/asset for formats/asset/hdf5/digest.cpp."""
    return "/".join(path.parts[:2])


def room_names(root):
    return sorted({room_of(path) for path in sources(root)}, key=lambda room: (HALLS.index(room.split("/")[0]), room))


def _edges(root, place_of):
    """place -> places that its files include, itself left out."""
    edges = defaultdict(set)
    for path in sources(root):
        for mark, header in INCLUDE.findall((root / path).read_text()):
            if mark == '"' and header.startswith(tuple(f"{hall}/" for hall in HALLS)):
                edges[place_of(path)].add(place_of(PurePosixPath(header)))
    return {place: targets - {place} for place, targets in edges.items()}


def room_edges(root):
    return _edges(root, room_of)


def folder_edges(root):
    """As room_edges() for every folder. A folder and the one that it lies in are one thing to their neighbours."""
    def apart(a, b):
        return not f"{a}/".startswith(f"{b}/") and not f"{b}/".startswith(f"{a}/")
    edges = _edges(root, lambda path: path.parent.as_posix())
    return {folder: {other for other in targets if apart(folder, other)} for folder, targets in edges.items()}


def room_libraries(root):
    """room -> names of the libraries that it includes, the system's own left out."""
    libraries = defaultdict(set)
    for path in sources(root):
        for mark, header in INCLUDE.findall((root / path).read_text()):
            libraries[room_of(path)] |= {name for start, name in LIBRARIES.items() if mark == "<" and header.startswith(start)}
    return libraries


def purpose(root, room):
    """The second line of a room's CMakeLists.txt, which says in a sentence what the room is; None without one."""
    path = root / room / "CMakeLists.txt"
    lines = path.read_text().splitlines() if path.exists() else []
    return lines[1][2:].strip() if len(lines) > 1 and lines[1].startswith("# ") else None


def reachable(edges, start):
    """Everything that `start` includes, directly or through others."""
    seen, left = set(), list(edges.get(start, ()))
    while left:
        place = left.pop()
        if place not in seen:
            seen.add(place)
            left += edges.get(place, ())
    return seen


def cycle(edges):
    """Places that include each other in a circle, the first again at the end; empty if there is none."""
    for start in sorted(edges):
        if start not in reachable(edges, start):
            continue
        path = [start]
        while path[-1] != start or len(path) == 1:
            path.append(next(place for place in sorted(edges[path[-1]])
                             if place == start or place not in path and start in reachable(edges, place)))
        return path
    return []
