#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"

namespace candela {

enum class OutputFormat { exr, png };
// By the ending, in any case. Error usage for anything else.
Expected<OutputFormat> output_format(const std::filesystem::path& path);

// An output name with a place for the frame number: %04d, %d or ####. "%%" is a plain percent sign.
struct FramePattern {
  std::string before, after;
  int digits = 0;         // filled up with zeros to this width; 0: as it is
  bool numbered = false;  // false: the same name for every frame
  std::string name(int64_t frame) const;
};
// Errors (usage): more than one place for the number, or a % that is not one.
Expected<FramePattern> parse_pattern(const std::string& text);

// Makes the folder of an output where it is missing, removes what killed runs left of it there, and shows that the name
// is one and that files can be made in the folder. Error output.
Expected<void> prepare_output(const std::filesystem::path& path);

struct Shard {
  int index = 1, count = 1;  // 1-based
};
Expected<Shard> parse_shard(const std::string& text);  // "2/8"
// Interleaved: frame k of the list belongs to shard k mod count + 1, so that slow stretches of a film are shared out.
std::vector<int64_t> shard_of(const std::vector<int64_t>& frames, Shard shard);

}  // namespace candela
