#include "gltf/modules/draco_module.h"

#include <draco/compression/decode.h>

#include <exception>
#include <memory>
#include <string>

namespace {

template <class T>
bool write_values(const draco::PointAttribute& attribute, uint32_t points, uint32_t components, void* out) {
  T* to = static_cast<T*>(out);
  for (draco::PointIndex point(0); point < points; ++point, to += components)
    if (!attribute.ConvertValue<T>(attribute.mapped_index(point), int8_t(components), to)) return false;
  return true;
}

bool write_attribute(const draco::PointAttribute& attribute, const CandelaDracoRequest& request, uint32_t points,
                     void* out) {
  switch (request.component_type) {
    case 5120:
      return write_values<int8_t>(attribute, points, request.components, out);
    case 5121:
      return write_values<uint8_t>(attribute, points, request.components, out);
    case 5122:
      return write_values<int16_t>(attribute, points, request.components, out);
    case 5123:
      return write_values<uint16_t>(attribute, points, request.components, out);
    case 5125:
      return write_values<uint32_t>(attribute, points, request.components, out);
    case 5126:
      return write_values<float>(attribute, points, request.components, out);
    default:
      return false;
  }
}

std::string decode(const void* bytes, size_t size, const CandelaDracoRequest* requests, uint32_t request_count,
                   const CandelaDracoSink& sink) {
  draco::DecoderBuffer buffer;
  buffer.Init(static_cast<const char*>(bytes), size);
  draco::Decoder decoder;
  auto result = decoder.DecodeMeshFromBuffer(&buffer);
  if (!result.ok()) return std::string("Draco: ") + result.status().error_msg();
  const std::unique_ptr<draco::Mesh> mesh = std::move(result).value();
  const uint32_t points = mesh->num_points(), faces = mesh->num_faces();
  uint32_t* index = sink.indices(sink.user, size_t(faces) * 3);
  if (!index && faces > 0) return "the Draco mesh has more faces than a file of this size can honestly hold";
  for (draco::FaceIndex face(0); face < faces; ++face)
    for (int corner = 0; corner < 3; ++corner) *index++ = mesh->face(face)[size_t(corner)].value();
  for (uint32_t i = 0; i < request_count; ++i) {
    const draco::PointAttribute* attribute = mesh->GetAttributeByUniqueId(requests[i].unique_id);
    if (!attribute) return "the Draco mesh has no attribute with id " + std::to_string(requests[i].unique_id);
    if (attribute->num_components() != int(requests[i].components))
      return "Draco attribute " + std::to_string(requests[i].unique_id) +
             " has another number of components than its accessor";
    void* out = sink.attribute(sink.user, i, points);
    if (!out) return "the Draco mesh has more vertices than a file of this size can honestly hold";
    if (!write_attribute(*attribute, requests[i], points, out))
      return "Draco attribute " + std::to_string(requests[i].unique_id) + " does not convert to its accessor's type";
  }
  return {};
}

}  // namespace

extern "C" __attribute__((visibility("default"))) const char* candela_draco_decode(const void* bytes, size_t size,
                                                                                   const CandelaDracoRequest* requests,
                                                                                   uint32_t request_count,
                                                                                   const CandelaDracoSink* sink) {
  static thread_local std::string message;
  try {
    message = decode(bytes, size, requests, request_count, *sink);
  } catch (const std::exception& e) {
    message = std::string("Draco: ") + e.what();
  }
  return message.empty() ? nullptr : message.c_str();
}
