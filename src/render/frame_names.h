#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "job/frame_list.h"

namespace candela {

enum class OutputFormat { exr, png };
// By the ending, in any case. Error usage for anything else.
Expected<OutputFormat> output_format(const std::filesystem::path& path);

// An output name with places for the frame number: %04d, ####, {frame:04} or $F4, and %d, {frame} and $F, which fill
// nothing up; and for the camera's name: {camera}. "%%", "{{", "}}" and "{#}" are plain signs, and so is a
// single # in the name of a folder.
struct FramePattern {
  struct Piece {
    enum class Kind { text, frame, camera } kind = Kind::text;
    std::string text;
    int digits = 0;  // of a frame number, filled up with zeros to this width; 0: as it is
  };
  std::vector<Piece> pieces;
  std::string given;
  bool numbered = false, by_camera = false;  // false: the same name for every frame, or camera
  std::string name(int64_t frame, const std::string& camera = {}) const;
  // The frame that a file of this name holds; none: it is no name of the pattern, or has no place for a number.
  std::optional<int64_t> frame_of(const std::filesystem::path& file) const;
  // What stands around the number.
  std::string before_number() const, after_number() const;
};
// Whether the same name may come of both, for numbers of any frames.
bool may_share_names(const FramePattern& a, const FramePattern& b);
// Errors (usage): more than one place for the number, or a sign that begins one and is none.
Expected<FramePattern> parse_pattern(const std::string& text);

// Makes the folder of an output where it is missing, removes what killed runs left of it there, and shows that the name
// is one and that files can be made in the folder. Error output.
Expected<void> prepare_output(const std::filesystem::path& path);

struct Shard {
  int index = 1, count = 1;  // 1-based
};
Expected<Shard> parse_shard(const std::string& text);  // "2/8"
// Interleaved: frame k of the list belongs to shard k mod count + 1, so that slow stretches of a film are shared out.
FrameList shard_of(const FrameList& frames, Shard shard);

}  // namespace candela
