#!/usr/bin/env python3
"""Candela against Filament: the time of a frame against the number of lights, and from process to file.

usage: bench/peers/lights.py [--build DIR] [--scenes NAME|FILE,...] [--lights N,...] [--samples N,...] [--caches NAME,...]
                             [--techniques NAME,...] [--tables NAME,...] [--start-lights N] [--runs N] [--cold-runs N]
                             [--pictures DIR] [-o FILE.json]

Needs a build with -DCANDELA_BENCH_PEERS=ON. Every program draws one frame in turn (candela, Filament, candela, ...),
each at a later time of the scene, so that the lights move and a machine that slows down slows all. See bench/README.md.
"""
import argparse
import json
import math
import os
import pathlib
import resource
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
FIRST_TIME_S, FRAME_RATE = 0.5, 24
FILAMENT_CAP = 256
PASS_LIGHTS = (1, 256, 1024, 4096)
WARM_UP_FRAMES = 4

NOTES = [
    "Wall time of a frame: posing the scene, moving lights and cars, drawing, 8-bit sRGB pixels in host memory. One frame"
    " is in flight; both wait for it.",
    "Both: linear tone mapping, sRGB, no dither, no shadows, no ambient occlusion. Filament: no FXAA, bloom or fog, lit"
    " metallic-roughness material with vertex colours and emissive texture (matc), distance of lights as far as they reach.",
    "Known differences of the pictures: Filament squares the window that ends a light's range and does not weaken diffuse"
    " light by the Fresnel term; so it is darker near the ends of lights.",
    "Filament 1.9 draws the 256 lights nearest to the camera and drops the others: beyond 256 its time is of another picture.",
]


def say(text):
    print(text, file=sys.stderr, flush=True)


def summary(samples):
    middle = statistics.median(samples)
    return {
        "median": round(middle, 3),
        "min": round(min(samples), 3),
        "mad": round(statistics.median(abs(x - middle) for x in samples), 3),
        "count": len(samples),
        "samples": [round(x, 3) for x in samples],
    }


def medians(samples):
    """Of a list of {name: ms}: {name: median}, in the order of first appearance."""
    names = dict.fromkeys(name for sample in samples for name in sample)
    return {name: round(statistics.median(sample.get(name, 0) for sample in samples), 3) for name in names}


def ratio(samples, of):
    """Round by round, which the machine's drift does not touch."""
    return {k: v for k, v in summary([a / b for a, b in zip(samples, of)]).items() if k in ("median", "mad")}


def processor_ms():
    """User and system time of all programs that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return (used.ru_utime + used.ru_stime) * 1000


def ratio_of_pairs(samples, of):
    """Of runs in turn: the median of the quotients, and between which of them it lies in 95 % of all cases or more."""
    quotients = sorted(a / b for a, b in zip(samples, of))
    n, outside, k = len(quotients), 0.5 ** len(quotients), 0
    while k + 1 < n // 2:  # of n signs, at most k + 1 are on one side
        more = outside + math.comb(n, k + 1) * 0.5 ** n
        if 2 * more > 0.05:
            break
        outside, k = more, k + 1
    return {"median": round(statistics.median(quotients), 3), "low": round(quotients[k], 3), "high": round(quotients[n - 1 - k], 3),
            "certainty": round(1 - 2 * outside, 3)}


class Server:
    """A program of frame_server.h."""

    def __init__(self, command, environment):
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                        stderr=subprocess.DEVNULL, text=True, env=environment)
        self.about = self.answer()

    def answer(self):
        # Filament logs to stdout, too.
        for line in self.process.stdout:
            if line.startswith("{"):
                return json.loads(line)
        raise SystemExit(f"{self.process.args[0]} ended with {self.process.wait()}; run it by hand to see why")

    def processor_ms(self):
        """Of all its threads that still run, so far."""
        tasks = pathlib.Path(f"/proc/{self.process.pid}/task").glob("*/schedstat")
        return sum(int(task.read_text().split()[0]) for task in tasks) / 1e6

    def ask(self, request):
        self.process.stdin.write(request + "\n")
        self.process.stdin.flush()
        return self.answer()

    def close(self):
        self.process.stdin.close()
        self.process.wait()


class Bench:
    def __init__(self, options, work):
        self.options, self.work = options, work
        self.build = pathlib.Path(options.build)
        self.environment = dict(os.environ)
        for name in ("CANDELA_CACHE_DIR", "MESA_SHADER_CACHE_DIR"):
            if name not in self.environment:
                self.environment[name] = str(work / name.lower())
        # Filament takes the first device there is; candela is told to take the processor.
        self.environment.setdefault("VK_LOADER_DRIVERS_SELECT", "lvp_icd*")

    def program(self, name):
        return str(self.build / name)

    def run(self, *command, environment=None):
        done = subprocess.run(command, env=environment or self.environment, capture_output=True, text=True)
        if done.returncode:
            raise SystemExit(f"{' '.join(command)}\n{done.stderr}")
        return done.stdout

    def scene(self, of, lights):
        """A generated scene by its name, of that many lights (None: its own), or a file as it is."""
        if pathlib.Path(of).suffix in (".glb", ".gltf"):
            return of
        file = self.work / f"{of}-{lights}.glb"
        if not file.exists():
            count = [] if lights is None else ["--lights", str(lights)]
            self.run(self.program("candela"), "make-scene", of, *count, "--seed", "1", "-o", str(file))
        return str(file)

    def candela(self, case, lights, technique, *more):
        return Server([self.program("candela_lights"), self.scene(case.scene, lights), "--size", self.options.size,
                       "--samples", str(case.samples), "--technique", technique, "--device", "cpu", *more], self.environment)

    def filament(self, case, lights, *more):
        return Server([self.program("filament_lights"), self.scene(case.scene, lights), "--size", self.options.size,
                       "--samples", str(case.samples), *more], self.environment)

    def picture_file(self, *names):
        """One word: the servers read the path up to a space."""
        folder = pathlib.Path(self.options.pictures or self.work)
        folder.mkdir(parents=True, exist_ok=True)
        return str(folder / ("-".join(map(str, names)) + ".png").replace(" ", "-"))

    def picture(self, server, *names):
        """A server's picture at the first time."""
        file = self.picture_file(*names)
        server.ask(f"frame {FIRST_TIME_S}")
        server.ask(f"save {file}")
        return file

    def apart(self, picture, truth):
        out = self.run(self.program("candela"), "compare", picture, truth, "--json")
        metrics = json.loads(out)["metrics"]
        return {name: round(metrics[name], 5) for name in ("flip", "psnr", "ssim")}

    def pictures(self, case, servers, lights):
        """How far Filament's picture is from candela's at the first time."""
        files = {name: self.picture(server, case.name, name, lights) for name, server in servers.items()}
        return self.apart(files["filament"], next(iter(files.values())))

    def in_turn(self, servers):
        """Wall ms, processor ms and candela's stages of frames that the servers draw in turn, each later than the one before."""
        samples, busy, stages = ({name: [] for name in servers} for _ in range(3))
        for i in range(WARM_UP_FRAMES + self.options.runs):
            for name, server in servers.items():
                before = server.processor_ms()
                answer = server.ask(f"frame {FIRST_TIME_S + i / FRAME_RATE}")
                if i >= WARM_UP_FRAMES:
                    samples[name].append(answer["ms"])
                    busy[name].append(server.processor_ms() - before)
                    stages[name].append(answer["cpu_ms"])
        return samples, busy, stages

    def frames(self, case, lights, result):
        servers = {f"candela {t}": self.candela(case, lights, t) for t in self.options.techniques.split(",")}
        if lights is None or lights <= 4 * FILAMENT_CAP:
            servers["filament"] = self.filament(case, lights)
        for server in servers.values():
            result["programs"].setdefault(server.about["program"], server.about)
        row = {"lights": lights, "ms": {}}
        if "filament" in servers:
            row["pictures"] = self.pictures(case, servers, lights)
        samples, busy, stages = self.in_turn(servers)
        for server in servers.values():
            server.close()
        row["ms"] = {name: summary(values) for name, values in samples.items()}
        row["processor_ms"] = {name: summary(values) for name, values in busy.items()}
        row["cpu_ms"] = {name: medians(values) for name, values in stages.items()}
        first = next(iter(servers))
        if "filament" in servers:
            row["candela_to_filament"] = ratio(samples[first], samples["filament"])
            row["candela_to_filament_processor"] = ratio(busy[first], busy["filament"])
            if lights is not None and lights > FILAMENT_CAP:
                row["note"] = f"Filament draws {FILAMENT_CAP} of {lights} lights: its picture is wrong"
        say(f"{case.name}, {lights or 'its own'} lights: " + ", ".join(f"{n} {s['median']:.1f} ± {s['mad']:.1f} ms" for n, s in row["ms"].items()) +
            f", ratio {row.get('candela_to_filament', '-')}, of processor time {row.get('candela_to_filament_processor', '-')}")
        return row

    def passes(self, case, lights):
        """Of candela alone: each pass in a submission of its own, so that the sum is more than the frame takes above."""
        server = self.candela(case, lights, self.options.techniques.split(",")[0], "--passes")
        answers = [server.ask(f"frame {FIRST_TIME_S + i / FRAME_RATE}") for i in range(WARM_UP_FRAMES + self.options.runs)]
        server.close()
        row = {"lights": lights, "pass_ms": medians([a["pass_ms"] for a in answers[WARM_UP_FRAMES:]])}
        say(f"{case.name}, {lights or 'its own'} lights, by pass: {row['pass_ms']}")
        return row

    def start(self, case, lights, caches):
        """Process to file: with warm shader caches, or with empty ones for each run."""
        scene, time_s = self.scene(case.scene, lights), str(FIRST_TIME_S)
        render = [self.program("candela"), "render", scene, "--time", time_s, "--size", self.options.size, "--device", "cpu", "--effects", "none",
                  "--set", f"resolve.samples={case.samples}", "--json"]
        commands = {
            "candela to EXR": [*render, "-o", str(self.work / "cold.exr")],
            "candela to PNG": [*render, "-o", str(self.work / "cold.png")],
            "filament to PNG": [self.program("filament_lights"), scene, "--time", time_s, "--size", self.options.size,
                                "--samples", str(case.samples), "-o", str(self.work / "peer.png")],
        }
        walls, processors, stages = ({name: [] for name in commands} for _ in range(3))
        for i in range(1 + self.options.cold_runs):
            for name, command in commands.items():
                environment = dict(self.environment)
                with tempfile.TemporaryDirectory(dir=self.work) as empty:
                    if caches == "empty":
                        environment.update(CANDELA_CACHE_DIR=empty + "/candela", MESA_SHADER_CACHE_DIR=empty + "/mesa")
                    start, busy = time.monotonic(), processor_ms()
                    out = self.run(*command, environment=environment)
                    ms, busy = (time.monotonic() - start) * 1000, processor_ms() - busy
                if i == 0:
                    continue
                walls[name].append(ms)
                processors[name].append(busy)
                if name.startswith("candela"):
                    timings = json.loads(out)["timings"]
                    stages[name].append({**timings["cpu_ms"], "process": timings["process_ms"]})
        row = {"lights": lights, "caches": caches, "wall_ms": {name: summary(values) for name, values in walls.items()},
               "processor_ms": {name: summary(values) for name, values in processors.items()},
               "candela_to_filament": ratio_of_pairs(walls["candela to PNG"], walls["filament to PNG"]),
               "candela_to_filament_processor": ratio_of_pairs(processors["candela to PNG"], processors["filament to PNG"]),
               "candela_stages_ms": {name: medians(values) for name, values in stages.items() if values}}
        say(f"{case.name}, process to file, {caches} caches: " +
            ", ".join(f"{n} {s['median']:.0f} ± {s['mad']:.0f} ms" for n, s in row["wall_ms"].items()) +
            f", ratio {row['candela_to_filament']}, of processor time {row['candela_to_filament_processor']}")
        return row

    def measure(self, case, result):
        """Frames, passes and starts of a scene at one number of samples; each a table of its own."""
        generated = pathlib.Path(case.scene).suffix not in (".glb", ".gltf")
        lights = [int(n) for n in self.options.lights.split(",")] if generated else [None]
        of_passes = [n for n in PASS_LIGHTS if n in lights] if generated else [None]
        of_start = self.options.start_lights if generated else None
        tables = {"frames": lambda: [self.frames(case, n, result) for n in lights],
                  "passes": lambda: [self.passes(case, n) for n in of_passes],
                  "start": lambda: [self.start(case, of_start, caches) for caches in self.options.caches.split(",")]}
        return {"scene": case.scene if generated else pathlib.Path(case.scene).stem, "samples": case.samples,
                **{name: tables[name]() for name in self.options.tables.split(",")}}


class Case:
    """A scene at a number of samples a pixel."""

    def __init__(self, scene, samples):
        self.scene, self.samples = scene, samples
        self.name = f"{pathlib.Path(scene).stem} at {samples}x"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--build", default=str(ROOT / "build/release"))
    parser.add_argument("--scenes", default="street", help="generated scenes by name, or files")
    parser.add_argument("--lights", default="1,4,16,64,256,1024,4096", help="of generated scenes")
    parser.add_argument("--techniques", default="clustered", help="of candela; ratios are of the first")
    parser.add_argument("--size", default="1280x720")
    parser.add_argument("--samples", default="4,1", help="a pixel")
    parser.add_argument("--caches", default="warm,empty", help="of shaders, for the time from process to file")
    parser.add_argument("--tables", default="frames,passes,start")
    parser.add_argument("--start-lights", type=int, default=1024, help="of generated scenes, from process to file")
    parser.add_argument("--runs", type=int, default=21)
    parser.add_argument("--cold-runs", type=int, default=9)
    parser.add_argument("--pictures", help="keep both programs' pictures in this folder")
    parser.add_argument("-o", "--output", default=str(ROOT / "bench/results/lavapipe/peers.json"))
    options = parser.parse_args()
    for caches in options.caches.split(","):
        if caches not in ("warm", "empty"):
            parser.error(f"--caches: '{caches}' is neither warm nor empty")
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(options, pathlib.Path(folder))
        result = {"what": "candela against Filament, lights moving", "programs": {},
                  "cpu_cores": len(os.sched_getaffinity(0)), "size": options.size, "notes": NOTES, "cases": []}
        for scene in options.scenes.split(","):
            for samples in options.samples.split(","):
                result["cases"].append(bench.measure(Case(scene, int(samples)), result))
        result["load_average_at_end"] = round(os.getloadavg()[0], 2)
    pathlib.Path(options.output).write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()
