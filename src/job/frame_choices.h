#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "job/job.h"

namespace candela {

// The job whose picture has the same bits as this one's unless lists of lights lose something: by the technique
// `reference`, whose pixels the hardware shades as it does most techniques'; or, for a technique with pixels of its
// own, by that one with every light at every pixel.
Job with_every_light(Job job, const std::string& reference);
// Whether a technique shades other points of surfaces than the hardware does (Technique::own_pixels).
bool has_own_pixels(const std::string& technique);

// Tables for `candela list`, --set and the help text.
std::vector<std::string> technique_names();
std::vector<std::string> transparency_names();
std::vector<std::string> pass_names();
std::vector<std::string> layer_names();
std::vector<std::string> tonemap_names();
std::vector<std::string> view_names();
// A line about a technique or a layer; empty for what is none.
std::string_view technique_description(std::string_view name);
std::string_view transparency_description(std::string_view name);
std::string_view layer_description(std::string_view name);
std::vector<std::string> effect_names();
struct KnobRow {
  std::string pass, knob, value_now, unit, range, levels, description;  // values of choices by their names
  std::string kind;                                                     // what it trades: error, time or look
  std::vector<std::string> sweep;     // values that a sweep of errors measures, the exact one last
  std::vector<std::string> required;  // settings without which it does nothing
  std::vector<std::string> passes;    // whose work it changes
};
std::vector<KnobRow> knob_rows(const std::string& quality);

// The technique that a frame is made by where the job says `auto`, by what bench/results shows to be quickest: on a GPU
// with 64-bit atomics `visibility`, else `clustered`. `why`: a sentence for the user.
inline constexpr std::string_view auto_technique = "auto";
struct ChosenTechnique {
  std::string name, why;
};
ChosenTechnique quickest_technique(bool is_cpu, bool int64_atomics);

}  // namespace candela
