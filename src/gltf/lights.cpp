#include "gltf/lights.h"

#include <numbers>

#include "scene/animation_targets.h"

namespace candela::gltf {
namespace {

void read_cone(Document& document, const Json& json, const std::string& path, Light& light) {
  const Json* spot = member(json, "spot");
  if (!spot) document.refuse(named(path, json), "a spot light needs the member 'spot' (UNDEFINED_PROPERTY)");
  const double inner = number(document, *spot, "innerConeAngle", 0, path + "/spot");
  const double outer = number(document, *spot, "outerConeAngle", std::numbers::pi / 4, path + "/spot");
  constexpr double widest = std::numbers::pi / 2 * (1 + 1e-6);  // pi/2 as a rounded float is a little more
  if (!(inner >= 0 && outer > 0 && outer <= widest && inner <= outer))
    document.refuse(named(path, json) + "/spot",
                    "cone angles {} (inner) and {} (outer) do not satisfy 0 <= inner < outer <= pi/2 "
                    "(KHR_LIGHTS_PUNCTUAL_LIGHT_SPOT_ANGLES)",
                    inner, outer);
  // Equal angles break the specification too, but a sharp edge is what they mean (the validation warns).
  light.inner_cone_rad = float(inner);
  light.outer_cone_rad = float(std::min(outer, std::numbers::pi / 2));
}

// CANDELA_light_size.
void read_size(Document& document, const Json& json, const std::string& path, Light& light) {
  const Json* size = extension(json, "CANDELA_light_size");
  if (!size) return;
  const std::string at = named(path, json) + "/extensions/CANDELA_light_size";
  if (light.type == LightType::directional)
    document.refuse(at, "a directional light has no radius in metres (VALUE_NOT_IN_LIST)");
  if (!size->contains("radius")) document.refuse(at, "'radius' is required (UNDEFINED_PROPERTY)");
  const double radius = number(document, *size, "radius", 0, at);
  if (!(radius >= 0) || !std::isfinite(float(radius)))
    document.refuse(at + "/radius", "{} is no radius; it must be 0 or more, and finite (VALUE_NOT_IN_RANGE)", radius);
  light.radius_m = float(radius);
}

Light read_light(Document& document, const Json& json, const std::string& path) {
  Light light;
  light.name = text(document, json, "name", "", path);
  const std::string type = text(document, json, "type", "", path);
  if (type == "directional")
    light.type = LightType::directional;
  else if (type == "point")
    light.type = LightType::point;
  else if (type == "spot")
    light.type = LightType::spot;
  else
    document.refuse(named(path, json) + "/type", "'{}' is no light type (VALUE_NOT_IN_LIST)", type);
  light.color = vector_of(document, json, "color", light.color, path);
  if (!(light.color.x >= 0 && light.color.y >= 0 && light.color.z >= 0) ||
      !std::isfinite(light.color.x + light.color.y + light.color.z))
    document.refuse(named(path, json) + "/color", "({}, {}, {}) is no colour (VALUE_NOT_IN_RANGE)", light.color.x,
                    light.color.y, light.color.z);
  light.intensity = float(number(document, json, "intensity", 1, path));
  if (!(light.intensity >= 0) || !std::isfinite(light.intensity))
    document.refuse(named(path, json) + "/intensity", "{} is no intensity (VALUE_NOT_IN_RANGE)",
                    number(document, json, "intensity", 1, path));
  if (json.contains("range")) {
    const double range = number(document, json, "range", 0, path);
    if (!(float(range) > 0))
      document.refuse(named(path, json) + "/range", "{} is no range; it must be positive (VALUE_NOT_IN_RANGE)", range);
    light.range_m = float(range);
  }
  if (light.type == LightType::spot) read_cone(document, json, path, light);
  read_size(document, json, path, light);
  return light;
}

}  // namespace

void import_cameras(Document& document, Scene& scene) {
  for (size_t i = 0; i < document.model.cameras.size(); ++i) {
    const tinygltf::Camera& source = document.model.cameras[i];
    Camera camera;
    camera.name = source.name;
    camera.perspective = source.type == "perspective";
    if (camera.perspective) {
      camera.yfov_rad = source.perspective.yfov;
      camera.aspect = source.perspective.aspectRatio;
      camera.near_m = source.perspective.znear;
      if (source.perspective.zfar > 0) camera.far_m = source.perspective.zfar;
    } else {
      camera.xmag = source.orthographic.xmag;
      camera.ymag = source.orthographic.ymag;
      camera.near_m = source.orthographic.znear;
      camera.far_m = source.orthographic.zfar;
    }
    scene.cameras.push_back(std::move(camera));
  }
}

void import_lights(Document& document, Scene& scene) {
  const Json* punctual = extension(document.json, "KHR_lights_punctual");
  const Json* lights = punctual ? member(*punctual, "lights") : nullptr;
  if (!lights) return;
  if (!lights->is_array())
    document.refuse("/extensions/KHR_lights_punctual/lights", "an array is wanted (TYPE_MISMATCH)");
  for (size_t i = 0; i < lights->size(); ++i)
    scene.lights.push_back(
        read_light(document, (*lights)[i], fmt::format("/extensions/KHR_lights_punctual/lights/{}", i)));
}

void check_animated_lights(Document& document, const Scene& scene) {
  for (size_t a = 0; a < scene.animations.size(); ++a)
    for (const AnimationChannel& channel : scene.animations[a].channels) {
      if (!drives_light(channel.path) || channel.object < 0) continue;
      const PropertyRange range = range_of(channel.path);
      // Cubic splines hold a tangent before and behind each value.
      const bool is_cubic = channel.interpolation == Interpolation::cubic_spline;
      const size_t components = size_t(channel.components), stride = components * (is_cubic ? 3 : 1);
      for (size_t key = 0; key < channel.times_s.size(); ++key)
        for (size_t c = 0; c < components; ++c) {
          const double value = double(channel.values[key * stride + (is_cubic ? components : 0) + c]);
          if (float(value) >= float(range.lowest) && float(value) <= float(range.highest)) continue;
          document.warn(light_place(scene, size_t(channel.object)),
                        "animation {} '{}' gives {} {} at {} s, which is outside [{}, {}] and will be clamped "
                        "(VALUE_NOT_IN_RANGE)",
                        a, scene.animations[a].name, range.name, value, channel.times_s[key], range.lowest,
                        range.highest);
          key = channel.times_s.size();  // one line a channel
          break;
        }
    }
}

}  // namespace candela::gltf
