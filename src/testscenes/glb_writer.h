#pragma once
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "testscenes/procedural_shapes.h"

namespace candela {

using nlohmann::json;

// Numbers as short decimal text, so that the JSON does not depend on the last bit of a sine.
json number(double value);
json vector_json(std::initializer_list<double> values);
json vector_json(glm::dvec3 v);
json quaternion_json(glm::dquat q);  // x, y, z, w

inline void push(std::vector<double>& out, glm::dvec3 v) { out.insert(out.end(), {v.x, v.y, v.z}); }
inline void push(std::vector<double>& out, glm::dquat q) { out.insert(out.end(), {q.x, q.y, q.z, q.w}); }

// A glTF document in the making. The indices that come back are the glTF indices. `root` is open for what has no method
// here.
class GlbWriter {
 public:
  GlbWriter();

  json root;

  int float_accessor(std::span<const double> values, int components, bool with_bounds = false);
  // The same, once for equal values: of animations, whose channels share their times.
  int shared_float_accessor(const std::vector<double>& values, int components, bool with_bounds = false);
  int vec3_accessor(std::span<const glm::dvec3> values, bool with_bounds = false);
  int mat4_accessor(std::span<const glm::dmat4> values);
  int index_accessor(std::span<const uint32_t> index);       // unsigned short where they fit
  int joint_accessor(std::span<const glm::u16vec4> joints);  // unsigned byte

  int unorm8_accessor(std::span<const glm::dvec4> values);  // normalized unsigned bytes, for colours

  // A primitive without a material: {"attributes": ..., "indices": ...}; write once, use with many materials.
  json primitive(const Shape& shape);
  int mesh(std::string_view name, json primitive, int material);
  int material(std::string_view name, json properties);
  int texture(std::string_view name, std::span<const std::byte> png, json sampler = json::object());
  int light(json light);  // also declares KHR_lights_punctual
  int camera(json camera);

  int node(std::string_view name, json properties);  // a root of the scene
  int child(int parent, std::string_view name, json properties);
  // A perspective camera at eye that looks at target.
  int camera_node(glm::dvec3 eye, glm::dvec3 target, double yfov_rad, double near_m = 0.1);

  void use_extension(std::string_view name);
  // Channels of one animation. values: keys * components (cubic splines: three times as many).
  void animate(int node, std::string_view path, std::string_view interpolation, std::span<const double> times_s,
               std::span<const double> values, int components);
  void animate_pointer(std::string_view pointer, std::string_view interpolation, std::span<const double> times_s,
                       std::span<const double> values, int components);

  std::vector<std::byte> bytes() const;  // the .glb file

 private:
  int add(std::string_view array, json value);
  int view(std::span<const std::byte> data, int target);
  int accessor(std::span<const std::byte> data, int component_type, size_t count, std::string_view type, int target);
  json& animation_sampler(std::string_view interpolation, std::span<const double> times_s,
                          std::span<const double> values, int components);

  std::vector<std::byte> binary_;
  std::map<std::tuple<int, bool, std::vector<double>>, int> shared_;
};

}  // namespace candela
