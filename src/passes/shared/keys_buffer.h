#pragma once
#include "passes/shared/scene_inputs.h"

namespace candela {

// Of a visibility buffer's keys, pixel by pixel and in it sample by sample.
inline BufferDesc keys_buffer(const SceneInputs& s) {
  BufferDesc keys{"keys"};
  keys.row_bytes = uint64_t(s.width_px) * s.samples * sizeof(uint64_t);
  keys.size_bytes = s.height_px * keys.row_bytes;
  return keys;
}

}  // namespace candela
