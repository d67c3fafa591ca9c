#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures palpate-segment against reference labels: overlap, surface distance, volume, time and memory.

Needs PALPATE_BUILD (a build folder in which the target judge_segmentation is built) and PALPATE_DATA. Prints one table; nothing fails here.
Seeds are drawn at random inside the reference, eroded by a margin, so that no result depends on chosen points:
    measure_segmentation.py [sets of seeds a case, default 5] [seeds a set, default 5] [margin in mm, default 8]
"""
import gzip
import json
import os
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile

BUILD, DATA = pathlib.Path(os.environ["PALPATE_BUILD"]), pathlib.Path(os.environ["PALPATE_DATA"])
SEGMENT, IMPORT = BUILD / "bin" / "palpate-segment", BUILD / "bin" / "palpate-import"
JUDGE = BUILD / "tests" / "judge_segmentation"
SETS, SEEDS, MARGIN = (int(text) for text in (sys.argv[1:] + ["5", "5", "8"][len(sys.argv) - 1:]))


def answer(*arguments):
    done = subprocess.run(list(map(str, arguments)), text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    if done.returncode != 0:
        raise RuntimeError(done.stderr)
    return json.loads(done.stdout)


def segment(volume, structures, output):
    options = [word for structure in structures for word in ("--structure", structure)]
    return answer(SEGMENT, "--volume", volume, *options, "-o", output, "--force", "--quiet", "--json", "-")


def voxels(volume):
    header = gzip.open(volume).read() if volume.suffix == ".gz" else volume.read_bytes()
    sizes = re.search(rb"sizes: (\d+) (\d+) (\d+)", header.split(b"\n\n", 1)[0])
    return int(sizes[1]) * int(sizes[2]) * int(sizes[3])


def with_slices(volume, count, output):
    """The volume with its slices mirrored until there are so many: the anatomy is odd, the work is real."""
    header, body = volume.read_bytes().split(b"\n\n", 1)
    raw = gzip.decompress(body)
    i, j, k = map(int, re.search(rb"sizes: (\d+) (\d+) (\d+)", header).groups())
    step = len(raw) // k
    order = (list(range(k)) + list(range(k - 1, -1, -1))) * (count // k + 1)
    header = re.sub(rb"sizes: \d+ \d+ \d+", b"sizes: %d %d %d" % (i, j, count), header)
    output.write_bytes(header + b"\n\n" + gzip.compress(b"".join(raw[n * step:(n + 1) * step]
                                                                for n in order[:count]), 1))
    return output


def row(name, result, volume, score):
    floats = voxels(volume) * 4
    spread = [each["dice"] for each in score]
    worst = min(score, key=lambda each: each["dice"])
    print(f"{name:<34} {statistics.median(spread):.3f} ({min(spread):.3f} ... {max(spread):.3f}) "
          f"{worst['distance_95_mm']:6.1f} {worst['volume_ml']:7.0f} {worst['reference_ml']:7.0f} "
          f"{max(each['seconds'] for each in result):6.1f} "
          f"{max(each['peak_memory_bytes'] for each in result) / floats:5.1f}", flush=True)


def liver(name, volume, reference, label, scratch):
    results, scores = [], []
    for number in range(SETS):
        seeds = answer(JUDGE, "seeds", reference, label, SEEDS, number + 1, MARGIN)
        output = scratch / "liver.seg.nrrd"
        results.append(segment(volume, [f"liver: recipe=liver seeds={seeds}"], output))
        scores.append(answer(JUDGE, "score", output, "liver", reference, label))
    row(name, results, volume, scores)
    return seeds


def main():
    with tempfile.TemporaryDirectory() as folder:
        scratch = pathlib.Path(folder)

        def imported(path, name, *options):
            output = scratch / name
            answer(IMPORT, *options, DATA / path, "-o", output, "--force", "--quiet", "--json", "-")
            return output

        print(f"{SETS} sets of {SEEDS} seeds at least {MARGIN} mm deep; distance and volumes of the worst set\n"
              f"{'':<34} Dice (worst ... best)     95 % mm      ml  ref ml      s  memory/volume")
        spl = imported("abdomen_ct_spl/ct.nrrd", "spl.nrrd")
        seeds = liver("liver, contrast, SPL atlas", spl, DATA / "abdomen_ct_spl/seg.nrrd", "3", scratch)
        slab = imported("abdomen_dicom_ts20/dicom", "slab.nrrd")
        prior = imported("abdomen_dicom_ts20/seg_totalseg.nii.gz", "slab.seg.nrrd", "--labels")
        answer(SEGMENT, "--volume", slab, "--labels", prior, "--structure", "liver: recipe=import label=5",
               "-o", scratch / "slab_liver.seg.nrrd", "--quiet", "--json", "-")
        liver("liver, contrast, slab", slab, scratch / "slab_liver.seg.nrrd", "liver", scratch)
        plain = imported("abdomen_ct_totalseg3mm/ct.nii.gz", "plain.nrrd")
        liver("liver, no contrast, 3 mm", plain, DATA / "abdomen_ct_totalseg3mm/seg_totalseg.nii.gz", "5", scratch)

        # The threshold mask without the head rest: its largest piece and what lies within the body.
        head = imported("head_ct_cranium/head_ct_cranium.nrrd", "head.nrrd")
        reference = scratch / "bone.seg.nrrd"
        answer(SEGMENT, "--labels", DATA / "head_ct_cranium/head_ct_cranium_mask_bone.nrrd", "--structure",
               "bone: recipe=import label=* keep_largest=yes", "-o", reference, "--quiet", "--json", "-")
        output = scratch / "found.seg.nrrd"
        result = segment(head, ["bone: recipe=bone"], output)
        row("bone, head", [result], head, [answer(JUDGE, "score", output, "bone", reference, "bone")])

        coarse = imported("head_ct_headsq64/head_ct_headsq64.mhd", "coarse.nrrd")
        result = segment(coarse, ["airway: recipe=airway"], output)
        airway = result["labels"][0]
        print(f"airway, nose to larynx             {airway['components']} piece, "
              f"{airway['box_min_mm']} to {airway['box_max_mm']} mm, {airway['volume_ml']:.0f} ml, "
              f"{result['seconds']:.1f} s")

        print(f"\n{'time and memory':<34} {'voxels':>12}      s  memory/volume")
        large = with_slices(slab, 119, scratch / "large.nrrd")
        medium = with_slices(spl, 108, scratch / "medium.nrrd")
        slab_seeds = answer(JUDGE, "seeds", scratch / "slab_liver.seg.nrrd", "liver", SEEDS, 1, MARGIN)
        for name, volume, structure in (
                ("liver", medium, f"liver: recipe=liver largest_ml=20000 seeds={seeds}"),
                ("bone", head, "bone: recipe=bone"), ("airway", head, "airway: recipe=airway"),
                ("grow-from-seeds", medium, f"a: recipe=grow-from-seeds seeds={seeds}"),
                ("liver", large, f"liver: recipe=liver largest_ml=20000 seeds={slab_seeds}"),
                ("bone", large, "bone: recipe=bone"), ("airway", large, "airway: recipe=airway"),
                ("grow-from-seeds", large, f"a: recipe=grow-from-seeds seeds={slab_seeds}")):
            result = segment(volume, [structure], output)
            print(f"{name:<34} {voxels(volume):>12} {result['seconds']:6.1f} "
                  f"{result['peak_memory_bytes'] / voxels(volume) / 4:6.1f}", flush=True)
        print("grow_from_seeds() alone, 256 x 256 x 108:",
              answer(JUDGE, "grow", medium, f"liver={seeds.split(';')[0]}", f"background={seeds.split(';')[1]}"))


if __name__ == "__main__":
    main()
