#pragma once
#include <nlohmann/json_fwd.hpp>
#include <set>
#include <string>

#include "base/error.h"
#include "scene/scene.h"
#include "session/session.h"

namespace candela::cli {

// Notes of several frames, each once: what differs in its numbers alone is the same.
class SaidOnce {
 public:
  void note(const std::string& text);
  bool tones = false;  // of a frame were said (note_tones)

 private:
  std::set<std::string> said_;
};

// What --strict makes an error of kind input.
enum class Strictness : uint8_t {
  none,
  loss,  // warnings that tell of a loss (gltf/losses.h)
  all,   // any warning, an ignored extension, a frame in which nothing is drawn
};

// Of the option's text: empty, loss or all.
Strictness strictness(std::string_view text);

// Warnings and extensions of a scene to the log.
Expected<void> note_scene(const Scene& scene, Strictness strict);
// A frame's warnings to the log, each once and whatever its numbers, and to `warnings`, with theirs.
Expected<void> note_frame(const FrameResult& frame, const Scene& scene, Strictness strict,
                          std::vector<std::string>& warnings);
nlohmann::ordered_json extensions_json(const Scene& scene);

// A picture in which nothing was drawn or every pixel is black, with what may be the reason; empty for any other. Under
// a sky or background: in which nothing reaches into the view.
std::string blank_warning(const FrameResult& frame, const Job& job, const Scene& scene);
// A sentence about a picture of which more than a fifth is clipped to white or less than a hundredth is above black,
// with the exposure that mends it; empty for any other.
std::string tone_note(const FrameResult& frame, const Job& job);
// The same to the log, of the first frame that deserves it.
void note_tones(const FrameResult& frame, const Job& job, SaidOnce& said);

// Such a warning to the log and to `warnings`; strict, and not allowed: an error of kind input.
struct BlankRules {
  bool strict = false, allowed = false;
  std::optional<int64_t> frame;  // of a sequence, for the message
};
Expected<void> note_blank(const FrameResult& frame, const Job& job, const Scene& scene, const BlankRules& rules,
                          std::vector<std::string>& warnings);

}  // namespace candela::cli
