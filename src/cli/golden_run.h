#pragma once
#include "cli/golden_manifest.h"
#include "metrics/gate.h"
#include "report/picture_viewer.h"

namespace candela::cli {

// One golden, rendered and judged.
struct GoldenOutcome {
  enum class Kind { passed, failed, skipped } kind = Kind::failed;
  GateLimits limits;  // of a judged one
  GateResult gate;
  std::string message;           // why it failed, was skipped, or what it is warned of
  GoldenDevice device;           // where it was rendered; empty when it was not
  std::string digest;            // of the new picture; empty when there is none
  bool same_device = false;      // the golden was made there: only its pixels and accepted ones pass
  std::filesystem::path actual;  // the new picture; empty when there is none
  std::filesystem::path golden_png, actual_png, heat_map;  // for the report; of failed ones and those with a warning
  std::optional<ViewedPictures> pictures;                  // the same
  double seconds = 0;
  bool missing = false;  // there is no golden picture
  bool warned() const { return kind == Kind::passed && gate.level == GateLevel::warned; }
};

// Renders into `picture` (made whole or not at all). A frame in which nothing is drawn is an error (input) unless it is
// allowed.
Expected<GoldenDevice> render_golden(const GoldenManifest& golden, const RunSettings& settings, bool allow_blank,
                                     const std::filesystem::path& picture);

// Renders into `folder` and walks the ladder of metrics/gate.h. Errors of the golden itself (missing picture, a scene
// that does not load) are outcomes; only what makes every golden fail alike (no device) is an error. On the device and
// driver that the golden was made on only the same pixels pass, elsewhere what its limits allow; exact: the same pixels
// alone, everywhere.
struct GoldenCheck {
  RunSettings settings;
  bool allow_blank = false, exact = false;
};
GoldenOutcome check_golden(const GoldenManifest& golden, const GoldenCheck& how, const std::filesystem::path& folder);

// What `golden check --report DIR` leaves there for `golden accept DIR`.
inline constexpr const char* golden_run_file = "run.json";

// Of the decoded pixels: size, channel names and values.
std::string picture_digest(const FloatImage& image);

}  // namespace candela::cli
