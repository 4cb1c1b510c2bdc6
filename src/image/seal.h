#pragma once
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

// A file's length and the hash of all of its bytes, kept in the file itself: a program that writes the picture anew,
// scaled or not, keeps names and texts but not these bytes.
namespace candela {

// Name of the EXR attribute or PNG text, and what stands under it until the file is sealed.
inline constexpr std::string_view seal_name = "candela:seal";
std::string open_seal();

// Fills in the seal of a whole EXR or PNG file that holds an open one; of others nothing is changed.
void seal_file(std::span<std::byte> file);
// Whether the bytes are those that were sealed. Changes them.
bool seal_holds(std::span<std::byte> file);
// The length that the beginning of a file says it had when it was sealed; none: it says nothing.
std::optional<uint64_t> sealed_length(std::span<const std::byte> beginning);

}  // namespace candela
