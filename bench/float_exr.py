"""EXR files of scanlines without compression, of floats and integers, as `--exr-type float --exr-compression none` writes them."""
import array
import struct


def read_exr(path):
    """Its channels by name, row by row, as floats or integers, and width and height."""
    data = path.read_bytes()
    at, channels, window = 8, [], None

    def text(at):
        end = data.index(b"\0", at)
        return data[at:end].decode(), end + 1

    while data[at]:
        name, at = text(at)
        _, at = text(at)
        size = struct.unpack_from("<i", data, at)[0]
        at += 4
        if name == "compression":
            assert data[at] == 0, f"{path} is compressed"
        if name == "dataWindow":
            window = struct.unpack_from("<4i", data, at)
        if name == "channels":
            inner = at
            while data[inner]:
                channel, inner = text(inner)
                channels.append((channel, struct.unpack_from("<i", data, inner)[0]))
                inner += 16
        at += size
    width, height = window[2] - window[0] + 1, window[3] - window[1] + 1
    at += 1 + 8 * height
    planes = {name: array.array({0: "I", 1: "H", 2: "f"}[kind]) for name, kind in channels}
    for _ in range(height):
        at += 8
        for name, kind in channels:
            size = width * (2 if kind == 1 else 4)
            planes[name].frombytes(data[at:at + size])
            at += size
    assert all(kind != 1 for _, kind in channels), f"{path} holds halves"
    return planes, width, height
