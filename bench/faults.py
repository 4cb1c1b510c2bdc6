#!/usr/bin/env python3
"""Counts what becomes of frames when things go wrong in the middle of a sequence: kill -9 at random moments, a full disk, a
Vulkan call that fails, a driver that does not start, a texture whose upload ends in the middle, two writers, folders that cannot be written, and 10,000
frames of one process. Each part ends with the bytes of an undisturbed run, or says how many frames are lost, half or
different. Exit 1 when there is one."""
import argparse
import concurrent.futures
import json
import os
import pathlib
import random
import shutil
import struct
import subprocess
import sys
import tempfile
import time
import zlib

ROOT = pathlib.Path(__file__).resolve().parents[1]
HOST_MEMORY, DEVICE_MEMORY, INITIALIZATION_FAILED, DEVICE_LOST, INCOMPATIBLE_DRIVER = -1, -2, -3, -4, -9
MAY_BE_LOST = {"vkCreateDevice", "vkQueueSubmit2", "vkWaitForFences", "vkDeviceWaitIdle", "vkGetQueryPoolResults"}
DEVICE_TOO = {"vkAllocateMemory", "vkCreateBuffer", "vkCreateImage", "vkCreateGraphicsPipelines", "vkQueueSubmit2"}


def textured_scene(folder, side_px):
    """A square whose unlit colour is a texture of that side, beside the file."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    rows = b"".join(b"\0" + bytes([y & 255, 80, 200]) * side_px for y in range(side_px))
    (folder / "texture.png").write_bytes(
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", side_px, side_px, 8, 2, 0, 0, 0)) +
        chunk(b"IDAT", zlib.compress(rows, 1)) + chunk(b"IEND", b""))
    corners = struct.pack("<12f8f", -1, -1, 0, 1, -1, 0, -1, 1, 0, 1, 1, 0, 0, 1, 1, 1, 0, 0, 1, 0)
    (folder / "square.bin").write_bytes(corners + struct.pack("<6H", 0, 1, 2, 2, 1, 3))
    views = [(0, 48), (48, 32), (80, 12)]
    (folder / "square.gltf").write_text(json.dumps({
        "asset": {"version": "2.0"}, "extensionsUsed": ["KHR_materials_unlit"], "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}], "textures": [{"source": 0}], "images": [{"uri": "texture.png"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}],
        "materials": [{"extensions": {"KHR_materials_unlit": {}},
                       "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        "buffers": [{"uri": "square.bin", "byteLength": 92}],
        "bufferViews": [{"buffer": 0, "byteOffset": at, "byteLength": size} for at, size in views],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [-1, -1, 0],
                       "max": [1, 1, 0]},
                      {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
                      {"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"}]}))
    return folder / "square.gltf"


class Faults:
    def __init__(self, options):
        self.options = options
        self.base = pathlib.Path(tempfile.mkdtemp(prefix="candela-faults-"))
        self.random = random.Random(options.seed)
        self.count = options.frames
        started = time.monotonic()
        self.check(self.run("plain"), 0, "the undisturbed run")
        self.seconds = time.monotonic() - started
        self.plain = self.contents("plain")

    def words(self, folder, *more, frames=None):
        to = pathlib.Path(folder) if str(folder).startswith("/") else self.base / folder
        return [self.options.program, "sequence", str(ROOT / "scenes/animated/animated.glb"), "--frames",
                f"0-{(frames or self.count) - 1}", "--size", "64x36", "--device", self.options.device, "--quiet",
                "-o", str(to / "%05d.exr"), "-o", str(to / "%05d.png"), *more]

    def run(self, folder, *more, environment=None, seconds=300, frames=None):
        try:
            return subprocess.run(self.words(folder, *more, frames=frames), capture_output=True, text=True, timeout=seconds,
                                  env={**os.environ, **(environment or {})})
        except subprocess.TimeoutExpired as late:
            return subprocess.CompletedProcess(late.cmd, "hangs", "", str(late.stderr))

    def contents(self, folder, temporary=False):
        to = pathlib.Path(folder) if str(folder).startswith("/") else self.base / folder
        if not to.exists():
            return {}
        return {path.name: path.read_bytes() for path in to.iterdir()
                if path.is_file() and path.name.startswith(".") == temporary}

    def check(self, ended, code, what):
        if ended.returncode != code:
            raise SystemExit(f"{what}: exit {ended.returncode}, not {code}\n{ended.stderr}")

    # Files that are there and not what they should be; `all_there`: and those that are not there.
    def wrong(self, folder, all_there=False):
        there = self.contents(folder)
        different = sum(data != self.plain.get(name) for name, data in there.items())
        return different, len(set(self.plain) - set(there)) if all_there else 0

    def clear(self, folder):
        shutil.rmtree(self.base / folder, ignore_errors=True)

    def result(self, tries, different, lost, **more):
        return {"tries": tries, "lost": lost, "different_or_half": different, **more}

    def side_by_side(self, work, items):
        with concurrent.futures.ThreadPoolExecutor(self.options.jobs) as pool:
            return list(pool.map(work, items))

    def kills(self, tries):
        """Kills and goes on, in one folder after another, until each frame is there."""
        jobs = self.options.jobs
        parts = self.side_by_side(lambda i: self.kills_in(f"kills{i}", (tries + jobs - 1 - i) // jobs, self.options.seed + i),
                                  range(jobs))
        killed, different, lost, finished, temporary = (sum(column) for column in zip(*parts))
        return self.result(killed, different, lost, finished=finished, temporary_files_left=temporary)

    def kills_in(self, folder, tries, seed):
        chance = random.Random(seed)
        different = lost = killed = finished = temporary = 0
        while True:
            process = subprocess.Popen(self.words(folder, "--resume"), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            try:
                code = process.wait(chance.uniform(0.02, self.seconds) if killed < tries else None)
            except subprocess.TimeoutExpired:
                process.kill()
                code = process.wait()
            killed += code == -9
            bad, gone = self.wrong(folder, all_there=code == 0)
            different, lost = different + bad, lost + gone
            if code == 0:
                finished += 1
                temporary += len(self.contents(folder, temporary=True))
                self.clear(folder)
                if killed == tries:
                    return killed, different, lost, finished, temporary
            elif code != -9:
                raise SystemExit(f"kills: exit {code}")

    def disks(self, tries):
        if os.geteuid() != 0:
            return {"skipped": "only root can make a small file system"}
        size = sum(len(data) + 4096 for data in self.plain.values())
        different = lost = full = 0
        codes = {}
        for _ in range(tries):
            disk = self.base / "disk"
            disk.mkdir(exist_ok=True)
            bytes_ = self.random.randrange(4096, size)
            if subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={bytes_}", "candela", disk]).returncode != 0:
                return {"skipped": "tmpfs cannot be mounted here"}
            try:
                ended = self.run(disk)
                codes[ended.returncode] = codes.get(ended.returncode, 0) + 1
                full += ended.returncode == 5
                bad, _ = self.wrong(disk)
                bad += len(self.contents(disk, temporary=True))
                subprocess.run(["mount", "-o", f"remount,size={4 * size}", disk], check=True)
                self.check(self.run(disk, "--resume"), 0, "with room again")
                again, gone = self.wrong(disk, all_there=True)
                different, lost = different + bad + again, lost + gone
            finally:
                subprocess.run(["umount", disk], check=True)
        return self.result(tries, different, lost, full=full, exit_codes=codes)

    def vulkan(self, step):
        if not self.options.layer:
            return {"skipped": "no --layer"}
        layer = {"VK_LAYER_PATH": self.options.layer, "VK_INSTANCE_LAYERS": "VK_LAYER_CANDELA_fault"}
        names_file = self.base / "calls"
        self.check(self.run("vulkan", environment={**layer, "FAULT_LIST": str(names_file)}, frames=4), 0, "the layer alone")
        names = names_file.read_text().split()
        self.clear("vulkan")
        # By function and number of its call: threads work side by side, so the order of all calls differs between runs.
        faults = []
        for name in sorted(set(names)):
            for at in range(1, names.count(name) + 1):
                faults.append((at, name, HOST_MEMORY))
                if name in DEVICE_TOO:
                    faults.append((at, name, DEVICE_MEMORY))
                if name in MAY_BE_LOST:
                    faults.append((at, name, DEVICE_LOST))
        if step > 1:  # the first call of each function, and some others
            faults = [fault for i, fault in enumerate(faults) if fault[0] == 1 or i % step == 0]
        different = lost = not_reached = 0
        wrong_codes, wrong_files, codes = [], [], {}

        def one(fault):
            at, name, result = fault
            folder = f"vulkan{name}{at}{result}"
            ended = self.run(folder, environment={**layer, "FAULT_NAME": name, "FAULT_AT": str(at),
                                                  "FAULT_RESULT": str(result)}, frames=4, seconds=120)
            there, temporary = self.contents(folder), self.contents(folder, temporary=True)
            self.clear(folder)
            return fault, ended, there, temporary

        for (at, name, result), ended, there, temporary in self.side_by_side(one, faults):
            codes[str(ended.returncode)] = codes.get(str(ended.returncode), 0) + 1
            # What a frame does not need may fail: the frame is then made all the same. A run that needs fewer calls than
            # the first one did, because frames finish at other moments, does not come to its fault.
            expected = 4 if result == DEVICE_LOST else 6
            not_reached += "fault:" not in ended.stderr
            if ended.returncode not in (0, expected) or not_reached > len(faults) // 20:
                wrong_codes.append({"call": at, "function": name, "result": result, "exit": ended.returncode,
                                    "stderr": ended.stderr[-300:]})
            if ended.returncode == 0:
                lost += 8 - len(there)
            bad = sum(data != self.plain.get(file) for file, data in there.items()) + len(temporary)
            different += bad
            if bad > 0:
                wrong_files.append({"call": at, "function": name, "result": result, "exit": ended.returncode, "files": bad})
        return self.result(len(faults), different, lost, calls=len(names), functions=len(set(names)), exit_codes=codes,
                           not_reached=not_reached, wrong_exit_codes=wrong_codes, wrong_files=wrong_files)

    def starts(self, _):
        """Vulkan that does not start is told from Vulkan that is not installed; and a process that draws many settings opens
        one instance and one device."""
        if not self.options.layer:
            return {"skipped": "no --layer"}
        layer = {"VK_LAYER_PATH": self.options.layer, "VK_INSTANCE_LAYERS": "VK_LAYER_CANDELA_fault"}
        scene, names_file = ROOT / "scenes/unlit-box/unlit-box.glb", self.base / "calls"

        def candela(words, environment):
            return subprocess.run([self.options.program, *map(str, words)], capture_output=True, text=True,
                                  env={**os.environ, **environment})

        draw = ["render", scene, "--size", "16x9", "--device", self.options.device, "-o", self.base / "starts.png"]
        self.check(candela(draw, {**layer, "FAULT_LIST": str(names_file)}), 0, "the layer alone")
        names = names_file.read_text().split()
        wrong, tries = [], 0
        for name in ("vkCreateInstance", "vkEnumeratePhysicalDevices", "vkEnumerateDeviceExtensionProperties",
                     "vkGetPhysicalDeviceImageFormatProperties", "vkCreateDevice"):
            for result, code in ((HOST_MEMORY, 6), (INITIALIZATION_FAILED, 4), (INCOMPATIBLE_DRIVER, 4)):
                # The last one: the loader asks too, before the program.
                ended = candela(draw, {**layer, "FAULT_NAME": name, "FAULT_AT": str(names.count(name)),
                                       "FAULT_RESULT": str(result)})
                tries += 1
                if ended.returncode != code or "no Vulkan driver found" in ended.stderr:
                    wrong.append({"function": name, "result": result, "exit": ended.returncode, "stderr": ended.stderr[-300:]})
        (self.base / "starts.png").unlink(missing_ok=True)
        absent = candela(draw, {"VK_DRIVER_FILES": "/nonexistent", "VK_ICD_FILENAMES": "/nonexistent"})
        if absent.returncode != 4 or "no Vulkan driver found; install" not in absent.stderr:
            wrong.append({"function": "none", "exit": absent.returncode, "stderr": absent.stderr[-300:]})
        many = candela(["bench", scene, "--techniques", "clustered,brute-force,deferred-clustered", "--size", "16x9", "--quality",
                        "draft,normal", "--samples", "1,4", "--min-runs", "1", "--max-runs", "1", "--warm-up-s", "0.001",
                        "--max-sessions", "2", "--device", self.options.device, "--json", "-"],
                       {**layer, "FAULT_LIST": str(names_file)})
        self.check(many, 0, "twelve settings")
        rows = len(json.loads(many.stdout)["rows"])
        opened = {name: names_file.read_text().split().count(name) for name in ("vkCreateInstance", "vkCreateDevice")}
        if rows < 12 or any(count != 1 for count in opened.values()):
            wrong.append({"rows": rows, **opened})
        return self.result(tries + 2, 0, 0, wrong_exit_codes=wrong)

    def uploads(self, step):
        """A texture larger than the staging buffer, and each call between its creation and the end of its upload that
        fails: the error names the file, and no picture is left."""
        if not self.options.layer:
            return {"skipped": "no --layer"}
        scene = textured_scene(self.base, 2048)
        # Other threads make pipelines meanwhile: only calls of the thread that uploads are counted.
        layer = {"VK_LAYER_PATH": self.options.layer, "VK_INSTANCE_LAYERS": "VK_LAYER_CANDELA_fault",
                 "FAULT_FROM": "vkCreateImage"}

        def draw(folder, environment):
            to = self.base / folder
            ended = subprocess.run([self.options.program, "render", scene, "--size", "64x36", "--device", self.options.device,
                                    "--quiet", "-o", to / "a.exr", "-o", to / "a.png"], capture_output=True, text=True,
                                   timeout=120, env={**os.environ, **layer, **environment})
            files = len(self.contents(folder)) + len(self.contents(folder, temporary=True))
            self.clear(folder)
            return ended, files

        names_file = self.base / "calls"
        self.check(draw("uploads", {"FAULT_LIST": str(names_file)})[0], 0, "the layer alone")
        names = names_file.read_text().split()
        last = names.index("vkResetFences")  # staging is full: the texture is uploaded in two parts
        faults = [(at + 1, names[at], result) for at in range(last + 1)
                  for result in [HOST_MEMORY] + [DEVICE_LOST] * (names[at] in MAY_BE_LOST) +
                  [DEVICE_MEMORY] * (names[at] in DEVICE_TOO)][::step]
        ends = self.side_by_side(lambda fault: (fault, *draw(f"uploads{fault[0]}{fault[2]}", {
            "FAULT_AT": str(fault[0]), "FAULT_RESULT": str(fault[2])})), faults)
        half, wrong_codes = 0, []
        for (at, name, result), ended, files in ends:
            half += files
            if ended.returncode != (4 if result == DEVICE_LOST else 6) or "square.gltf: /images/0: " not in ended.stderr:
                wrong_codes.append({"call": at, "function": name, "result": result, "exit": ended.returncode,
                                    "stderr": ended.stderr[-300:]})
        return self.result(len(faults), half, 0, calls=last + 1, wrong_exit_codes=wrong_codes)

    def writers(self, tries):
        different = lost = 0
        for _ in range(tries):
            pair = [subprocess.Popen(self.words("writers"), stderr=subprocess.PIPE, text=True) for _ in range(2)]
            for one in pair:
                errors = one.communicate()[1]
                if one.returncode != 0:
                    raise SystemExit(f"two writers: exit {one.returncode}\n{errors}")
            bad, gone = self.wrong("writers", all_there=True)
            different, lost = different + bad + len(self.contents("writers", temporary=True)), lost + gone
            self.clear("writers")
        return self.result(tries, different, lost)

    def read_only(self, tries):
        if os.geteuid() != 0:
            return {"skipped": "only root can mount"}
        disk = self.base / "ro"
        disk.mkdir(exist_ok=True)
        different = lost = refused = 0
        for i in range(tries):
            if subprocess.run(["mount", "-t", "tmpfs", "candela", disk]).returncode != 0:
                return {"skipped": "tmpfs cannot be mounted here"}
            try:
                process = None
                if i % 2 == 1:  # in the middle
                    process = subprocess.Popen(self.words(disk), stderr=subprocess.PIPE, text=True)
                    while process.poll() is None and len(list(disk.iterdir())) < 4:
                        time.sleep(0.002)
                mounted = subprocess.run(["mount", "-o", "remount,ro", disk], capture_output=True).returncode == 0
                if process is None:
                    process = subprocess.Popen(self.words(disk), stderr=subprocess.PIPE, text=True)
                errors = process.communicate()[1]
                refused += process.returncode == 5
                if process.returncode != 5 and mounted and i % 2 == 0:
                    raise SystemExit(f"read-only: exit {process.returncode}\n{errors}")
                bad, _ = self.wrong(disk)
                subprocess.run(["mount", "-o", "remount,rw", disk], check=True)
                self.check(self.run(disk, "--resume"), 0, "writable again")
                again, gone = self.wrong(disk, all_there=True)
                different, lost = different + bad + again, lost + gone
            finally:
                subprocess.run(["umount", disk], check=True)
        return self.result(tries, different, lost, refused=refused)

    def soak(self, frames):
        process = subprocess.Popen(self.words("soak", frames=frames), stderr=subprocess.PIPE, text=True)
        samples = []
        started = time.monotonic()
        while process.poll() is None:
            try:
                status = pathlib.Path(f"/proc/{process.pid}/status").read_text()
                resident = int(status.split("VmRSS:")[1].split()[0])
                threads = int(status.split("Threads:")[1].split()[0])
                handles = len(os.listdir(f"/proc/{process.pid}/fd"))
                samples.append((resident, handles, threads))
            except (OSError, IndexError):
                pass
            time.sleep(max(0.02, min(1, frames / 10000)))
        seconds = time.monotonic() - started
        if process.returncode != 0:
            raise SystemExit(f"soak: exit {process.returncode}\n{process.stderr.read()}")
        there = self.contents("soak")
        bad = sum(data != there[name] for name, data in self.plain.items())
        quarter = max(1, len(samples) // 4)
        middle = lambda part, column: sorted(sample[column] for sample in part)[len(part) // 2]
        second, last = samples[quarter:2 * quarter] or samples, samples[-quarter:]
        growth = {name: middle(last, i) - middle(second, i) for i, name in
                  enumerate(("resident_kib", "handles", "threads"))}
        result = self.result(frames, bad, 2 * frames - len(there), seconds=round(seconds, 1), samples=len(samples),
                             resident_kib=middle(last, 0), handles=middle(last, 1), threads=middle(last, 2),
                             growth_from_second_to_last_quarter=growth)
        # Twenty frames of 64x36 in four bytes a channel are 1 MiB.
        result["flat"] = growth["resident_kib"] < 4096 and growth["handles"] <= 0 and growth["threads"] <= 0
        self.clear("soak")
        return result


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", default=str(ROOT / "build/release/candela"))
    parser.add_argument("--layer", default=str(ROOT / "build/release/tests/faults"), help="folder of the layer that fails calls")
    parser.add_argument("--device", default="cpu")
    parser.add_argument("--frames", type=int, default=12)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=1, help="runs side by side, of kills and of failing calls")
    parser.add_argument("--soak", type=int, default=10000)
    parser.add_argument("--only", default="kills,disks,vulkan,starts,uploads,writers,read_only,soak")
    parser.add_argument("--quick", action="store_true", help="a few of each, as a test")
    parser.add_argument("--json")
    options = parser.parse_args()
    few = options.quick
    faults = Faults(options)
    parts = {"kills": 6 if few else 200, "disks": 3 if few else 50, "vulkan": 40 if few else 1, "starts": 0, "uploads": 2 if few else 1, "writers": 1 if few else 20,
             "read_only": 2 if few else 20, "soak": 150 if few else options.soak}
    results, failed = {}, False
    try:
        for name in options.only.split(","):
            started = time.monotonic()
            result = results[name] = getattr(faults, name)(parts[name])
            print(f"{name}: {json.dumps(result)} ({time.monotonic() - started:.0f} s)", flush=True)
            failed |= any(result.get(key) for key in ("lost", "different_or_half", "wrong_exit_codes", "temporary_files_left"))
            failed |= not few and result.get("flat") is False
    finally:
        shutil.rmtree(faults.base, ignore_errors=True)
    if options.json:
        devices = subprocess.run([options.program, "list", "devices", "--json"], capture_output=True, text=True).stdout
        old = json.loads(pathlib.Path(options.json).read_text()) if os.path.exists(options.json) else {}
        old.update({"devices": json.loads(devices), "frames": options.frames, "files_a_frame": 2, "seed": options.seed})
        old.setdefault("results", {}).update(results)
        pathlib.Path(options.json).write_text(json.dumps(old, indent=2) + "\n")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
