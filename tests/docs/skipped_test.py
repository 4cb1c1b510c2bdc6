#!/usr/bin/env python3
"""tests/skipped.py names what did not run, by reason."""
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import skipped  # noqa: E402

LOG = """\
[ RUN      ] Flip.Pairs
tests/unit/metrics_flip.cpp:63: Skipped
the folder shared/flip is absent

[  SKIPPED ] Flip.Pairs (0 ms)
[ RUN      ] Flip.Formula
[       OK ] Flip.Formula (3 ms)
[ RUN      ] HdrFlip.Pairs
tests/unit/metrics_hdr_flip.cpp:17: Skipped
the folder shared/flip is absent

[  SKIPPED ] HdrFlip.Pairs (0 ms)
[  SKIPPED ] 2 tests, listed below:
[  SKIPPED ] Flip.Pairs
[  SKIPPED ] HdrFlip.Pairs
real-fox: skipped: the assets folder is not here
test package_container: skipped: no package in out/package (./run package)
"""


class Skipped(unittest.TestCase):
    def test_each_once_by_its_reason(self):
        self.assertEqual(dict(skipped.skipped(LOG.splitlines(True))),
                         {"the folder shared/flip is absent": ["Flip.Pairs", "HdrFlip.Pairs"],
                          "the assets folder is not here": ["golden real-fox"],
                          "no package in out/package (./run package)": ["package_container"]})

    def test_nothing_where_all_ran(self):
        self.assertEqual(dict(skipped.skipped(["[       OK ] Flip.Formula (3 ms)\n"])), {})


if __name__ == "__main__":
    unittest.main()
