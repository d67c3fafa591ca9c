#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the figures of tests/benchmarks/README.md again that other pages quote, and says what came out otherwise.

    tests/commands/docs/remake_figures.py [--whole] [SECTION ...]     such as closed-loops; all that are quoted without a name

PALPATE_BUILD has the build, build/release without it; pipelines/demo.sh makes the assets that most sections want. With --whole,
sections that a test makes in part (figure_sections.py) are made to the end, which takes hours.
"""
import argparse
import sys

from figures import quotations, remake


def main():
    quoted = quotations()
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--whole", action="store_true", help="nothing shortened")
    parser.add_argument("sections", nargs="*", choices=[[], *quoted], metavar="SECTION", help=f"of {', '.join(quoted)}")
    options = parser.parse_args()
    wrong = 0
    for name in options.sections or quoted:
        result = remake(name, quoted[name], options.whole)
        print("\n".join(f"{name}: {row}" for row in (*result.rows, *result.skipped)), flush=True)
        print("".join(f"{name}: WRONG: {error}\n" for error in result.errors), end="", flush=True)
        wrong += len(result.errors)
    return min(wrong, 1)


if __name__ == "__main__":
    sys.exit(main())
