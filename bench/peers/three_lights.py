#!/usr/bin/env python3
"""Candela against three.js in Chromium: the time of a frame of the same file, in turn. Instances are nodes in it (plain_glb.py).

usage: bench/peers/three_lights.py --three node_modules/three [--build DIR] [--scenes NAME,...] [--lights N,...] [--samples N,...]
                                   [--gl swiftshader|gl] [--runs N] [--pictures DIR] [-o FILE.json]

Needs a build with -DCANDELA_BENCH_PEERS=ON, `npm install three` in a folder of one's own, and chromium; for --gl gl a display too
(xvfb-run), and Chromium then draws by Mesa's llvmpipe, else by its own SwiftShader. See bench/README.md.
"""
import argparse
import atexit
import base64
import http.server
import json
import os
import pathlib
import queue
import subprocess
import struct
import tempfile
import threading
import zlib

import lights
import plain_glb

PAGE = pathlib.Path(__file__).with_name("three_page.html")
FLAGS = {"swiftshader": ["--headless=new", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
         "gl": ["--ozone-platform=x11", "--use-gl=angle", "--use-angle=gl", "--ignore-gpu-blocklist"]}
PATIENCE_S = 900  # for a page that compiles a shader of many lights


def write_png(file, width, height, rgba):
    """Of rows upwards, without their alpha."""
    rows = [rgba[4 * width * y:4 * width * (y + 1)] for y in reversed(range(height))]
    body = b"".join(b"\0" + b"".join(row[i:i + 3] for i in range(0, len(row), 4)) for row in rows)

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = chunk(b"IHDR", struct.pack(">2I5B", width, height, 8, 2, 0, 0, 0))
    pathlib.Path(file).write_bytes(b"\x89PNG\r\n\x1a\n" + head + chunk(b"IDAT", zlib.compress(body)) + chunk(b"IEND", b""))


class Page(http.server.BaseHTTPRequestHandler):
    """Serves the page, three.js and the scene; an answer of the page is answered with the next request."""

    def log_message(self, *_):
        pass

    def reply(self, body, kind):
        self.send_response(200 if body is not None else 404)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(body or b"")))
        self.end_headers()
        self.wfile.write(body or b"")

    def do_GET(self):
        path, server = self.path.split("?")[0], self.server
        file = {"/": PAGE, "/scene.glb": pathlib.Path(server.scene)}.get(path, server.three / path.removeprefix("/three/"))
        kind = {".html": "text/html", ".js": "text/javascript"}.get(file.suffix, "application/octet-stream")
        self.reply(file.read_bytes() if file.is_file() else None, kind)

    def do_POST(self):
        self.server.answers.put(json.loads(self.rfile.read(int(self.headers["Content-Length"]))))
        self.reply(json.dumps(self.server.requests.get()).encode(), "application/json")


class Three:
    """A browser with the page; asked like lights.Server."""

    def __init__(self, options, scene, samples, environment, work):
        self.server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Page)
        self.server.daemon_threads = True
        self.server.scene, self.server.three = scene, pathlib.Path(options.three)
        self.server.answers, self.server.requests = queue.Queue(), queue.Queue()
        threading.Thread(target=self.server.serve_forever, daemon=True).start()
        width, height = self.size = options.size.split("x")
        self.process = subprocess.Popen(
            ["chromium", "--no-sandbox", "--disable-gpu-watchdog", f"--user-data-dir={work}/chromium-{samples}", *FLAGS[options.gl],
             f"http://127.0.0.1:{self.server.server_port}/?width={width}&height={height}&samples={samples}"],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=environment, start_new_session=True)
        atexit.register(self.close)  # a browser does not end with its pipe
        self.about = self.answer()
        if self.about["errors"]:
            raise SystemExit(f"three.js cannot draw {self.about['lights']} lights here: {self.about['errors'][0]}")

    def answer(self):
        answer = self.server.answers.get(timeout=PATIENCE_S)
        if "error" in answer:
            raise SystemExit(f"three.js: {answer['error']}")
        return answer

    def processor_ms(self):
        """Of all threads of the browser's processes, so far."""
        total = 0
        for stat in pathlib.Path("/proc").glob("[0-9]*/stat"):
            try:
                if int(stat.read_text().rsplit(")", 1)[1].split()[3]) != self.process.pid:  # the session
                    continue
                total += sum(int(task.read_text().split()[0]) for task in stat.parent.glob("task/*/schedstat"))
            except (OSError, IndexError):  # ended meanwhile
                continue
        return total / 1e6

    def ask(self, request):
        command, argument = request.split()
        if command == "save":
            write_png(argument, *map(int, self.size), base64.b64decode(self.pixels))
            return {}
        self.server.requests.put({"time": float(argument), "save": True} if float(argument) == lights.FIRST_TIME_S else {"time": float(argument)})
        answer = self.answer()
        self.pixels = answer.pop("pixels", getattr(self, "pixels", ""))
        return answer | {"cpu_ms": {}}

    def close(self):
        if self.process.poll() is None:
            os.killpg(self.process.pid, 9)
            self.process.wait()
            self.server.shutdown()


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--three", required=True, help="folder of the package")
    parser.add_argument("--build", default=str(lights.ROOT / "build/release"))
    parser.add_argument("--scenes", default="street")
    parser.add_argument("--lights", default="1024")
    parser.add_argument("--size", default="1280x720")
    parser.add_argument("--samples", default="1,4")
    parser.add_argument("--gl", choices=FLAGS, default="swiftshader")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--pictures")
    parser.add_argument("-o", "--output", default=str(lights.ROOT / "bench/results/lavapipe/peers-three.json"))
    options = parser.parse_args()
    result = {"what": "candela against three.js, lights moving", "size": options.size, "gl": options.gl, "programs": {}, "cases": []}
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        bench = lights.Bench(options, pathlib.Path(folder))
        for scene in options.scenes.split(","):
            for samples in (int(n) for n in options.samples.split(",")):
                for count in (int(n) for n in options.lights.split(",")):
                    file = plain_glb.plain(bench, scene, count)
                    case = lights.Case(file, samples)
                    servers = {"candela": bench.candela(case, count, "clustered"),
                               "three": Three(options, file, samples, os.environ, folder)}
                    for name, server in servers.items():
                        result["programs"].setdefault(name, server.about)
                    apart = bench.apart(*(bench.picture(server, case.name, name, count) for name, server in servers.items()))
                    wall, busy, _ = bench.in_turn(servers)
                    for server in servers.values():
                        server.close()
                    row = {"scene": scene, "samples": samples, "lights": count, "pictures": apart,
                           "ms": {name: lights.summary(values) for name, values in wall.items()},
                           "processor_ms": {name: lights.summary(values) for name, values in busy.items()},
                           "candela_to_three": lights.ratio_of_pairs(wall["candela"], wall["three"]),
                           "candela_to_three_processor": lights.ratio_of_pairs(busy["candela"], busy["three"])}
                    result["cases"].append(row)
                    lights.say(f"{case.name}, {count} lights: {row['candela_to_three_processor']} of three.js's processor time")
    pathlib.Path(options.output).write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()
