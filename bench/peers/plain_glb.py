"""A generated scene without extensions that other programs lack: each instance of a mesh or of a light becomes a node."""
import json
import math
import struct

COUNTS = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}


def rotation_to(direction):
    """Quaternion that turns -Z, along which lights shine, to the unit direction."""
    x, y, z = direction
    w = 1 - z
    if w < 1e-6:
        return [0, 1, 0, 0]
    length = math.sqrt(x * x + y * y + w * w)
    return [y / length, -x / length, 0, w / length]


def write_plain(source, target):
    """From GLB file to GLB file. Modulations of lights are left out."""
    data = open(source, "rb").read()
    size = struct.unpack_from("<I", data, 12)[0]
    document, rest = json.loads(data[20:20 + size]), data[20 + size:]
    binary = rest[8:]

    def values(index):
        accessor = document["accessors"][index]
        view = document["bufferViews"][accessor["bufferView"]]
        at = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        width = COUNTS[accessor["type"]]
        return [list(v) for v in struct.iter_unpack(f"<{width}f", binary[at:at + 4 * width * accessor["count"]])]

    nodes = document["nodes"]
    lights = document.get("extensions", {}).get("KHR_lights_punctual", {}).get("lights", [])
    plain_lights = []
    for node in list(nodes):
        extensions = node.get("extensions", {})
        made = extensions.pop("EXT_mesh_gpu_instancing", None) or extensions.pop("CANDELA_light_instances", None)
        if not made:
            continue
        columns = {name: values(index) for name, index in made["attributes"].items()}
        mesh = node.pop("mesh", None)
        for i in range(len(columns["TRANSLATION"])):
            of = {name: column[i] for name, column in columns.items()}
            child = {name.lower(): of[name] for name in ("TRANSLATION", "ROTATION", "SCALE") if name in of}
            if mesh is not None:
                child["mesh"] = mesh
            else:
                light = dict(lights[made["light"]])
                light.update({name.lower(): of[name] for name in ("COLOR",) if name in of})
                light.update({name.lower(): of[name][0] for name in ("INTENSITY", "RANGE") if name in of})
                if "DIRECTION" in of:
                    child["rotation"] = rotation_to(of["DIRECTION"])
                child["extensions"] = {"KHR_lights_punctual": {"light": len(plain_lights)}}
                plain_lights.append(light)
            node.setdefault("children", []).append(len(nodes))
            nodes.append(child)
        if not extensions:
            node.pop("extensions", None)
    document["extensions"] = {"KHR_lights_punctual": {"lights": plain_lights}}
    for key in ("extensionsUsed", "extensionsRequired"):
        if key in document:
            document[key] = [e for e in document[key] if e not in ("EXT_mesh_gpu_instancing", "CANDELA_light_instances")]
    document = {key: value for key, value in document.items() if value != []}
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    with open(target, "wb") as file:
        file.write(data[:8] + struct.pack("<III", 20 + len(text) + len(rest), len(text), 0x4E4F534A) + text + rest)


def plain(bench, scene, lights):
    """The file of a generated scene, for a lights.Bench."""
    file = bench.work / f"plain-{scene}-{lights}.glb"
    if not file.exists():
        write_plain(bench.scene(scene, lights), file)
    return str(file)
