#include "testscenes/glb_writer.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/check.h"
#include "math/transforms.h"

namespace candela {

namespace {

constexpr int array_buffer = 34962, element_array_buffer = 34963, no_target = 0;
constexpr int type_u8 = 5121, type_u16 = 5123, type_u32 = 5125, type_float = 5126;

template <class T>
std::span<const std::byte> bytes_of(const std::vector<T>& values) {
  return std::as_bytes(std::span(values));
}

void append_u32(std::vector<std::byte>& out, uint32_t value) {
  for (int shift = 0; shift < 32; shift += 8) out.push_back(std::byte(value >> shift));
}

void pad_to_four(std::vector<std::byte>& out, std::byte filler) {
  while (out.size() % 4 != 0) out.push_back(filler);
}

}  // namespace

json number(double value) {
  const double rounded = std::round(value * 1e7) / 1e7;
  if (rounded == std::round(rounded)) return int64_t(rounded);
  return rounded;
}

json vector_json(std::initializer_list<double> values) {
  json out = json::array();
  for (double v : values) out.push_back(number(v));
  return out;
}

json vector_json(glm::dvec3 v) { return vector_json({v.x, v.y, v.z}); }
json quaternion_json(glm::dquat q) { return vector_json({q.x, q.y, q.z, q.w}); }

GlbWriter::GlbWriter() {
  root["asset"] = {{"version", "2.0"}, {"generator", "candela make-scene"}};
  root["scene"] = 0;
  root["scenes"] = json::array({{{"nodes", json::array()}}});
}

int GlbWriter::add(std::string_view array, json value) {
  json& list = root[std::string(array)];
  list.push_back(std::move(value));
  return int(list.size()) - 1;
}

int GlbWriter::view(std::span<const std::byte> data, int target) {
  pad_to_four(binary_, std::byte{0});
  json value = {{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", data.size()}};
  if (target != no_target) value["target"] = target;
  binary_.insert(binary_.end(), data.begin(), data.end());
  return add("bufferViews", std::move(value));
}

int GlbWriter::accessor(std::span<const std::byte> data, int component_type, size_t count, std::string_view type,
                        int target) {
  const int buffer_view = view(data, target);
  return add("accessors",
             {{"bufferView", buffer_view}, {"componentType", component_type}, {"count", count}, {"type", type}});
}

int GlbWriter::float_accessor(std::span<const double> values, int components, bool with_bounds) {
  static constexpr const char* types[] = {"", "SCALAR", "VEC2", "VEC3", "VEC4"};
  CHECK(components >= 1 && components <= 4 && values.size() % size_t(components) == 0);
  std::vector<float> floats(values.begin(), values.end());
  const int index =
      accessor(bytes_of(floats), type_float, floats.size() / size_t(components), types[components], no_target);
  if (with_bounds) {
    json low = json::array(), high = json::array();
    for (int c = 0; c < components; ++c) {
      float least = floats[size_t(c)], most = least;
      for (size_t i = size_t(c); i < floats.size(); i += size_t(components)) {
        least = std::min(least, floats[i]);
        most = std::max(most, floats[i]);
      }
      low.push_back(least);
      high.push_back(most);
    }
    root["accessors"][size_t(index)]["min"] = std::move(low);
    root["accessors"][size_t(index)]["max"] = std::move(high);
  }
  return index;
}

int GlbWriter::shared_float_accessor(const std::vector<double>& values, int components, bool with_bounds) {
  const auto [place, is_new] = shared_.try_emplace({components, with_bounds, values}, 0);
  if (is_new) place->second = float_accessor(values, components, with_bounds);
  return place->second;
}

int GlbWriter::vec3_accessor(std::span<const glm::dvec3> values, bool with_bounds) {
  std::vector<double> flat;
  for (glm::dvec3 v : values) flat.insert(flat.end(), {v.x, v.y, v.z});
  return float_accessor(flat, 3, with_bounds);
}

int GlbWriter::mat4_accessor(std::span<const glm::dmat4> values) {
  std::vector<float> floats;
  for (const glm::dmat4& m : values)
    for (int column = 0; column < 4; ++column)
      for (int row = 0; row < 4; ++row) floats.push_back(float(m[column][row]));
  return accessor(bytes_of(floats), type_float, values.size(), "MAT4", no_target);
}

int GlbWriter::index_accessor(std::span<const uint32_t> index) {
  if (std::ranges::max(index) < 65535) {
    const std::vector<uint16_t> narrow(index.begin(), index.end());
    return accessor(bytes_of(narrow), type_u16, index.size(), "SCALAR", element_array_buffer);
  }
  return accessor(std::as_bytes(index), type_u32, index.size(), "SCALAR", element_array_buffer);
}

int GlbWriter::joint_accessor(std::span<const glm::u16vec4> joints) {
  std::vector<uint8_t> narrow;
  for (glm::u16vec4 j : joints)
    for (int i = 0; i < 4; ++i) narrow.push_back(uint8_t(j[i]));
  return accessor(bytes_of(narrow), type_u8, joints.size(), "VEC4", array_buffer);
}

int GlbWriter::unorm8_accessor(std::span<const glm::dvec4> values) {
  std::vector<uint8_t> narrow;
  for (const glm::dvec4& v : values)
    for (int i = 0; i < 4; ++i) narrow.push_back(uint8_t(std::lround(std::clamp(v[i], 0.0, 1.0) * 255)));
  const int index = accessor(bytes_of(narrow), type_u8, values.size(), "VEC4", array_buffer);
  root["accessors"][size_t(index)]["normalized"] = true;
  return index;
}

json GlbWriter::primitive(const Shape& shape) {
  json attributes;
  attributes["POSITION"] = vec3_accessor(shape.position, true);
  if (!shape.normal.empty()) attributes["NORMAL"] = vec3_accessor(shape.normal);
  if (!shape.uv.empty()) {
    std::vector<double> flat;
    for (glm::dvec2 v : shape.uv) flat.insert(flat.end(), {v.x, v.y});
    attributes["TEXCOORD_0"] = float_accessor(flat, 2);
  }
  if (!shape.tangent.empty()) {
    std::vector<double> flat;
    for (glm::dvec4 v : shape.tangent) flat.insert(flat.end(), {v.x, v.y, v.z, v.w});
    attributes["TANGENT"] = float_accessor(flat, 4);
  }
  if (!shape.color.empty()) {
    std::vector<double> flat;
    for (glm::dvec4 v : shape.color) flat.insert(flat.end(), {v.x, v.y, v.z, v.w});
    attributes["COLOR_0"] = float_accessor(flat, 4);
  }
  json out = {{"attributes", std::move(attributes)}};
  if (!shape.index.empty()) out["indices"] = index_accessor(shape.index);
  return out;
}

int GlbWriter::mesh(std::string_view name, json primitive, int material) {
  if (material >= 0) primitive["material"] = material;
  return add("meshes", {{"name", name}, {"primitives", json::array({std::move(primitive)})}});
}

int GlbWriter::material(std::string_view name, json properties) {
  properties["name"] = name;
  return add("materials", std::move(properties));
}

int GlbWriter::texture(std::string_view name, std::span<const std::byte> png, json sampler) {
  const int buffer_view = view(png, no_target);
  const int image = add("images", {{"name", name}, {"bufferView", buffer_view}, {"mimeType", "image/png"}});
  json value = {{"source", image}};
  if (!sampler.empty()) value["sampler"] = add("samplers", std::move(sampler));
  return add("textures", std::move(value));
}

int GlbWriter::light(json light) {
  use_extension("KHR_lights_punctual");
  json& list = root["extensions"]["KHR_lights_punctual"]["lights"];
  list.push_back(std::move(light));
  return int(list.size()) - 1;
}

int GlbWriter::camera(json camera) { return add("cameras", std::move(camera)); }

int GlbWriter::node(std::string_view name, json properties) {
  properties["name"] = name;
  const int index = add("nodes", std::move(properties));
  root["scenes"][0]["nodes"].push_back(index);
  return index;
}

int GlbWriter::child(int parent, std::string_view name, json properties) {
  properties["name"] = name;
  const int index = add("nodes", std::move(properties));
  root["nodes"][size_t(parent)]["children"].push_back(index);
  return index;
}

int GlbWriter::camera_node(glm::dvec3 eye, glm::dvec3 target, double yfov_rad, double near_m) {
  const int index =
      camera({{"type", "perspective"}, {"perspective", {{"yfov", number(yfov_rad)}, {"znear", number(near_m)}}}});
  const glm::dquat rotation = glm::quat_cast(glm::dmat3(look_at_pose(eye, target)));
  return node("camera",
              {{"camera", index}, {"translation", vector_json(eye)}, {"rotation", quaternion_json(rotation)}});
}

void GlbWriter::use_extension(std::string_view name) {
  json& used = root["extensionsUsed"];
  if (std::ranges::find(used, json(name)) == used.end()) used.push_back(name);
}

json& GlbWriter::animation_sampler(std::string_view interpolation, std::span<const double> times_s,
                                   std::span<const double> values, int components) {
  const int input = float_accessor(times_s, 1, true);
  // Weights come as scalars, as many a key as there are targets.
  const int output = float_accessor(values, components);
  if (!root.contains("animations"))
    root["animations"] = json::array({{{"name", "main"}, {"channels", json::array()}, {"samplers", json::array()}}});
  json& animation = root["animations"][0];
  animation["samplers"].push_back({{"input", input}, {"output", output}, {"interpolation", interpolation}});
  animation["channels"].push_back({{"sampler", animation["samplers"].size() - 1}});
  return animation["channels"].back();
}

void GlbWriter::animate(int node, std::string_view path, std::string_view interpolation,
                        std::span<const double> times_s, std::span<const double> values, int components) {
  animation_sampler(interpolation, times_s, values, components)["target"] = {{"node", node}, {"path", path}};
}

void GlbWriter::animate_pointer(std::string_view pointer, std::string_view interpolation,
                                std::span<const double> times_s, std::span<const double> values, int components) {
  use_extension("KHR_animation_pointer");
  animation_sampler(interpolation, times_s, values, components)["target"] = {
      {"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}};
}

std::vector<std::byte> GlbWriter::bytes() const {
  std::vector<std::byte> binary = binary_;
  pad_to_four(binary, std::byte{0});
  json document = root;
  document["buffers"] = json::array({{{"byteLength", binary_.size()}}});
  const std::string text = document.dump();
  std::vector<std::byte> chunk(text.size());
  std::memcpy(chunk.data(), text.data(), text.size());
  pad_to_four(chunk, std::byte{' '});

  std::vector<std::byte> out;
  append_u32(out, 0x46546C67);  // "glTF"
  append_u32(out, 2);
  append_u32(out, uint32_t(12 + 8 + chunk.size() + 8 + binary.size()));
  append_u32(out, uint32_t(chunk.size()));
  append_u32(out, 0x4E4F534A);  // "JSON"
  out.insert(out.end(), chunk.begin(), chunk.end());
  append_u32(out, uint32_t(binary.size()));
  append_u32(out, 0x004E4942);  // "BIN"
  out.insert(out.end(), binary.begin(), binary.end());
  return out;
}

}  // namespace candela
