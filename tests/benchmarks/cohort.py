#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds a cohort of 100 patients, five of them broken in different ways, here and through a Slurm of this machine's own, kills
what builds it in the middle, and says what that took.

    tests/benchmarks/cohort.py [--patients N] [--skip-slurm] [FOLDER]

Prints, and leaves in FOLDER, build/cohort without it: seconds, how busy the cores were, seconds beside the stages' own for each
job, peak memory, whether both ways made the same bytes, and what a second run and a run after each kill executed.
"""
import argparse
import hashlib
import itertools
import json
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "tests" / "commands"))
import slurm_here  # noqa: E402

BIN = Path(os.environ.get("PALPATE_BIN", SOURCE / "build/release/bin"))
PHANTOM = Path(os.environ.get("PALPATE_BUILD", SOURCE / "build/release")) / "tests" / "phantom"
DATA = Path(os.environ.get("PALPATE_DATA", SOURCE / "../shared/data"))
# Organs of real label maps whose case files `palpate init` drafts.
REAL = [("abdomen_ct_totalseg3mm/seg_totalseg.nii.gz", organ) for organ in ("liver", "spleen", "kidney_right", "kidney_left", "stomach")]

CASE = """schema = 1
name = "abdomen"
[input]
labels = "labels1.seg.nrrd"
[[structure]]
name = "liver"
recipe = "import"
[[structure]]
name = "tumour"
recipe = "import"
[[deformable]]
name = "liver"
mesh = { cell_size_mm = 6 }
fixed = [{ plane_mm = [0, 8, 0, 0, 1, 0] }]
[[deformable.region]]
label = "liver"
youngs_modulus_kpa = 6.3
poissons_ratio = 0.45
[[deformable.region]]
label = "tumour"
youngs_modulus_kpa = 30
poissons_ratio = 0.45
"""
COLUMNS = ("patient", "case", "labels", "deformable.liver.mesh.cell_size_mm", "deformable.liver.region.liver.youngs_modulus_kpa")
BROKEN = [("cut-off", "case.toml", "cut.seg.nrrd", "", ""), ("not there", "case.toml", "", "", ""),
          ("missing", "case.toml", "none.seg.nrrd", "", ""), ("negative", "case.toml", "", "", "-4"),
          ("unmeshable", "strict.toml", "", "", "")]


def make_cohort(folder, patients):
    """Writes case files, phantoms and the table; how many of its patients can be built."""
    grids = [(spacing, angle) for spacing in ("2", "1.6") for angle in ("0", "10", "25", "40")]
    for i, (spacing, angle) in enumerate(grids, 1):
        subprocess.run([PHANTOM, "abdomen", folder / "ct.nrrd", folder / f"labels{i}.seg.nrrd", "--spacing", spacing, "--angle", angle,
                        "--quiet", "--force"], check=True, stdout=subprocess.DEVNULL)
    (folder / "cut.seg.nrrd").write_bytes((folder / "labels1.seg.nrrd").read_bytes()[:2000])
    (folder / "case.toml").write_text(CASE)
    (folder / "strict.toml").write_text(CASE + "[quality]\nmin_dihedral_deg = 80\n")
    rows = []
    for labels, organ in REAL:
        if (DATA / labels).exists() and len(rows) + len(BROKEN) < patients:
            drafted = subprocess.run([BIN / "palpate", "init", DATA / labels, "--organ", organ, "-o", folder / f"{organ}.toml", "--quiet", "--force"],
                                     stdout=subprocess.DEVNULL, check=False)
            if drafted.returncode == 0:
                rows.append((organ, f"{organ}.toml", "", "", ""))
    variations = itertools.product(("6", "7", "8", "9"), ("4", "6", "8"), range(1, len(grids) + 1))
    for cell, modulus, grid in itertools.islice(variations, patients - len(BROKEN) - len(rows)):
        rows.append((f"p{len(rows):03}", "case.toml", f"labels{grid}.seg.nrrd", cell, modulus))
    table = [COLUMNS, *BROKEN, *rows]
    (folder / "patients.tsv").write_text("".join("\t".join(row) + "\n" for row in table))
    return len(rows)


class Batch:
    """palpate batch in the background, and what it and its children took when it has ended."""

    def __init__(self, folder, out, *options, environment=None):
        self.out, self.started, self.before = folder / out, time.monotonic(), resource.getrusage(resource.RUSAGE_CHILDREN)
        self.talk = (folder / f"{out}.txt").open("w")
        self.process = subprocess.Popen([BIN / "palpate", "batch", folder / "patients.tsv", "-o", self.out, "--json", self.out.with_suffix(".json"),
                                         "--force", *options], stderr=self.talk, stdout=self.talk, env=environment)

    def wait(self, built, total):
        """Figures of a whole run."""
        code = self.process.wait()
        seconds = time.monotonic() - self.started
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        cpu = after.ru_utime + after.ru_stime - self.before.ru_utime - self.before.ru_stime
        result = json.loads(self.out.with_suffix(".json").read_text())
        statuses = [row["status"] for row in result["patients"]]
        assert (statuses.count("built"), len(statuses)) == (built, total), statuses
        assert (code == 0) == (built == total), code
        return {"exit_code": code, "built": built, "failed": statuses.count("failed"), "stages": result["stages_to_do"], "seconds": round(seconds, 1),
                "cores_busy_percent": round(100 * cpu / seconds / os.cpu_count(), 1)}

    def wait_for_stages(self, count):
        while len(list(self.out.glob("*.parts/[!.]*.stage.json"))) < count:
            assert self.process.poll() is None
            time.sleep(0.1)


def digests(out):
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in sorted(out.glob("*.vtkhdf"))}


def peaks_over_forecasts(out):
    """Of each finished stage: largest resident set by what Snakemake was told to expect."""
    told = re.findall(r"wildcards: patient=(.*), stage=(.*)\n +resources: .*mem_mb=(\d+)", (out / "logs/snakemake.log").read_text())
    forecasts = {(patient, stage): float(memory) for patient, stage, memory in told}
    rows = [line.split("\t") for line in (out / "stages.tsv").read_text().splitlines()[1:]]
    return {(patient, stage): float(peak) / forecasts[patient, stage.replace(" ", "-")] for patient, stage, _, peak in rows}


def stage_times(out):
    return {path: path.stat().st_mtime_ns for path in out.glob("*.parts/[!.]*.stage.json")}


def resumed(folder, out, built, total, **options):
    """Runs to the end after a kill: how many stages were finished before, that none of them ran again, and figures."""
    finished = stage_times(folder / out)
    figures = Batch(folder, out, *options.pop("options", ()), **options).wait(built, total)
    now = stage_times(folder / out)
    return {"finished_before": len(finished), "of_those_run_again": sum(now[path] != stamp for path, stamp in finished.items()), **figures}


def verified(out):
    for asset in sorted(out.glob("*.vtkhdf")):
        subprocess.run([BIN / "palpate", "verify", asset], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return True


def here(folder, built, total):
    figures = {"local": Batch(folder, "local").wait(built, total)}
    stages = [line.split("\t") for line in (folder / "local/stages.tsv").read_text().splitlines()[1:]]
    own = sum(float(row[2]) for row in stages)
    figures["local"]["stage_seconds"] = round(own, 1)
    figures["local"]["peak_memory_mb"] = max(float(row[3]) for row in stages)
    figures["local"]["seconds_beside_stages_per_job"] = round((figures["local"]["seconds"] * os.cpu_count() - own) / len(stages), 3)
    ratios = peaks_over_forecasts(folder / "local").values()
    figures["local"]["peak_over_forecast_memory"] = [round(min(ratios), 2), round(max(ratios), 2)]
    figures["again"] = Batch(folder, "local").wait(built, total)
    one = Batch(folder, "one", "--threads", "1").wait(built, total)
    figures["one_core"], figures["speedup_of_two_jobs"] = one, round(one["seconds"] / figures["local"]["seconds"], 2)
    batch = Batch(folder, "killed")
    batch.wait_for_stages(total)
    batch.process.kill()
    batch.process.wait()
    figures["controller_killed"] = resumed(folder, "killed", built, total)
    figures["same_bytes_after_kill"] = digests(folder / "killed") == digests(folder / "local")
    figures["verified"] = verified(folder / "killed")
    return figures


def through_slurm(folder, built, total):
    home = folder / "slurm_home"
    home.mkdir()
    cluster, slurm = slurm_here.Cluster(home), ("--profile", "slurm")
    try:
        cluster.start()
        batch = Batch(folder, "slurm", *slurm, environment=cluster.environment)
        batch.wait_for_stages(total)
        subprocess.run(["pkill", "-KILL", "-f", "palpate-mesh"], check=False)
        cluster.kill("slurmd")
        batch.process.kill()
        batch.process.wait()
        time.sleep(2)
        cluster.start_node()
        figures = {"killed_job_node_and_controller": resumed(folder, "slurm", built, total, options=slurm, environment=cluster.environment)}
        figures["same_bytes_as_local"] = digests(folder / "slurm") == digests(folder / "local")
        figures["again"] = Batch(folder, "slurm", *slurm, environment=cluster.environment).wait(built, total)
    finally:
        cluster.stop()
    return figures


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--patients", type=int, default=100)
    parser.add_argument("--skip-slurm", action="store_true")
    parser.add_argument("folder", type=Path, nargs="?", default=SOURCE / "build/cohort")
    options = parser.parse_args()
    folder = options.folder.absolute()
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    built = make_cohort(folder, options.patients)
    total = built + len(BROKEN)
    figures = {"local": here(folder, built, total)}
    if not options.skip_slurm:
        figures["slurm"] = slurm_here.why_not() or through_slurm(folder, built, total)
    (folder / "figures.json").write_text(json.dumps(figures, indent=2) + "\n")
    print(json.dumps(figures, indent=2))


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    main()
