#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How far sound compliances are off the mesh that touch judges them by: the demo's, and its liver condensed otherwise.

    tests/benchmarks/judged_compliances.py [--demo build/demo]      PALPATE_BIN, build/release/bin without it, has the programs
"""
import argparse
import json
import os
import pathlib
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
BIN = pathlib.Path(os.environ.get("PALPATE_BIN", ROOT / "build/release/bin"))
CHECK = "what touch asks of C: worst contact node, part of its displacement"
SOFT = ("liver:6.3,0.45", "tumour:30,0.45")
VARIANTS = {  # of the liver: materials, accuracy
    "the same": (SOFT, 0.001),
    "the same, coarse": (SOFT, 0.1),
    "the same, Poisson's ratios 0.499 and 0.4999": (("liver:6.3,0.499", "tumour:30,0.4999"), 0.01),
    "the same, a tumour of 300 MPa": (("liver:6.3,0.45", "tumour:300000,0.45"), 0.01),
}


def palpate(command, *arguments):
    made = subprocess.run([BIN / f"palpate-{command}", *map(str, arguments), "--quiet", "--json", "-"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    return json.loads(made.stdout)


def row(name, accuracy, asset):
    nodes = sum(body["contact_nodes"] for body in palpate("inspect", asset)["bodies"] if body.get("contact_nodes"))
    checks = palpate("verify", asset)["checks"]
    worst = max(check["figure"] for check in checks if check["check"] == CHECK)
    failed = [check["check"] for check in checks if check["status"] != "ok"]
    print(f"| {name} | {nodes} | {accuracy} | {worst:.2g} | {', '.join(failed) or 'ok'} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--demo", type=pathlib.Path, default=ROOT / "build/demo", help="what pipelines/demo.sh made")
    demo = parser.parse_args().demo
    print("| body | contact nodes | accuracy | worst node | what verify says |\n|---|--:|--:|--:|---|")
    row("the demo's nasopharynx", "dense", demo / "nasopharynx.vtkhdf")
    row("the demo's liver", "dense", demo / "liver.vtkhdf")
    fixed = json.loads((demo / "liver.parts/condense-liver.request.json").read_text())["fixed"][0]["box_mm"]
    with tempfile.TemporaryDirectory() as folder:
        body, asset = pathlib.Path(folder) / "liver.body.h5", pathlib.Path(folder) / "liver.vtkhdf"
        for name, (materials, accuracy) in VARIANTS.items():
            palpate("condense", demo / "liver.parts/liver.vtu", *(word for material in materials for word in ("--material", material)),
                    "--fixed", "box:" + ",".join(map(str, fixed)), "--representation", "hierarchical", "--accuracy", accuracy,
                    "-o", body, "--force")
            palpate("pack", "--name", "liver", "--deformable", f"liver={body}", "-o", asset, "--force")
            row(name, accuracy, asset)


if __name__ == "__main__":
    main()
