#!/usr/bin/env python3
"""Runs every fault of a build of the preset `mutate` against its tests, and says which were caught (docs/building/testing.md).

Ends with 0 when at least 95 % of the faults that count are caught.
"""
import argparse
import fnmatch
import hashlib
import json
import os
import re
import resource
import subprocess
import sys
import tempfile
import threading
import time
import tomllib
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
NEEDED = {"written": 60, "drawn": 40}
LEAST = 0.95
# A shader that the fault keeps from compiling proves nothing of the tests.
NOT_COMPILED = re.compile(r"\.(glsl|comp|frag|vert|rgen|rahit|rchit|rmiss|h):\d+(, included by [^']*)?: '")
MEMORY_BYTES = 12 << 30


def digest_of(faults):
    """Of the faults and of the files that they are in."""
    digest = hashlib.sha256(json.dumps([[f["name"], f["edit"]] for f in faults]).encode())
    for name in sorted({edit["file"] for fault in faults for edit in fault["edit"]}):
        digest.update((ROOT / name).read_bytes())
    return digest.hexdigest()[:16]


def limit_memory():
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


class Runner:
    def __init__(self, build):
        self.build = build
        self.baseline_s = {}
        self.probe_digest = None
        self.probing = threading.Lock()

    def run(self, command, fault, folder, timeout_s):
        """Exit code (None after the time limit) and what was printed."""
        environment = {k: v for k, v in os.environ.items() if not k.startswith("CANDELA_")}
        environment |= {"TMPDIR": folder, "TEST_TMPDIR": folder + "/", "XDG_CACHE_HOME": str(self.build / "mutated/cache")}
        if fault:
            environment["CANDELA_FAULT"] = fault
        # A session of its own, so that what a program starts ends with it.
        process = subprocess.Popen(command, cwd=ROOT, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                                   errors="replace", preexec_fn=limit_memory, start_new_session=True)
        try:
            output, _ = process.communicate(timeout=timeout_s)
            return process.returncode, output
        except subprocess.TimeoutExpired:
            return None, ""
        finally:
            try:
                os.killpg(process.pid, 9)
            except ProcessLookupError:
                pass
            process.wait()

    def command(self, test):
        program, tests = test.split(":", 1)
        return [str(self.build / program), f"--gtest_filter={tests}", "--gtest_fail_fast"]

    def in_folder(self, use):
        with tempfile.TemporaryDirectory(prefix="candela-mutate-") as folder:
            return use(folder)

    def measure(self, test):
        """The test without a fault: it must pass, and be there."""
        start = time.monotonic()
        code, output = self.in_folder(lambda folder: self.run(self.command(test), None, folder, 1200))
        self.baseline_s[test] = time.monotonic() - start
        if re.search(r"Running 0 tests", output):
            return f"{test}: there is no such test"
        if code != 0:
            return f"{test} fails without a fault (exit code {code}):\n{output[-3000:]}"
        return None

    def probes(self, fault):
        """A digest of what the probes write and print, each on its own."""
        settings = tomllib.loads((HERE / "drawn.toml").read_text())
        digests = []
        for probe in settings["probes"]:
            def one(folder):
                os.mkdir(folder + "/out")
                commands = [command.replace("OUT", folder + "/out").split() for command in probe.split(" && ")]
                code, output = 0, ""
                for program, *words in commands:
                    code, more = self.run([str(self.build / program), *words], fault, folder, 600)
                    output += more
                digest = hashlib.sha256(f"{code}\n{output.replace(folder, '')}".encode())
                for path in sorted(Path(folder, "out").rglob("*")):
                    if path.is_file():
                        digest.update(path.name.encode() + b"\0" + path.read_bytes())
                return code, digest.hexdigest(), output
            digests.append((probe, *self.in_folder(one)))
        return digests

    def sound_probes(self):
        """The probes without a fault, which must end well and be the same twice."""
        with self.probing:
            if not self.probe_digest:
                first, second = self.probes(None), self.probes(None)
                for (probe, code, digest, output), (*_, again, _) in zip(first, second):
                    if code != 0 or digest != again:
                        raise SystemExit(f"mutate: without a fault a probe ends with {code}, or is not the same twice: {probe}\n{output}")
                self.probe_digest = first
            return self.probe_digest

    def judge(self, fault):
        result = {key: fault[key] for key in ("name", "kind")}
        result["places"] = [f"{edit['file']}:{edit['line']}" for edit in fault["edit"]]
        result["tests"] = fault["tests"]
        if fault["kind"] != "written":
            result |= {"old": fault["edit"][0]["old"], "new": fault["edit"][0]["new"]}
        for test in sorted(fault["tests"], key=lambda test: self.baseline_s[test]):
            limit_s = 60 + 10 * self.baseline_s[test]
            code, output = self.in_folder(lambda folder: self.run(self.command(test), fault["name"], folder, limit_s))
            if code == 0:
                continue
            if NOT_COMPILED.search(output):
                return result | {"verdict": "invalid", "by": "the shader does not compile"}
            failed = re.search(r"\[  FAILED  \] (\S+)", output)
            how = "time limit" if code is None else f"signal {-code}" if code < 0 else f"exit code {code}"
            return result | {"verdict": "caught", "by": f"{test.split(':')[0]}:{failed[1].rstrip(',')}" if failed else f"{test} ({how})"}
        if fault["kind"] == "drawn":
            changed = [now[0] for now, before in zip(self.probes(fault["name"]), self.sound_probes()) if now[1:3] != before[1:3]]
            if not changed:
                return result | {"verdict": "equivalent", "by": ""}
            return result | {"verdict": "survived", "by": f"changes: {changed[0]}"}
        return result | {"verdict": "survived", "by": ""}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", type=Path, default=ROOT / "build/mutate")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--only", action="append", help="faults of this name (pattern), several times; no verdict on the whole")
    parser.add_argument("--kind", action="append", choices=["written", "drawn", "shader"], help="faults of this kind alone, several times")
    parser.add_argument("--json", type=Path, help="where the results go, after each fault; those in it of the same sources are not judged again")
    parser.add_argument("--seconds", type=float, default=1e9, help="no fault is begun after this time; a run with the same --json goes on")
    options = parser.parse_args()
    options.build = options.build.resolve()
    faults = json.loads((options.build / "mutated/faults.json").read_text())
    if options.only:
        faults = [fault for fault in faults if any(fnmatch.fnmatch(fault["name"], only) for only in options.only)]
    if options.kind:
        faults = [fault for fault in faults if fault["kind"] in options.kind]
    if not faults:
        sys.exit("mutate: no such fault")
    of_sources = digest_of(faults)
    known, baseline_s = {}, {}
    if options.json and options.json.exists():
        kept = json.loads(options.json.read_text())
        if kept.get("sources") == of_sources:
            known = {result["name"]: result for result in kept["faults"]}
            baseline_s = kept["baseline_s"]
    runner = Runner(options.build)
    runner.baseline_s |= baseline_s  # tests that a run before this one saw to pass
    printing = threading.Lock()
    start = time.monotonic()
    with ThreadPoolExecutor(options.jobs) as pool:
        tests = sorted({test for fault in faults if fault["name"] not in known for test in fault["tests"]} - set(baseline_s))
        wrong = [message for message in pool.map(runner.measure, tests) if message]
        if wrong:
            sys.exit("mutate: without a fault every test must pass\n" + "\n".join(wrong))
        print(f"mutate: {len(tests)} groups of tests pass without a fault ({time.monotonic() - start:.0f} s); {len(faults)} faults", flush=True)
        results = []

        def summarized():
            """By kind and verdict, and the fraction that is caught of those that count; the file is written."""
            def count(verdict, kind=None):
                return sum(r["verdict"] == verdict and kind in (None, r["kind"]) for r in results)

            summary = {kind: {verdict: count(verdict, kind) for verdict in ("caught", "survived", "equivalent", "invalid")}
                       for kind in [*NEEDED, "shader"] if any(r["kind"] == kind for r in results)}
            counted = count("caught") + count("survived")
            fraction = count("caught") / counted if counted else 0
            if options.json:
                options.json.parent.mkdir(parents=True, exist_ok=True)
                options.json.write_text(json.dumps({"sources": of_sources, "baseline_s": runner.baseline_s, "summary": summary, "share_caught": round(fraction, 4),
                                                    "faults": results}, indent=1) + "\n")
            return summary, counted, fraction

        def judge(fault):
            result = known.get(fault["name"])
            if not result:
                if time.monotonic() - start > options.seconds:
                    return
                result = runner.judge(fault)
            with printing:
                results.append(result)
                summarized()
                if fault["name"] not in known:
                    print(f"{result['verdict']:10} {result['name']:60} {result['by']}", flush=True)

        list(pool.map(judge, faults))
    if not results:
        sys.exit("mutate: the time is too short for a fault")
    summary, counted, fraction = summarized()
    for kind, verdicts in summary.items():
        print(f"mutate: {kind}: " + ", ".join(f"{number} {verdict}" for verdict, number in verdicts.items()))
    for result in results:
        if result["verdict"] == "survived":
            print(f"mutate: survived: {result['name']} ({', '.join(result['places'])}) {result['by']}")
    print(f"mutate: {100 * fraction:.1f} % of {counted} faults caught in {time.monotonic() - start:.0f} s")
    if len(results) < len(faults):
        print(f"mutate: {len(faults) - len(results)} faults are left: run it again")
        return 1
    if options.only or options.kind:
        return 0 if fraction >= LEAST else 1
    none = {"caught": 0, "survived": 0, "invalid": 0}
    short = [kind for kind, least in NEEDED.items() if summary.get(kind, none)["caught"] + summary.get(kind, none)["survived"] < least]
    if short or summary.get("written", none)["invalid"]:
        print(f"mutate: too few faults count: {', '.join(short) or 'a written one does not compile'}")
        return 1
    return 0 if fraction >= LEAST else 1


if __name__ == "__main__":
    sys.exit(main())
