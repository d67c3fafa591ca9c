#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints each skipped test of a ctest JUnit file with its reason."""
import re
import sys
import xml.etree.ElementTree as ElementTree


def reason_of(output):
    """The line that says why: GTEST_SKIP()'s message, unittest's "skipped '...'" or a script's "skipped: ..."."""
    lines = [line.strip() for line in output.splitlines()]
    for index, line in enumerate(lines):
        if match := re.search(r"skipped ['\"](.+)['\"]|^skipped: (.+)", line):
            return match.group(1) or match.group(2)
        if line.endswith(": Skipped") and index + 1 < len(lines):
            return lines[index + 1]
    return "no reason given"


def main(path):
    skipped = [case for case in ElementTree.parse(path).iter("testcase") if case.find("skipped") is not None]
    for case in skipped:
        print(f"skipped: {case.get('name')}: {reason_of(case.findtext('system-out') or '')}")
    print(f"{len(skipped)} skipped")


if __name__ == "__main__":
    main(sys.argv[1])
