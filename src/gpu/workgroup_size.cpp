#include "gpu/workgroup_size.h"

#include "gpu/spirv.h"

namespace candela::gpu {

using namespace spirv;

std::array<uint32_t, 3> workgroup_size(std::span<const uint32_t> spirv, std::span<const SpecConstant> constants) {
  std::map<uint32_t, uint32_t> values, spec_ids;           // by result id
  std::map<uint32_t, std::array<uint32_t, 3>> composites;  // ids of the first three members
  std::array<uint32_t, 3> literal{}, ids{};
  uint32_t builtin = 0;
  for (size_t at = header_words; at < spirv.size();) {
    const uint32_t length = spirv[at] >> 16, op = spirv[at] & 0xffff;
    if (length == 0 || at + length > spirv.size()) break;
    const auto word = [&](uint32_t i) { return i < length ? spirv[at + i] : 0; };
    if (op == op_execution_mode && word(2) == mode_local_size) literal = {word(3), word(4), word(5)};
    if (op == op_execution_mode_id && word(2) == mode_local_size_id) ids = {word(3), word(4), word(5)};
    if (op == op_constant || op == op_spec_constant) values[word(2)] = word(3);
    if ((op == op_constant_composite || op == op_spec_constant_composite) && length == 6)
      composites[word(2)] = {word(3), word(4), word(5)};
    if (op == op_decorate && word(2) == decoration_spec_id) spec_ids[word(1)] = word(3);
    if (op == op_decorate && word(2) == decoration_builtin && word(3) == builtin_workgroup_size) builtin = word(1);
    at += length;
  }
  for (const auto& [id, spec] : spec_ids)
    for (const SpecConstant& constant : constants)
      if (constant.id == spec && values.contains(id)) values[id] = constant.value;
  if (builtin && composites.contains(builtin)) ids = composites[builtin];  // it overrides the execution mode
  if (ids[0] == 0) return literal;
  return {values[ids[0]], values[ids[1]], values[ids[2]]};
}

}  // namespace candela::gpu
