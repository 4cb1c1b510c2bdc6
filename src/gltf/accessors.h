#pragma once
#include "gltf/document.h"

// Accessors as plain arrays: sparse, strided, normalised and quantized ones alike; every byte range is checked.
namespace candela::gltf {

// Where an accessor's elements lie: element i begins at data + i * stride. data is null for elements that are all zero.
struct Elements {
  const std::byte* data = nullptr;
  size_t count = 0, stride = 0;
  int components = 0, component_type = 0;  // glTF's numbers: 5126 float, ...
  bool normalized = false;
  std::string path;  // "/accessors/3"
};
size_t component_bytes(int component_type);  // 0 for unknown types
// `user` is the JSON path of the reference, for messages. Throws Failure.
Elements elements_of(Document& document, int accessor, const std::string& user);

// Floats, `components` an element. Normalised integers become [0,1] or [-1,1] as section 3.6.2.2 says, others keep
// their value. `which` lists elements; empty means all. Refuses other component counts and values that are not finite.
void read_floats(Document& document, const Elements& elements, int components, std::span<const uint32_t> which,
                 std::span<float> out);
// Unsigned integers of 8, 16 or 32 bits.
void read_unsigned(Document& document, const Elements& elements, int components, std::span<const uint32_t> which,
                   std::span<uint32_t> out);

// A whole accessor, charged to the document's memory.
std::vector<float> all_floats(Document& document, int accessor, int components, const std::string& user);

// V: a glm vector of floats.
template <class V>
std::vector<V> read_vectors(Document& document, const Elements& elements, std::span<const uint32_t> which) {
  const size_t count = which.empty() ? elements.count : which.size();
  document.charge(count, sizeof(V), elements.path);
  std::vector<V> out(count);
  static_assert(sizeof(V) == sizeof(float) * size_t(V::length()));
  read_floats(document, elements, V::length(), which,
              std::span(reinterpret_cast<float*>(out.data()), count * size_t(V::length())));
  return out;
}

}  // namespace candela::gltf
