#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "graph/pipeline_desc.h"

namespace candela::gpu {

// The workgroup size that a compute shader's SPIR-V states, with the specialization constants applied. {0,0,0} when it
// states none.
std::array<uint32_t, 3> workgroup_size(std::span<const uint32_t> spirv, std::span<const SpecConstant> constants);

}  // namespace candela::gpu
