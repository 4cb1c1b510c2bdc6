#include "glsl/built_in_spirv.h"

// The table, as the assembler takes it from the file that make_spirv made.
asm(".pushsection .rodata\n"
    ".balign 16\n"
    ".globl candela_spirv_table\n"
    ".hidden candela_spirv_table\n"
    "candela_spirv_table:\n"
    ".incbin \"" CANDELA_SPIRV_TABLE
    "\"\n"
    ".globl candela_spirv_table_end\n"
    ".hidden candela_spirv_table_end\n"
    "candela_spirv_table_end:\n"
    ".popsection\n");
extern "C" __attribute__((visibility("hidden"))) const std::byte candela_spirv_table[], candela_spirv_table_end[];

namespace candela::glsl {

std::span<const std::byte> built_in_spirv() { return {candela_spirv_table, candela_spirv_table_end}; }

}  // namespace candela::glsl
