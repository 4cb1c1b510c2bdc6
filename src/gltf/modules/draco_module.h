#pragma once
#include <stddef.h>
#include <stdint.h>

// The C interface of candela_draco.so, which decodes KHR_draco_mesh_compression. It is opened at first need.
extern "C" {

struct CandelaDracoRequest {
  uint32_t unique_id;       // of the attribute inside the Draco mesh
  uint32_t component_type;  // glTF's number (5121 unsigned byte, 5126 float, ...) that the values are wanted in
  uint32_t components;      // 1 to 4
};

// Memory comes from the caller, who may refuse by returning null.
struct CandelaDracoSink {
  void* user;
  uint32_t* (*indices)(void* user, size_t count);                         // three for each face
  void* (*attribute)(void* user, uint32_t request, size_t vertex_count);  // tightly packed
};

// Null when all went well, else one line that says what is wrong; it stays valid until the thread's next call.
typedef const char* CandelaDracoDecode(const void* bytes, size_t size, const CandelaDracoRequest* requests,
                                       uint32_t request_count, const CandelaDracoSink* sink);
}
