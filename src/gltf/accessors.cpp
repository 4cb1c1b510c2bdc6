#include "gltf/accessors.h"

#include <cstring>

namespace candela::gltf {
namespace {

int component_count(int type) {
  switch (type) {
    case TINYGLTF_TYPE_SCALAR:
      return 1;
    case TINYGLTF_TYPE_VEC2:
      return 2;
    case TINYGLTF_TYPE_VEC3:
      return 3;
    case TINYGLTF_TYPE_VEC4:
      return 4;
    case TINYGLTF_TYPE_MAT2:
      return 4;
    case TINYGLTF_TYPE_MAT3:
      return 9;
    case TINYGLTF_TYPE_MAT4:
      return 16;
    default:
      return 0;
  }
}

// Checks that count elements fit into the view behind byte_offset.
const std::byte* placed(const Document& document, std::span<const std::byte> view, size_t byte_offset, size_t count,
                        size_t stride, size_t element_bytes, const std::string& path) {
  const bool fits = byte_offset <= view.size() && element_bytes <= view.size() - byte_offset &&
                    (count - 1) <= (view.size() - byte_offset - element_bytes) / stride;
  if (!fits)
    document.refuse(
        path,
        "{} elements of {} bytes, {} bytes apart from offset {}, do not fit into the {} bytes of the buffer view "
        "(ACCESSOR_TOO_LONG)",
        count, element_bytes, stride, byte_offset, view.size());
  return view.data() + byte_offset;
}

template <class T>
T load(const std::byte* from) {
  T value;
  std::memcpy(&value, from, sizeof(T));
  return value;
}

uint32_t load_unsigned(const Document& document, const std::byte* from, int type, const std::string& path) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return load<uint8_t>(from);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return load<uint16_t>(from);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return load<uint32_t>(from);
    default:
      document.refuse(path + "/componentType", "{} is not an unsigned integer type (INVALID_FORMAT)", type);
  }
}

// A copy of the accessor with the sparse values written over its elements.
const std::vector<std::byte>& with_sparse(Document& document, int accessor, const Elements& base,
                                          size_t element_bytes) {
  const auto known = document.sparse.find(accessor);
  if (known != document.sparse.end()) return known->second;
  const auto& sparse = document.model.accessors[size_t(accessor)].sparse;
  const std::string path = base.path + "/sparse";
  if (sparse.count < 1 || size_t(sparse.count) > base.count)
    document.refuse(path + "/count", "{} sparse values for {} elements (ACCESSOR_SPARSE_COUNT_OUT_OF_RANGE)",
                    sparse.count, base.count);
  if (sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0)
    document.refuse(path, "a byte offset is negative (VALUE_NOT_IN_RANGE)");
  const size_t count = size_t(sparse.count), index_bytes = component_bytes(sparse.indices.componentType);
  if (index_bytes == 0) document.refuse(path + "/indices/componentType", "unknown type (VALUE_NOT_IN_LIST)");
  const std::byte* indices =
      placed(document, view_bytes(document, sparse.indices.bufferView, path + "/indices"),
             size_t(sparse.indices.byteOffset), count, index_bytes, index_bytes, path + "/indices");
  const std::byte* values =
      placed(document, view_bytes(document, sparse.values.bufferView, path + "/values"),
             size_t(sparse.values.byteOffset), count, element_bytes, element_bytes, path + "/values");
  document.charge(base.count, element_bytes, base.path + "/count");
  std::vector<std::byte> out(base.count * element_bytes);
  if (base.data)
    for (size_t i = 0; i < base.count; ++i)
      std::memcpy(out.data() + i * element_bytes, base.data + i * base.stride, element_bytes);
  for (size_t i = 0, last = 0; i < count; ++i) {
    const size_t at =
        load_unsigned(document, indices + i * index_bytes, sparse.indices.componentType, path + "/indices");
    if (at >= base.count)
      document.refuse(path + "/indices", "index {} of {} elements (ACCESSOR_SPARSE_INDEX_OOB)", at, base.count);
    if (i > 0 && at <= last)
      document.refuse(path + "/indices", "{} after {} (ACCESSOR_SPARSE_INDICES_NON_INCREASING)", at, last);
    std::memcpy(out.data() + at * element_bytes, values + i * element_bytes, element_bytes);
    last = at;
  }
  return document.sparse.emplace(accessor, std::move(out)).first->second;
}

template <class T>
void convert(const Elements& elements, std::span<const uint32_t> which, std::span<float> out) {
  const size_t count = which.empty() ? elements.count : which.size(), components = size_t(elements.components);
  constexpr bool integer = std::is_integral_v<T>;
  const float largest = integer ? float(std::numeric_limits<T>::max()) : 1.f;
  for (size_t i = 0; i < count; ++i) {
    const std::byte* from = elements.data + (which.empty() ? i : which[i]) * elements.stride;
    for (size_t c = 0; c < components; ++c) {
      float value = float(load<T>(from + c * sizeof(T)));
      if (integer && elements.normalized) value = std::max(value / largest, -1.f);
      out[i * components + c] = value;
    }
  }
}

void check_components(const Document& document, const Elements& elements, int components) {
  if (elements.components != components)
    document.refuse(elements.path + "/type", "elements of {} components where {} are wanted (ACCESSOR_INVALID_FORMAT)",
                    elements.components, components);
}

}  // namespace

size_t component_bytes(int component_type) {
  switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return 4;
    default:
      return 0;
  }
}

Elements elements_of(Document& document, int accessor, const std::string& user) {
  if (accessor < 0 || size_t(accessor) >= document.model.accessors.size())
    document.refuse(user, "there is no accessor {} (UNRESOLVED_REFERENCE)", accessor);
  const tinygltf::Accessor& a = document.model.accessors[size_t(accessor)];
  Elements out;
  out.path = fmt::format("/accessors/{}", accessor);
  out.count = a.count;
  out.components = component_count(a.type);
  out.component_type = a.componentType;
  out.normalized = a.normalized;
  const size_t component = component_bytes(a.componentType), element_bytes = component * size_t(out.components);
  if (component == 0)
    document.refuse(out.path + "/componentType", "{} is no component type (VALUE_NOT_IN_LIST)", a.componentType);
  if (a.count == 0) document.refuse(out.path + "/count", "the accessor has no elements (VALUE_NOT_IN_RANGE)");
  if (component < 4 && (a.type == TINYGLTF_TYPE_MAT2 || a.type == TINYGLTF_TYPE_MAT3))
    document.refuse(out.path, "matrices of padded columns have no use in glTF 2.0 (ACCESSOR_INVALID_FORMAT)");
  out.stride = element_bytes;
  if (a.bufferView != document.missing_view) {
    const std::span<const std::byte> view = view_bytes(document, a.bufferView, out.path + "/bufferView");
    const size_t stride = document.model.bufferViews[size_t(a.bufferView)].byteStride;
    if (stride != 0 && stride < element_bytes)
      document.refuse(fmt::format("/bufferViews/{}/byteStride", a.bufferView),
                      "stride {} is smaller than an element of {} bytes (ACCESSOR_SMALL_BYTESTRIDE)", stride,
                      element_bytes);
    if (stride != 0) out.stride = stride;
    out.data = placed(document, view, a.byteOffset, a.count, out.stride, element_bytes, out.path);
  }
  if (a.sparse.isSparse) {
    const std::vector<std::byte>& whole = with_sparse(document, accessor, out, element_bytes);
    out.data = whole.data();
    out.stride = element_bytes;
  }
  return out;
}

void read_floats(Document& document, const Elements& elements, int components, std::span<const uint32_t> which,
                 std::span<float> out) {
  check_components(document, elements, components);
  if (!elements.data) {
    std::fill(out.begin(), out.end(), 0.f);
    return;
  }
  switch (elements.component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return convert<int8_t>(elements, which, out);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return convert<uint8_t>(elements, which, out);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return convert<int16_t>(elements, which, out);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return convert<uint16_t>(elements, which, out);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return convert<uint32_t>(elements, which, out);
    default:
      break;
  }
  convert<float>(elements, which, out);
  for (size_t i = 0; i < out.size(); ++i)
    if (!std::isfinite(out[i])) {
      const size_t element = i / size_t(components);
      document.refuse(elements.path, "element {} holds {} (ACCESSOR_INVALID_FLOAT)",
                      which.empty() ? element : which[element], out[i]);
    }
}

void read_unsigned(Document& document, const Elements& elements, int components, std::span<const uint32_t> which,
                   std::span<uint32_t> out) {
  check_components(document, elements, components);
  if (!elements.data) {
    std::fill(out.begin(), out.end(), 0u);
    return;
  }
  const size_t bytes = component_bytes(elements.component_type), n = size_t(components);
  for (size_t i = 0; i < out.size(); ++i) {
    const size_t element = which.empty() ? i / n : which[i / n];
    out[i] = load_unsigned(document, elements.data + element * elements.stride + i % n * bytes, elements.component_type,
                           elements.path);
  }
}

std::vector<float> all_floats(Document& document, int accessor, int components, const std::string& user) {
  const Elements elements = elements_of(document, accessor, user);
  document.charge(elements.count, sizeof(float) * size_t(components), elements.path + "/count");
  std::vector<float> out(elements.count * size_t(components));
  read_floats(document, elements, components, {}, out);
  return out;
}

}  // namespace candela::gltf
