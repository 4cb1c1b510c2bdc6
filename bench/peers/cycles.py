"""Renders a scene of cycles_scenes.py by Cycles, inside Blender 3.4:

blender -b --factory-startup -P bench/peers/cycles.py -- SCENE.gltf --size WxH --spp N --seeds A,B,... --output PREFIX [--sky FILE]

writes PREFIX-A.exr ...: linear, 32-bit, not compressed. Geometry, transforms, camera and lights come by Blender's own glTF importer;
materials are built here from the file's numbers.

Units. candela puts candelas, lux and nits into its equations as they are, and so does this: 1 cd stands for 1 W/sr. Cycles spreads a
point's P watts evenly over the sphere, I = P / (4 pi), so P = 4 pi I; a sun's strength is W/m^2, for lux; an emission's strength
is W/(sr m^2), for nits. That is the importer's "unitless" mode (convert_lighting_mode COMPAT). Its default would divide by 683 lm/W.
"""
import argparse
import json
import math
import pathlib
import sys

import bpy
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from plain_exr import write_exr  # noqa: E402

FOR_EVER = 1024
# The importer of 3.4 uses this alias, which the numpy of the same Debian no longer has.
if "bool" not in numpy.__dict__:
    numpy.bool = bool


def linear_copy(image, path):
    """The image decoded to a file of linear floats. Cycles filters 8-bit sRGB texels before it decodes them, glTF wants it the other way."""
    width, height = image.size
    if image.is_float or image.depth > 32:
        raise SystemExit(f"{image.name}: not an image of 8 bits")
    texels = numpy.empty(4 * width * height, numpy.float32)
    image.pixels.foreach_get(texels)  # as they are stored, whatever the colour space says
    c = texels.reshape(height, width, 4)[::-1, :, :3].astype(numpy.float64)
    linear = numpy.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
    write_exr(path, {"R": linear[..., 0], "G": linear[..., 1], "B": linear[..., 2]})
    copy = bpy.data.images.load(path)
    copy.colorspace_settings.is_data = True
    return copy


def front_only(tree, socket):
    """Single-sided, as in candela: camera rays pass the back, other rays do not."""
    nodes, links = tree.nodes, tree.links
    geometry, path, both = nodes.new("ShaderNodeNewGeometry"), nodes.new("ShaderNodeLightPath"), nodes.new("ShaderNodeMath")
    both.operation = "MULTIPLY"
    links.new(geometry.outputs["Backfacing"], both.inputs[0])
    links.new(path.outputs["Is Camera Ray"], both.inputs[1])
    hole, mix = nodes.new("ShaderNodeBsdfTransparent"), nodes.new("ShaderNodeMixShader")
    links.new(both.outputs[0], mix.inputs[0])
    links.new(socket, mix.inputs[1])
    links.new(hole.outputs[0], mix.inputs[2])
    return mix.outputs[0]


def mixed(tree, share, first, second):
    """(1 - share) first + share second; share: a number or a socket."""
    mix = tree.nodes.new("ShaderNodeMixShader")
    if isinstance(share, (int, float)):
        mix.inputs[0].default_value = share
    else:
        tree.links.new(share, mix.inputs[0])
    tree.links.new(first, mix.inputs[1])
    tree.links.new(second, mix.inputs[2])
    return mix.outputs[0]


def number(tree, operation, *values):
    node = tree.nodes.new("ShaderNodeMath")
    node.operation = operation
    for i, value in enumerate(values):
        if isinstance(value, (int, float)):
            node.inputs[i].default_value = value
        else:
            tree.links.new(value, node.inputs[i])
    return node.outputs[0]


def glossy(tree, roughness):
    node = tree.nodes.new("ShaderNodeBsdfGlossy")
    node.distribution = "GGX" if roughness > 0 else "SHARP"
    node.inputs["Color"].default_value = [1, 1, 1, 1]
    node.inputs["Roughness"].default_value = roughness
    return node.outputs[0]


def schlick(tree, factor):
    """factor (0.04 + 0.96 (1 - |n.v|)^5): what a clear coat takes."""
    facing = tree.nodes.new("ShaderNodeLayerWeight")
    facing.inputs["Blend"].default_value = 0.5  # "Facing" is then 1 - |n.v|
    grazing = number(tree, "POWER", facing.outputs["Facing"], 5.0)
    return number(tree, "MULTIPLY", number(tree, "MULTIPLY_ADD", grazing, 0.96, 0.04), factor)


def build_glass(tree, base, source):
    """A body: Cycles' glass, and what it absorbs. A sheet: a mirror and a hole by the Fresnel equations, alike from either side."""
    extensions, roughness = source["extensions"], source["pbrMetallicRoughness"]["roughnessFactor"]
    ior = extensions["KHR_materials_ior"]["ior"]
    body = extensions.get("KHR_materials_volume")
    if not body:
        assert roughness == 0
        fresnel, hole, geometry = (tree.nodes.new(n) for n in ("ShaderNodeFresnel", "ShaderNodeBsdfTransparent", "ShaderNodeNewGeometry"))
        # On back faces the node turns the index over: ior there is 1 / ior.
        tree.links.new(number(tree, "MULTIPLY_ADD", geometry.outputs["Backfacing"], 1 / ior - ior, ior), fresnel.inputs["IOR"])
        tree.links.new(base, hole.inputs["Color"])
        return mixed(tree, fresnel.outputs[0], hole.outputs[0], glossy(tree, 0)), None
    surface, volume = tree.nodes.new("ShaderNodeBsdfGlass"), tree.nodes.new("ShaderNodeVolumeAbsorption")
    surface.distribution = "GGX" if roughness > 0 else "SHARP"
    surface.inputs["Roughness"].default_value = roughness
    surface.inputs["IOR"].default_value = ior
    tree.links.new(base, surface.inputs["Color"])
    per_m = [-math.log(c) / body["attenuationDistance"] for c in body["attenuationColor"]]
    volume.inputs["Density"].default_value = max(per_m)
    volume.inputs["Color"].default_value = [*(1 - x / max(per_m) for x in per_m), 1]
    return surface.outputs[0], volume.outputs[0]


def build_brushed(tree, roughness, strength):
    """Widths in Cycles: a = alpha (1 - x) along the tangent and b = alpha / (1 - x) across it. In glTF the rougher way is along."""
    across = roughness**2
    along = across + (1 - across) * strength**2
    surface, tangent = tree.nodes.new("ShaderNodeBsdfAnisotropic"), tree.nodes.new("ShaderNodeTangent")
    surface.distribution = "MULTI_GGX"
    surface.inputs["Color"].default_value = [1, 1, 1, 1]
    surface.inputs["Roughness"].default_value = math.sqrt(math.sqrt(along * across))
    surface.inputs["Anisotropy"].default_value = 1 - math.sqrt(across / along)
    surface.inputs["Rotation"].default_value = 0.25  # a quarter turn: Cycles' rougher way is across
    tangent.direction_type, tangent.uv_map = "UV_MAP", "UVMap"
    tree.links.new(tangent.outputs[0], surface.inputs["Tangent"])
    return surface.outputs[0]


def build_material(material, gltf, folder, images, prefix):
    """Nodes for what the file says: diffuse, or a metal of base colour 1; plus emission from the front."""
    source = next(m for m in gltf["materials"] if m["name"] == material.name)
    pbr = source["pbrMetallicRoughness"]
    extensions = source.get("extensions", {})
    is_metal, is_glass = pbr["metallicFactor"] == 1, "KHR_materials_transmission" in extensions
    assert is_metal or is_glass or (pbr["metallicFactor"] == 0 and extensions["KHR_materials_specular"]["specularFactor"] == 0), material.name
    texture = None
    if "baseColorTexture" in pbr:
        assert pbr["baseColorTexture"].get("texCoord", 0) == 0
        index = gltf["textures"][pbr["baseColorTexture"]["index"]]["source"]
        if index not in images:
            source_image = bpy.data.images.load(str(folder / gltf["images"][index]["uri"]))
            images[index] = linear_copy(source_image, f"{prefix}-texture-{index}.exr")
        texture = images[index]
    tree = material.node_tree
    tree.nodes.clear()
    color = tree.nodes.new("ShaderNodeRGB")
    factor = pbr.get("baseColorFactor", [1, 1, 1, 1])
    color.outputs[0].default_value = factor
    base = color.outputs[0]
    if texture:
        image, product, uv = tree.nodes.new("ShaderNodeTexImage"), tree.nodes.new("ShaderNodeMixRGB"), tree.nodes.new("ShaderNodeUVMap")
        image.image, image.interpolation, image.extension = texture, "Linear", "REPEAT"
        uv.uv_map = "UVMap"
        tree.links.new(uv.outputs[0], image.inputs[0])
        product.blend_type = "MULTIPLY"
        product.inputs[0].default_value = 1
        tree.links.new(image.outputs[0], product.inputs[1])
        tree.links.new(base, product.inputs[2])
        base = product.outputs[0]
    volume = None
    if is_glass:
        out, volume = build_glass(tree, base, source)
    elif is_metal and "KHR_materials_anisotropy" in extensions:
        assert factor[:3] == [1, 1, 1] and not texture
        out = build_brushed(tree, pbr["roughnessFactor"], extensions["KHR_materials_anisotropy"]["anisotropyStrength"])
    elif is_metal:
        assert factor[:3] == [1, 1, 1] and not texture
        surface = tree.nodes.new("ShaderNodeBsdfGlossy")
        surface.distribution = "MULTI_GGX"  # keeps what bounces on between facets, as candela does
        surface.inputs["Roughness"].default_value = pbr["roughnessFactor"]  # alpha is its square, as in glTF
        tree.links.new(base, surface.inputs["Color"])
        out = surface.outputs[0]
    else:
        surface = tree.nodes.new("ShaderNodeBsdfDiffuse")  # roughness 0: Lambert
        tree.links.new(base, surface.inputs["Color"])
        out = surface.outputs[0]
        if "KHR_materials_diffuse_transmission" in extensions:
            leaf, behind = extensions["KHR_materials_diffuse_transmission"], tree.nodes.new("ShaderNodeBsdfTranslucent")
            behind.inputs["Color"].default_value = [*leaf["diffuseTransmissionColorFactor"], 1]
            out = mixed(tree, leaf["diffuseTransmissionFactor"], out, behind.outputs[0])
        if "KHR_materials_clearcoat" in extensions:
            coat = extensions["KHR_materials_clearcoat"]
            out = mixed(tree, schlick(tree, coat["clearcoatFactor"]), out, glossy(tree, coat["clearcoatRoughnessFactor"]))
    emitted = source.get("emissiveFactor")
    if emitted:
        assert "emissiveTexture" not in source
        emission, geometry, front, total = (tree.nodes.new(n) for n in (
            "ShaderNodeEmission", "ShaderNodeNewGeometry", "ShaderNodeMath", "ShaderNodeAddShader"))
        emission.inputs["Color"].default_value = [*emitted, 1]
        strength = extensions.get("KHR_materials_emissive_strength", {}).get("emissiveStrength", 1)
        front.operation = "MULTIPLY_ADD"  # strength * (1 - backfacing)
        front.inputs[1].default_value, front.inputs[2].default_value = -strength, strength
        tree.links.new(geometry.outputs["Backfacing"], front.inputs[0])
        tree.links.new(front.outputs[0], emission.inputs["Strength"])
        tree.links.new(out, total.inputs[0])
        tree.links.new(emission.outputs[0], total.inputs[1])
        out = total.outputs[0]
        material.cycles.sample_as_light = True
    if not source.get("doubleSided", False):
        out = front_only(tree, out)
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(out, output.inputs["Surface"])
    if volume:
        tree.links.new(volume, output.inputs["Volume"])


def build_world(scene, sky):
    world = bpy.data.worlds.new("world")
    scene.world = world
    world.use_nodes = True
    background = world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = [0, 0, 0, 1]
    if sky:
        # Cycles' longitude is -atan2(y, x) with z up: glTF's atan2(z, x), which is candela's, without any rotation.
        texture = world.node_tree.nodes.new("ShaderNodeTexEnvironment")
        texture.image = bpy.data.images.load(sky)
        texture.image.colorspace_settings.is_data = True  # already linear Rec.709, which Cycles works in
        texture.interpolation, texture.projection = "Linear", "EQUIRECTANGULAR"
        world.node_tree.links.new(texture.outputs[0], background.inputs["Color"])


def settle(scene, width, height, spp):
    """Nothing that alters the expected value: no clamp, blur, cut or denoising; the box filter of one pixel."""
    render, cycles = scene.render, scene.cycles
    render.engine = "CYCLES"
    render.resolution_x, render.resolution_y, render.resolution_percentage = width, height, 100
    render.pixel_aspect_x = render.pixel_aspect_y = 1
    render.film_transparent = render.use_motion_blur = render.use_compositing = render.use_sequencer = False
    cycles.samples, cycles.use_adaptive_sampling, cycles.use_denoising = spp, False, False
    cycles.pixel_filter_type = "BOX"
    # Sample 0 of every pixel lies at its centre whatever the filter is: an error of edges by one part in spp, the same in every run.
    cycles.sample_offset = 1
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.light_sampling_threshold = cycles.blur_glossy = 0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    cycles.use_fast_gi = cycles.use_guiding = False
    for name in ("max_bounces", "diffuse_bounces", "glossy_bounces", "transmission_bounces", "transparent_max_bounces"):
        setattr(cycles, name, FOR_EVER)  # Russian roulette ends paths
    cycles.film_exposure = 1
    image = render.image_settings
    image.file_format, image.color_mode, image.color_depth, image.exr_codec = "OPEN_EXR", "RGBA", "32", "NONE"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("scene")
    parser.add_argument("--size", required=True)
    parser.add_argument("--spp", type=int, required=True)
    parser.add_argument("--seeds", required=True)
    parser.add_argument("--output", required=True)
    parser.add_argument("--sky")
    o = parser.parse_args(sys.argv[sys.argv.index("--") + 1:])
    width, height = map(int, o.size.split("x"))
    gltf = json.loads(pathlib.Path(o.scene).read_text())
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=o.scene, convert_lighting_mode="COMPAT", import_shading="NORMALS", merge_vertices=False)
    scene = bpy.context.scene
    settle(scene, width, height, o.spp)
    build_world(scene, o.sky)
    images = {}
    for material in bpy.data.materials:
        if material.users:
            build_material(material, gltf, pathlib.Path(o.scene).parent, images, o.output)
    for item in scene.objects:
        # By default Cycles moves the origin of rays off smooth shaded triangles.
        item.cycles.shadow_terminator_offset = item.cycles.shadow_terminator_geometry_offset = 0
        if item.type == "CAMERA":
            scene.camera = item
        elif item.type == "LIGHT":
            if item.data.type == "SUN":
                item.data.angle = 0
            else:
                item.data.shadow_soft_size = 0
            item.data.use_shadow = True
            item.data.cycles.max_bounces = FOR_EVER
    for seed in o.seeds.split(","):
        scene.cycles.seed = int(seed)
        scene.render.filepath = f"{o.output}-{seed}.exr"
        bpy.ops.render.render(write_still=True)


main()
