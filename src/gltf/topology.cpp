#include "gltf/topology.h"

#include <tiny_gltf.h>

#include "base/check.h"

namespace candela::gltf {
namespace {

std::vector<uint32_t> list_of_lines(std::span<const uint32_t> v, bool closed) {
  std::vector<uint32_t> out;
  for (size_t i = 0; i + 1 < v.size(); ++i) out.insert(out.end(), {v[i], v[i + 1]});
  if (closed && v.size() > 2) out.insert(out.end(), {v.back(), v.front()});
  return out;
}

std::vector<uint32_t> list_of_strip(std::span<const uint32_t> v) {
  std::vector<uint32_t> out;
  for (size_t i = 0; i + 2 < v.size(); ++i) out.insert(out.end(), {v[i], v[i + 1 + i % 2], v[i + 2 - i % 2]});
  return out;
}

std::vector<uint32_t> list_of_fan(std::span<const uint32_t> v) {
  std::vector<uint32_t> out;
  for (size_t i = 0; i + 2 < v.size(); ++i) out.insert(out.end(), {v[i + 1], v[i + 2], v[0]});
  return out;
}

}  // namespace

Topology topology_of(int mode) {
  CHECK(mode >= 0 && mode <= 6);
  return mode == TINYGLTF_MODE_POINTS       ? Topology::points
         : mode <= TINYGLTF_MODE_LINE_STRIP ? Topology::lines
                                            : Topology::triangles;
}

bool has_leftovers(int mode, size_t vertices) {
  switch (mode) {
    case TINYGLTF_MODE_POINTS:
      return vertices < 1;
    case TINYGLTF_MODE_LINE:
      return vertices < 2 || vertices % 2 != 0;
    case TINYGLTF_MODE_LINE_LOOP:
    case TINYGLTF_MODE_LINE_STRIP:
      return vertices < 2;
    case TINYGLTF_MODE_TRIANGLES:
      return vertices < 3 || vertices % 3 != 0;
    default:
      return vertices < 3;
  }
}

std::vector<uint32_t> expanded_to_list(int mode, std::span<const uint32_t> v) {
  switch (mode) {
    case TINYGLTF_MODE_LINE:
      return {v.begin(), v.end() - ptrdiff_t(v.size() % 2)};
    case TINYGLTF_MODE_LINE_LOOP:
      return list_of_lines(v, true);
    case TINYGLTF_MODE_LINE_STRIP:
      return list_of_lines(v, false);
    case TINYGLTF_MODE_TRIANGLES:
      return {v.begin(), v.end() - ptrdiff_t(v.size() % 3)};
    case TINYGLTF_MODE_TRIANGLE_STRIP:
      return list_of_strip(v);
    case TINYGLTF_MODE_TRIANGLE_FAN:
      return list_of_fan(v);
    default:
      return {v.begin(), v.end()};
  }
}

}  // namespace candela::gltf
