#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints what `palpate build` and `palpate verify` said of one case (their JSON results) on one screen."""
import json
import sys


def main(build_path, verify_path):
    with open(build_path) as file:
        build = json.load(file)
    with open(verify_path) as file:
        verify = json.load(file)
    stages = {row["stage"]: row for row in build["stages"]}

    print(f"\n{build['asset']}")
    print(f"  {'stage':<24}{'seconds':>9}{'peak MB':>9}  status")
    for row in build["stages"]:
        print(f"  {row['stage']:<24}{row['seconds']:>9.2f}{row['peak_memory_mb']:>9.0f}  {row['status']}")
    print(f"  {'sum / largest':<24}{sum(r['seconds'] for r in stages.values()):>9.2f}"
          f"{max(r['peak_memory_mb'] for r in stages.values()):>9.0f}")
    for name, row in stages.items():
        if not name.startswith("condense "):
            continue
        result, certificate = row["result"], row["result"]["certificate"]
        print(f"  {result['name']}: {result['nodes']} nodes, {result['tetrahedra']} tetrahedra, "
              f"{result['surface_nodes']} surface nodes, {result['contact_nodes']} of them free to touch")
        in_double = certificate["residual_double"]
        print(f"  certificate: residual {certificate['residual']:.1e} stored, "
              f"{'compressed at once' if in_double is None else f'{in_double:.1e} in double'}; "
              f"reciprocity {certificate['reciprocity']:.1e}; condition number {certificate['condition_number']:.0f}")
    touch = stages["touch"]["result"]
    print(f"  touch: {touch['ticks']} ticks, {touch['overruns']} overruns, peak force {touch['force_peak_n']:.3f} N")
    print(f"  verify: {verify['verdict']}")
    print(f"  asset:  {build['asset']}\n  report: {build['report']}")


if __name__ == "__main__":
    main(*sys.argv[1:])
