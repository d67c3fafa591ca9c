# SPDX-License-Identifier: Apache-2.0
"""A made-up patient's asset, written once for a class of tests."""
import os
import pathlib
import subprocess
import tempfile
import unittest

TESTS = pathlib.Path(os.environ["PALPATE_BUILD"]) / "tests"


class SampleAsset(unittest.TestCase):
    """Gives its tests `folder`, a scratch folder of the class, and `asset` in it."""

    writer = "write_sample_asset"  # or "write_sample_case", whose compliance is made up
    variant = ()  # a word that the writer knows

    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        cls.folder = pathlib.Path(temporary.name)
        cls.asset = cls.folder / "sample.vtkhdf"
        subprocess.run([TESTS / cls.writer, cls.asset, *cls.variant], check=True)
