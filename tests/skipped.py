#!/usr/bin/env python3
"""Names the tests that a run left out and why, from ctest's log of all output.

    tests/skipped.py BUILD/Testing/Temporary/LastTest.log
"""
import collections
import re
import sys

REASON = re.compile(r": Skipped$")
ENDED = re.compile(r"^\[  SKIPPED \] (\S+) \(\d+ ms\)$")
TEST = re.compile(r"^test (\S+): skipped: (.+)$")
GOLDEN = re.compile(r"^(\S+): skipped: (.+)$")


def skipped(lines):
    """Reason -> names, in the order of the log."""
    names = collections.defaultdict(list)
    reason, is_reason = "no reason given", False
    for line in (line.rstrip("\n") for line in lines):
        if is_reason:
            reason, is_reason = line.strip() or "no reason given", False
        elif REASON.search(line):
            is_reason = True
        elif ended := ENDED.match(line):
            names[reason].append(ended[1])
            reason = "no reason given"
        elif test := TEST.match(line):
            names[test[2]].append(test[1])
        elif golden := GOLDEN.match(line):
            names[golden[2]].append(f"golden {golden[1]}")
    return names


def main():
    with open(sys.argv[1], encoding="utf-8", errors="replace") as log:
        names = skipped(log)
    if not names:
        return
    print(f"run: {sum(map(len, names.values()))} tests did not run here:", file=sys.stderr)
    for reason, of in names.items():
        print(f"  {reason} ({len(of)}): {', '.join(of)}", file=sys.stderr)


if __name__ == "__main__":
    main()
