"""The scenes that candela and Cycles both read: glTF files whose materials mean the same in both.

Cycles 3.4 has no BRDF equal to glTF's: its Principled BSDF takes the Fresnel equations where glTF takes Schlick's approximation, adds
the specular lobe without taking its share from the diffuse one, which is Burley's and not Lambert's, and its GGX is the product of two
maskings where glTF's is height-correlated. Equal are: a diffuse surface (glTF: KHR_materials_specular with factor 0, not metallic; the
layer of f0 = f90 = 0 takes nothing), emission, and a metal of base colour 1, whose Schlick Fresnel is 1 at every angle, as far as
masking does not matter (alpha 0.09: the two differ by the product of the directions' Lambda, 4e-6 at 45 degrees, 4e-3 at 80).

Of the Khronos extensions: glass bodies, smooth and rough (both have the exact Fresnel equations), with absorption; sheets, as a mix of
a mirror and a hole by the Fresnel equations; a clear coat, as a mix of a white GGX lobe and a diffuse base by Schlick's term at the
coat's normal, which is what its extension says; diffuse transmission, as a translucent share; a white metal whose facets are stretched
along the texture's U. Not: sheen (Cycles 3.4 has velvet of another distribution, and no albedo scaling), iridescence, dispersion.
"""
import base64
import json
import math
import pathlib
import shutil
import struct
import subprocess

NITS = [18.4, 15.6, 8.0]
WHITE, RED, GREEN = [0.74, 0.73, 0.70], [0.61, 0.06, 0.05], [0.12, 0.45, 0.10]

# Cornell University Program of Computer Graphics, "The Cornell Box", measured geometry; millimetres.
# Corners turn against the clock as seen from inside the room and from outside the blocks: glTF's front. The lamp hangs a tenth of a
# millimetre lower than there, where the ceiling has a hole for it.
CORNELL = {
    "white": [[(552.8, 0, 0), (0, 0, 0), (0, 0, 559.2), (549.6, 0, 559.2)],
              [(556, 548.8, 0), (556, 548.8, 559.2), (0, 548.8, 559.2), (0, 548.8, 0)],
              [(549.6, 0, 559.2), (0, 0, 559.2), (0, 548.8, 559.2), (556, 548.8, 559.2)]],
    "red": [[(552.8, 0, 0), (549.6, 0, 559.2), (556, 548.8, 559.2), (556, 548.8, 0)]],
    "green": [[(0, 0, 559.2), (0, 0, 0), (0, 548.8, 0), (0, 548.8, 559.2)]],
    "lamp": [[(343, 548.7, 227), (343, 548.7, 332), (213, 548.7, 332), (213, 548.7, 227)]],
    "short block": [[(130, 165, 65), (82, 165, 225), (240, 165, 272), (290, 165, 114)],
                    [(290, 0, 114), (290, 165, 114), (240, 165, 272), (240, 0, 272)],
                    [(130, 0, 65), (130, 165, 65), (290, 165, 114), (290, 0, 114)],
                    [(82, 0, 225), (82, 165, 225), (130, 165, 65), (130, 0, 65)],
                    [(240, 0, 272), (240, 165, 272), (82, 165, 225), (82, 0, 225)]],
    "tall block": [[(423, 330, 247), (265, 330, 296), (314, 330, 456), (472, 330, 406)],
                   [(423, 0, 247), (423, 330, 247), (472, 330, 406), (472, 0, 406)],
                   [(472, 0, 406), (472, 330, 406), (314, 330, 456), (314, 0, 456)],
                   [(314, 0, 456), (314, 330, 456), (265, 330, 296), (265, 0, 296)],
                   [(265, 0, 296), (265, 330, 296), (423, 330, 247), (423, 0, 247)]],
}


def diffuse(name, color):
    return {"name": name, "pbrMetallicRoughness": {"baseColorFactor": [*color, 1], "metallicFactor": 0, "roughnessFactor": 1},
            "extensions": {"KHR_materials_specular": {"specularFactor": 0}}}


def metal(name, roughness):
    return {"name": name, "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 1], "metallicFactor": 1, "roughnessFactor": roughness}}


def lobe(name, **extensions):
    """Diffuse but for the extensions."""
    made = diffuse(name, [0.6, 0.25, 0.1])
    made["extensions"].update({f"KHR_materials_{k}": v for k, v in extensions.items()})
    return made


def glass(name, roughness, body, color=(1, 1, 1)):
    made = {"name": name, "pbrMetallicRoughness": {"baseColorFactor": [*color, 1], "metallicFactor": 0, "roughnessFactor": roughness},
            "doubleSided": True,
            "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_ior": {"ior": 1.5}}}
    if body:
        made["extensions"]["KHR_materials_volume"] = {"thicknessFactor": 1, "attenuationDistance": 0.2, "attenuationColor": [0.9, 0.5, 0.3]}
    return made


# The tall block of the Cornell box.
LOBES = {
    "coat": ("diffuse under a clear coat of roughness 0.3",
             lobe("tall block", clearcoat={"clearcoatFactor": 1, "clearcoatRoughnessFactor": 0.3})),
    "leaf": ("transmits 60 % of its light diffusely", lobe("tall block", diffuse_transmission={
        "diffuseTransmissionFactor": 0.6, "diffuseTransmissionColorFactor": [0.3, 0.7, 0.2]}) | {"doubleSided": True}),
    "sheet": ("sheets of smooth tinted glass", glass("tall block", 0, False, (0.6, 0.8, 0.9))),
    "glass": ("a body of smooth glass that absorbs", glass("tall block", 0, True)),
    "frosted": ("a body of glass of roughness 0.3 that absorbs", glass("tall block", 0.3, True)),
    "brushed": ("a white metal of roughness 0.3, stretched to alpha 0.25 across",
                metal("tall block", 0.3) | {"extensions": {"KHR_materials_anisotropy": {
                    "anisotropyStrength": math.sqrt((0.25 - 0.09) / (1 - 0.09)), "anisotropyRotation": 0}}}),
}


def lamp(name, nits):
    strength = max(nits)
    return {**diffuse(name, [0.78, 0.78, 0.78]), "emissiveFactor": [x / strength for x in nits],
            "extensions": {"KHR_materials_specular": {"specularFactor": 0}, "KHR_materials_emissive_strength": {"emissiveStrength": strength}}}


def add_triangles(gltf, name, triangles, material, uv=None):
    """Without normals, which both renderers then take from the triangles. uv: of the three corners of each."""
    points = [p for t in triangles for p in t]
    data = b"".join(struct.pack("<3f", *p) for p in points)
    gltf.setdefault("buffers", []).append({"byteLength": len(data), "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()})
    gltf.setdefault("bufferViews", []).append({"buffer": len(gltf["buffers"]) - 1, "byteLength": len(data)})
    rounded = [struct.unpack("<3f", struct.pack("<3f", *p)) for p in points]
    gltf.setdefault("accessors", []).append({
        "bufferView": len(gltf["bufferViews"]) - 1, "componentType": 5126, "count": len(points), "type": "VEC3",
        "min": [min(p[i] for p in rounded) for i in range(3)], "max": [max(p[i] for p in rounded) for i in range(3)]})
    attributes = {"POSITION": len(gltf["accessors"]) - 1}
    if uv:
        data = b"".join(struct.pack("<2f", *p) for t in uv for p in t)
        gltf["buffers"].append({"byteLength": len(data), "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()})
        gltf["bufferViews"].append({"buffer": len(gltf["buffers"]) - 1, "byteLength": len(data)})
        gltf["accessors"].append({"bufferView": len(gltf["bufferViews"]) - 1, "componentType": 5126, "count": len(points), "type": "VEC2"})
        attributes["TEXCOORD_0"] = len(gltf["accessors"]) - 1
    gltf.setdefault("meshes", []).append({"name": name, "primitives": [{"attributes": attributes, "material": material}]})
    add_node(gltf, {"name": name, "mesh": len(gltf["meshes"]) - 1})


def add_node(gltf, node):
    gltf.setdefault("nodes", []).append(node)
    gltf["scenes"][0].setdefault("nodes", []).append(len(gltf["nodes"]) - 1)


def add_camera(gltf, yfov, **node):
    gltf["cameras"] = [{"type": "perspective", "perspective": {"yfov": yfov, "znear": 0.01, "zfar": 1000}}]
    add_node(gltf, {"name": "camera", "camera": 0, **node})


def looking(eye, target):
    """Rotation of a camera at eye, as a quaternion x, y, z, w: first about x by the pitch, then about y."""
    x, y, z = (t - e for t, e in zip(target, eye))
    yaw, pitch = math.atan2(-x, -z), math.atan2(y, math.hypot(x, z))
    sy, cy, sp, cp = math.sin(yaw / 2), math.cos(yaw / 2), math.sin(pitch / 2), math.cos(pitch / 2)
    return [cy * sp, sy * cp, -sy * sp, cy * cp]


def uses(gltf, *names):
    gltf["extensionsUsed"] = sorted({*gltf.get("extensionsUsed", []), *names})


def cornell(file, tall_block=None):
    gltf = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{}]}
    gltf["materials"] = [diffuse("white", WHITE), diffuse("red", RED), diffuse("green", GREEN), lamp("lamp", NITS)]
    gltf["materials"].append(tall_block or diffuse("tall block", WHITE))
    of = {"white": 0, "short block": 0, "red": 1, "green": 2, "lamp": 3, "tall block": 4}
    for name, quads in CORNELL.items():
        corners = [[tuple(x / 1000 for x in p) for p in q] for q in quads]
        square = ((0, 0), (1, 0), (1, 1), (0, 1))
        add_triangles(gltf, name, [t for a, b, c, d in corners for t in ((a, b, c), (a, c, d))], of[name],
                      [t for a, b, c, d in [square] * len(corners) for t in ((a, b, c), (a, c, d))])
    add_camera(gltf, 2 * math.atan(0.0125 / 0.035), translation=[0.278, 0.273, -0.8], rotation=[0, 1, 0, 0])
    # candela lights a file without lights by a neutral one; a dark light keeps that away, so that the lamp is all there is.
    gltf["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 0}]}}
    add_node(gltf, {"name": "none", "extensions": {"KHR_lights_punctual": {"light": 0}}})
    uses(gltf, "KHR_materials_specular", "KHR_materials_emissive_strength", "KHR_lights_punctual",
         *(e for m in gltf["materials"] for e in m.get("extensions", {})))
    file.write_text(json.dumps(gltf, indent=1))


def made_diffuse(asset, folder):
    """A glTF file of the assets with every material diffuse and nothing that moves; its buffers and images copied beside it."""
    gltf = json.loads(asset.read_text())
    for part in gltf.get("buffers", []) + gltf.get("images", []):
        if "uri" in part and not part["uri"].startswith("data:"):
            (folder / part["uri"]).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(asset.parent / part["uri"], folder / part["uri"])
    for material in gltf["materials"]:
        kept = {k: v for k, v in material["pbrMetallicRoughness"].items() if k.startswith("baseColor")}
        material["pbrMetallicRoughness"] = {**kept, "metallicFactor": 0, "roughnessFactor": 1}
        material["extensions"] = {"KHR_materials_specular": {"specularFactor": 0}}
        for key in ("normalTexture", "occlusionTexture"):
            material.pop(key, None)
    gltf.pop("animations", None)
    uses(gltf, "KHR_materials_specular")
    return gltf


def truck(file, assets, lights):
    """CesiumMilkTruck on a grey ground; with lights: a sun and two points in glTF's units (lux, candela)."""
    gltf = made_diffuse(assets / "khronos/CesiumMilkTruck/CesiumMilkTruck.gltf", file.parent)
    gltf["materials"].append(diffuse("ground", [0.4, 0.4, 0.4]))
    a, b, c, d = (-8, 0, 8), (8, 0, 8), (8, 0, -8), (-8, 0, -8)
    add_triangles(gltf, "ground", [(a, b, c), (a, c, d)], len(gltf["materials"]) - 1)
    eye, target = [4.6, 2.6, 5.6], [0, 1.1, 0]
    add_camera(gltf, 0.62, translation=eye, rotation=looking(eye, target))
    if lights:
        uses(gltf, "KHR_lights_punctual")
        gltf["extensions"] = {"KHR_lights_punctual": {"lights": [
            {"type": "directional", "intensity": 2.5, "color": [1, 0.93, 0.8]},
            {"type": "point", "intensity": 6, "color": [0.3, 0.5, 1]},
            {"type": "point", "intensity": 3, "color": [1, 0.4, 0.2]}]}}
        nodes = [{"rotation": looking([-3, 7, 5], [0, 0, 0])}, {"translation": [2.2, 1.5, 2.4]}, {"translation": [-3.4, 0.8, 1.8]}]
        for i, node in enumerate(nodes):
            add_node(gltf, {"name": f"light {i}", "extensions": {"KHR_lights_punctual": {"light": i}}, **node})
    file.write_text(json.dumps(gltf, indent=1))


def rotated(q, p):
    x, y, z, w = q
    tx, ty, tz = 2 * (y * p[2] - z * p[1]), 2 * (z * p[0] - x * p[2]), 2 * (x * p[1] - y * p[0])
    return [p[0] + w * tx + y * tz - z * ty, p[1] + w * ty + z * tx - x * tz, p[2] + w * tz + x * ty - y * tx]


def multiplied(a, b):
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return [aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx, aw * bz + ax * by - ay * bx + az * bw,
            aw * bw - ax * bx - ay * by - az * bz]


class Place:
    """Scale, then rotation, then translation; scales are alike along all axes wherever something is turned below them."""

    def __init__(self, t=(0, 0, 0), r=(0, 0, 0, 1), s=(1, 1, 1)):
        self.t, self.r, self.s = list(t), list(r), list(s)

    def point(self, p):
        return [a + b for a, b in zip(rotated(self.r, [x * y for x, y in zip(p, self.s)]), self.t)]

    def within(self, t, r, s):
        return Place(self.point(t), multiplied(self.r, r), [a * b for a, b in zip(self.s, s)])


class Glb:
    def __init__(self, file):
        data = file.read_bytes()
        length = struct.unpack("<I", data[12:16])[0]
        self.json = json.loads(data[20:20 + length])
        self.binary = data[20 + length + 8:]

    def read(self, accessor):
        a = self.json["accessors"][accessor]
        view = self.json["bufferViews"][a["bufferView"]]
        kind, size = {5121: ("B", 1), 5123: ("H", 2), 5125: ("I", 4), 5126: ("f", 4)}[a["componentType"]]
        width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}[a["type"]]
        stride = view.get("byteStride", width * size)
        start = view.get("byteOffset", 0) + a.get("byteOffset", 0)
        scale = {5121: 255, 5123: 65535}.get(a["componentType"], 1) if a.get("normalized") else 1
        return [[x / scale if scale != 1 else x for x in struct.unpack_from(f"<{width}{kind}", self.binary, start + i * stride)]
                for i in range(a["count"])]


def city(file, candela, lights):
    """`make-scene street` as both can read it: instances made triangles, vertex colours materials, windows dark, every lamp a point without
    range - a spot one of the same flux, about - so that nothing but the transport differs."""
    glb_file = file.with_suffix(".glb")
    subprocess.run([candela, "make-scene", "street", "--lights", str(lights), "-o", str(glb_file)], check=True, stdout=subprocess.DEVNULL)
    source = Glb(glb_file)
    j = source.json
    gltf = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{}], "materials": []}
    triangles, lamps = {}, []

    def add_mesh(mesh, place):
        for primitive in j["meshes"][mesh]["primitives"]:
            attributes = primitive["attributes"]
            points = [place.point(p) for p in source.read(attributes["POSITION"])]
            colors = source.read(attributes["COLOR_0"])
            index = [i[0] for i in source.read(primitive["indices"])]
            for k in range(0, len(index), 3):
                color = tuple(round(min(x, 0.8), 1) for x in colors[index[k]][:3])
                triangles.setdefault(color, []).append([points[i] for i in index[k:k + 3]])

    def add_lamps(use, place):
        light = j["extensions"]["KHR_lights_punctual"]["lights"][use["light"]]
        attributes = {name: source.read(accessor) for name, accessor in use["attributes"].items()}
        share = (1 - math.cos(light["spot"]["outerConeAngle"])) / 2 if light["type"] == "spot" else 1
        for i, at in enumerate(attributes["TRANSLATION"]):
            color = [a * b for a, b in zip(light.get("color", [1, 1, 1]), attributes["COLOR"][i] if "COLOR" in attributes else [1, 1, 1])]
            lamps.append((place.point(at), color, light.get("intensity", 1) * attributes["INTENSITY"][i][0] * share))

    def visit(index, parent):
        node = j["nodes"][index]
        place = parent.within(node.get("translation", [0, 0, 0]), node.get("rotation", [0, 0, 0, 1]), node.get("scale", [1, 1, 1]))
        extensions = node.get("extensions", {})
        if "CANDELA_light_instances" in extensions:
            add_lamps(extensions["CANDELA_light_instances"], place)
        if "camera" in node:
            add_camera(gltf, j["cameras"][node["camera"]]["perspective"]["yfov"], translation=place.t, rotation=place.r)
        if "mesh" in node:
            instances = extensions.get("EXT_mesh_gpu_instancing")
            if not instances:
                add_mesh(node["mesh"], place)
            else:
                a = {name: source.read(accessor) for name, accessor in instances["attributes"].items()}
                for i in range(len(next(iter(a.values())))):
                    add_mesh(node["mesh"], place.within(*(a[k][i] if k in a else d for k, d in (
                        ("TRANSLATION", [0, 0, 0]), ("ROTATION", [0, 0, 0, 1]), ("SCALE", [1, 1, 1])))))
        for child in node.get("children", []):
            visit(child, place)

    for root in j["scenes"][0]["nodes"]:
        visit(root, Place())
    for color, group in sorted(triangles.items()):
        gltf["materials"].append({**diffuse(f"paint {len(gltf['materials'])}", color), "doubleSided": True})
        add_triangles(gltf, gltf["materials"][-1]["name"], group, len(gltf["materials"]) - 1)
    gltf["extensions"] = {"KHR_lights_punctual": {"lights": [
        {"type": "point", "color": c, "intensity": i} for _, c, i in lamps]}}
    for i, (at, _, _) in enumerate(lamps):
        add_node(gltf, {"name": f"lamp {i}", "translation": at, "extensions": {"KHR_lights_punctual": {"light": i}}})
    uses(gltf, "KHR_materials_specular", "KHR_lights_punctual")
    file.write_text(json.dumps(gltf))


def write_scenes(folder, assets, candela=None):
    """Writes all; {name: {file, size, sky, text}}. Without the assets' folder only those that need none of it."""
    folder.mkdir(parents=True, exist_ok=True)
    assets = pathlib.Path(assets)
    cornell(folder / "cornell.gltf")
    cornell(folder / "cornell-metal.gltf", metal("tall block", 0.3))
    scenes = {
        "cornell": {"size": "160x160", "text": "Cornell box, diffuse, one emissive quad"},
        "cornell-metal": {"size": "160x160", "text": "the tall block a white metal of roughness 0.3"},
    }
    for name, (text, material) in LOBES.items():
        cornell(folder / f"cornell-{name}.gltf", material)
        scenes[f"cornell-{name}"] = {"size": "120x120", "text": f"the tall block {text}"}
    if (assets / "khronos/CesiumMilkTruck").is_dir():
        truck(folder / "truck-lights.gltf", assets, True)
        truck(folder / "truck-sky.gltf", assets, False)
        scenes["truck-lights"] = {"size": "192x144", "text": "CesiumMilkTruck made diffuse, on a ground, under a sun and two points"}
        scenes["truck-sky"] = {"size": "192x144", "sky": str(assets / "env/city.exr"), "text": "the same under an HDR environment alone"}
    for lights in (64, 1024) if candela else ():
        city(folder / f"city-{lights}.gltf", candela, lights)
        scenes[f"city-{lights}"] = {"size": "192x108", "text": f"make-scene street, {lights} lights, all points, diffuse, no emission"}
    for name, scene in scenes.items():
        scene["file"] = str(folder / f"{name}.gltf")
    return scenes
