"""EXR files of 32-bit scanlines without compression, and 8-bit PNG: enough to compare two renderers without their libraries."""
import struct
import zlib

import numpy


def read_exr(path):
    """{channel: array[height, width]} of float channels."""
    data = open(path, "rb").read()
    magic, version = struct.unpack_from("<II", data)
    if magic != 20000630 or version & 0x1A00:
        raise SystemExit(f"{path}: not a scanline EXR of one part")
    at, attributes = 8, {}
    while data[at]:
        name, kind = (text.decode() for text in data[at:at + 512].split(b"\0", 2)[:2])
        at += len(name) + len(kind) + 2
        size = struct.unpack_from("<I", data, at)[0]
        attributes[name] = data[at + 4:at + 4 + size]
        at += 4 + size
    if attributes["compression"] != b"\0":
        raise SystemExit(f"{path}: compressed; write it without compression")
    x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    channels, rest = [], attributes["channels"]
    while rest[0]:
        name, rest = rest.split(b"\0", 1)
        channels.append((name.decode(), struct.unpack_from("<I", rest)[0]))
        rest = rest[16:]
    kinds = {0: "<u4", 1: "<f2", 2: "<f4"}
    starts = struct.unpack_from(f"<{height}Q", data, at + 1)
    planes = {name: numpy.empty((height, width), kinds[kind]) for name, kind in channels}
    for start in starts:
        y, _ = struct.unpack_from("<iI", data, start)
        place = start + 8
        for name, kind in channels:
            row = numpy.frombuffer(data, kinds[kind], width, place)
            planes[name][y - y0] = row
            place += row.nbytes
    return planes


def read_rgb(path):
    planes = read_exr(path)
    return numpy.stack([planes[c].astype(numpy.float64) for c in "RGB"], axis=-1)


def write_exr(path, planes):
    """{channel: array[height, width]} as 32-bit floats."""
    names = sorted(planes)
    height, width = planes[names[0]].shape

    def attribute(name, kind, body):
        return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<I", len(body)) + body

    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    channels = b"".join(n.encode() + b"\0" + struct.pack("<IIII", 2, 0, 1, 1) for n in names) + b"\0"
    head = struct.pack("<II", 20000630, 2) + attribute("channels", "chlist", channels) + attribute("compression", "compression", b"\0")
    head += attribute("dataWindow", "box2i", window) + attribute("displayWindow", "box2i", window)
    head += attribute("lineOrder", "lineOrder", b"\0") + attribute("pixelAspectRatio", "float", struct.pack("<f", 1))
    head += attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0)) + attribute("screenWindowWidth", "float", struct.pack("<f", 1)) + b"\0"
    rows = numpy.stack([numpy.asarray(planes[n], "<f4") for n in names], axis=1)  # height, channel, width
    size = rows[0].nbytes
    first = len(head) + 8 * height
    with open(path, "wb") as file:
        file.write(head + struct.pack(f"<{height}Q", *(first + y * (size + 8) for y in range(height))))
        for y in range(height):
            file.write(struct.pack("<iI", y, size) + rows[y].tobytes())


def write_png(path, rgb):
    """rgb[height, width, 3] in display values 0..1."""
    pixels = (numpy.clip(rgb, 0, 1) * 255 + 0.5).astype(numpy.uint8)
    height, width = pixels.shape[:2]
    rows = b"".join(b"\0" + row.tobytes() for row in pixels)

    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">2I5B", width, height, 8, 2, 0, 0, 0)) +
                   chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def display(linear):
    c = numpy.clip(linear, 0, 1)
    return numpy.where(c <= 0.0031308, 12.92 * c, 1.055 * c ** (1 / 2.4) - 0.055)
