#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "stability/scenes.h"

namespace candela {

// Renders extreme scenes in all techniques and measures each picture against what is true of it: the reference ray
// tracer in double, a plain scene that shows the same, or both.
struct StabilityOptions {
  uint64_t seed = 1;
  bool large = false;
  std::vector<std::string> techniques;     // empty: all
  std::vector<std::string> families;       // empty: all
  std::vector<std::string> only;           // scenes whose "family/name" holds one of these; empty: all
  std::vector<std::pair<int, int>> sizes;  // of the family "images", in pixels; empty: its own
  std::vector<KnobSetting> settings;       // over the scenes' own, but not for plain scenes
  std::string pictures;                    // folder for a PNG and the .glb of each scene; empty: none
  bool thumbnails = false;                 // in the rows of each scene's first picture
};

struct StabilityRow {
  std::string family, scene, what, technique;
  std::string truth;  // what the picture was measured against
  std::string error;  // no picture: why; for a refused scene that is what should be
  uint64_t pixels = 0, nonfinite = 0;
  uint64_t effects_nonfinite = 0;              // with defaults; of the first technique with effects, and with all too
  double max_relative = 0, bound = 0;          // against the reference
  double plain_relative = 0, plain_bound = 0;  // against the plain scene
  uint64_t beyond = 0, may_be_beyond = 0;      // pixels above the reference's bound, and how many edges may be
  double energy = 0, energy_bound = 0;         // gained (or, negative, lost), as a part of the whole
  double display_error = 0;                    // of the 16-bit picture against the curve in double, in parts of one
  uint64_t clamped = 0;                        // values beyond half: what an EXR of halves holds as 65504
  uint64_t differing = 0;                      // pixels that are not bit-equal to the first technique's
  std::vector<std::string> warnings;
  std::vector<std::string> faults;  // empty: as it should be
  std::string worst;                // where the largest error is
  double wall_ms = 0;
  std::vector<std::byte> thumbnail;  // PNG
};

struct StabilityReport {
  std::vector<StabilityRow> rows;
  std::string device, driver;
  uint64_t seed = 0;
  bool large = false;
  int scenes = 0, faulty_rows = 0;
  uint64_t nonfinite = 0;
  double wall_s = 0;
  bool stopped = false;
};
// The largest display error that passes: a fortieth of an 8-bit code value.
inline constexpr double display_bound = 1e-4;

// A suite file of this kind has the key "suite" and chooses among the scenes, which are made from the seed:
//   {"suite": "stability", "name": ..., "description": ..., "families": [...], "only": [...], "sizes": ["1x4096"],
//   "techniques": [...],
//    "seed": 1, "large": false}
// All but the first may be left out. Errors (input) name file and key.
bool names_built_in_suite(const std::filesystem::path& file);
Expected<StabilityOptions> read_stability_suite(const std::filesystem::path& file);
Expected<StabilityOptions> stability_suite_from_json(const std::string& text, const std::string& place);

Expected<StabilityReport> check_stability(const StabilityOptions& options, const RunSettings& settings,
                                          const std::function<bool()>& stop);

}  // namespace candela
