#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/hash.h"

// SPIR-V that the program brings along: what plans usually hold (shaders/built_in.txt), compiled while the program is
// built (tools/make_spirv.cpp).
namespace candela::glsl {

// A table: the number of shaders, 64 bits; for each, by key, the key, the offset of its words in bytes from the table's
// begin, and their number, 64 bits each; then the words.
std::span<const std::byte> built_in_spirv();
// The lines of built_in.txt: shaders as ShaderCompiler::compile() takes them. '//' begins a comment.
std::vector<std::string> listed_shaders(std::string_view text);

struct BuiltIn {
  Hash128 key;
  uint64_t offset, words;
};
std::vector<std::byte> spirv_table(const std::vector<std::pair<Hash128, std::vector<uint32_t>>>& shaders);
std::optional<std::vector<uint32_t>> find_spirv(std::span<const std::byte> table, const Hash128& key);

}  // namespace candela::glsl
