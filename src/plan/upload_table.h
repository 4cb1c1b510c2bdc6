#pragma once
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/hash.h"
#include "bvh/acceleration_input.h"
#include "passes/shared/scene_inputs.h"
#include "shared/scene.h"

namespace candela {

struct PlannedFrame;
struct GeometryLayout;

// A buffer that comes from the host: its name in the plan, where passes find its handle, what it holds, and where its
// device address stands among the frame's constants.
struct UploadRow {
  const char* name;
  BufferHandle SceneInputs::*input;
  uint64_t size_bytes = 0;           // in the plan; 0: the frame has none
  std::span<const std::byte> bytes;  // empty: of the scene, which GpuScene has under this name
  size_t address_offset = no_address;
  static constexpr size_t no_address = size_t(-1);
  std::optional<Hash128> key = {};  // of content that many frames share: uploaded once, into the device's own memory
  std::shared_ptr<const void> owner = {};  // with a key: who keeps `bytes`, and what follows
  // Acceleration structures are built of it, whose address the content begins with.
  const AccelerationInput* on_device = nullptr;
  bool to_fill = false;  // without bytes: by a pass of the frame, in the device's own memory
};

// Every buffer of the scene and of the frame, each declared here and nowhere else; the constants, which hold the
// others' addresses, come last. The spans point into `frame`. rows: whatever it held, its memory is used again.
void upload_table(const PlannedFrame& frame, const GeometryLayout& layout, std::vector<UploadRow>& rows);

}  // namespace candela
