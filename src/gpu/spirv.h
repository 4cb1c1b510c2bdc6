#pragma once
#include <cstddef>
#include <cstdint>

// What is read of SPIR-V: numbers of the specification 1.6, sections 2.3 (header), 3.3 (modes), 3.20
// (decorations), 3.21 (built-ins) and 3.49 (instructions).
namespace candela::gpu::spirv {

constexpr size_t header_words = 5;
enum : uint32_t {
  op_name = 5,
  op_entry_point = 15,
  op_execution_mode = 16,
  op_type_bool = 20,
  op_type_int = 21,
  op_constant_true = 41,
  op_constant_false = 42,
  op_constant = 43,
  op_constant_composite = 44,
  op_spec_constant_true = 48,
  op_spec_constant_false = 49,
  op_spec_constant = 50,
  op_spec_constant_composite = 51,
  op_spec_constant_op = 52,
  op_function = 54,
  op_function_parameter = 55,
  op_function_end = 56,
  op_function_call = 57,
  op_store = 62,
  op_copy_memory = 63,
  op_copy_memory_sized = 64,
  op_decorate = 71,
  op_copy_object = 83,
  op_image_write = 99,
  op_iadd = 128,
  op_isub = 130,
  op_imul = 132,
  op_logical_equal = 164,
  op_logical_not_equal = 165,
  op_logical_or = 166,
  op_logical_and = 167,
  op_logical_not = 168,
  op_select = 169,
  op_iequal = 170,
  op_inotequal = 171,
  op_ugreater = 172,
  op_sgreater = 173,
  op_ugreater_equal = 174,
  op_sgreater_equal = 175,
  op_uless = 176,
  op_sless = 177,
  op_uless_equal = 178,
  op_sless_equal = 179,
  op_shift_right = 194,
  op_shift_left = 196,
  op_bit_or = 197,
  op_bit_xor = 198,
  op_bit_and = 199,
  op_control_barrier = 224,
  op_memory_barrier = 225,
  op_atomic_store = 228,
  op_phi = 245,
  op_loop_merge = 246,
  op_selection_merge = 247,
  op_label = 248,
  op_branch = 249,
  op_branch_conditional = 250,
  op_switch = 251,
  op_kill = 252,
  op_unreachable = 255,
  op_execution_mode_id = 331,
  op_terminate_invocation = 4416,
  first_without_name = 4445,  // of ray tracing and ray queries; whatever has a result keeps its decorations
};
enum : uint32_t { mode_local_size = 17, mode_local_size_id = 38 };
enum : uint32_t { decoration_spec_id = 1, decoration_builtin = 11 };
enum : uint32_t { builtin_workgroup_size = 25 };

}  // namespace candela::gpu::spirv
