#include "gltf/draco.h"

#include <dlfcn.h>

#include "base/modules.h"
#include "gltf/modules/draco_module.h"

namespace candela::gltf {
namespace {

struct Decoder {
  CandelaDracoDecode* decode = nullptr;
  std::string why;
};

const Decoder& draco_decoder() {
  static const Decoder decoder = [] {
    Decoder d;
    const Module module = open_module("candela_draco.so");
    if (module.library) d.decode = reinterpret_cast<CandelaDracoDecode*>(dlsym(module.library, "candela_draco_decode"));
    if (!d.decode)
      d.why = fmt::format("the Draco module cannot be opened ({})",
                          module.library ? "candela_draco.so is of another version of candela" : module.reason);
    return d;
  }();
  return decoder;
}

struct Target {  // what the module writes into
  Document* document;
  DracoPrimitive* out;
  const std::vector<std::string>* semantics;
  const std::string* path;
};

// Exceptions may not cross the C interface: a refusal becomes a null pointer.
uint32_t* make_indices(void* user, size_t count) try {
  Target& t = *static_cast<Target*>(user);
  t.document->charge(count, sizeof(uint32_t), *t.path);
  t.out->index.resize(count);
  return t.out->index.data();
} catch (...) {
  return nullptr;
}

void* make_attribute(void* user, uint32_t request, size_t vertex_count) try {
  Target& t = *static_cast<Target*>(user);
  const std::string& semantic = (*t.semantics)[request];
  Elements& elements = t.out->attributes.at(semantic);
  t.document->charge(vertex_count, elements.stride, *t.path);
  std::vector<std::byte>& values = t.out->values[semantic];
  values.resize(std::max<size_t>(vertex_count * elements.stride, 1));
  t.out->vertex_count = elements.count = vertex_count;
  elements.data = values.data();
  return values.data();
} catch (...) {
  return nullptr;
}

}  // namespace

std::optional<DracoPrimitive> decode_draco(Document& document, const Json& draco, const tinygltf::Primitive& primitive,
                                           const std::string& path, std::string& why) {
  const Decoder& decoder = draco_decoder();
  if (!decoder.decode) {
    why = decoder.why;
    return std::nullopt;
  }
  const int view = index_of(document, draco, "bufferView", size_t(document.missing_view), path);
  const Json* ids = member(draco, "attributes");
  if (view < 0 || !ids || !ids->is_object())
    document.refuse(path, "bufferView and attributes are wanted (UNDEFINED_PROPERTY)");
  const std::span<const std::byte> bytes = view_bytes(document, view, path + "/bufferView");

  DracoPrimitive out;
  std::vector<std::string> semantics;
  std::vector<CandelaDracoRequest> requests;
  for (const auto& [semantic, id] : ids->items()) {
    const auto accessor = primitive.attributes.find(semantic);
    if (accessor == primitive.attributes.end() || !id.is_number_unsigned()) continue;
    // Only the accessor's type counts: it may have no buffer view, and the decoder says how many vertices there are.
    if (accessor->second < 0 || size_t(accessor->second) >= document.model.accessors.size())
      document.refuse(path + "/attributes/" + semantic, "there is no accessor {} (UNRESOLVED_REFERENCE)",
                      accessor->second);
    const tinygltf::Accessor& a = document.model.accessors[size_t(accessor->second)];
    Elements elements;
    elements.path = path + "/attributes/" + semantic;
    elements.components = tinygltf::GetNumComponentsInType(uint32_t(a.type));
    elements.component_type = a.componentType;
    elements.normalized = a.normalized;
    elements.stride = component_bytes(a.componentType) * size_t(elements.components);
    if (elements.components < 1 || elements.components > 4 || elements.stride == 0)
      document.refuse(elements.path, "the accessor's type does not suit a vertex attribute (ACCESSOR_INVALID_FORMAT)");
    requests.push_back({id.get<uint32_t>(), uint32_t(a.componentType), uint32_t(elements.components)});
    semantics.push_back(semantic);
    out.attributes[semantic] = std::move(elements);
  }
  Target target{&document, &out, &semantics, &path};
  const CandelaDracoSink sink{&target, make_indices, make_attribute};
  if (const char* error = decoder.decode(bytes.data(), bytes.size(), requests.data(), uint32_t(requests.size()), &sink))
    document.refuse(path, "{}", error);
  return out;
}

}  // namespace candela::gltf
