#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "job/job.h"

namespace candela::cli {

// golden/<name>/golden.json: how a picture is made and what it may differ by. Beside it lies golden.png or golden.exr.
//   scene    relative to the golden's folder's repository (the parent of the root), or "assets:PATH" below --assets, or
//            "made:NAME", a generated scene of seed 1, which is made for the render and removed after it
//   sky      likewise ("made:NAME": the sky of that generated scene); absent: none
//   job      the keys of a job's JSON, without scene and sky
//   frame, fps  or  time
//   gate     limits of the ladder (metrics/gate.h)
//   accepted  per device class the digests of decoded pixels that are right there besides the picture's own: texts, or
//            objects with the digest, device, driver, who accepted it, at which commit and why
//   made     device class, device, driver and version of the last update, who made it and at which commit
//   also_made  the same of pictures of other device classes: golden.CLASS.png or .exr
// docs/using/goldens.md is the page for users, docs/schemas/golden.schema.json the schema.
inline constexpr std::string_view made_prefix = "made:";  // of job.scene and job.sky
// What a picture was rendered by. Pictures of one device and driver have the same bytes: lavapipe's names hold the
// version of LLVM and the width of its vectors, which it chooses by the processor.
struct GoldenDevice {
  std::string device_class, device, driver;
  bool operator==(const GoldenDevice&) const = default;
};
struct GoldenManifest {
  std::string name;
  std::filesystem::path folder;
  Job job;                      // scene and sky resolved
  bool missing_assets = false;  // the assets folder is not there
  std::optional<int64_t> frame;
  FrameRate rate;
  double time_s = 0;
  bool exr = false;  // the picture is golden.exr
  std::string text;  // the file
  std::map<std::string, std::vector<std::string>> accepted;
  GoldenDevice made;                              // empty: never made
  std::map<std::string, GoldenDevice> also_made;  // by device class
  const char* ending() const { return exr ? ".exr" : ".png"; }
  std::filesystem::path picture() const { return folder / (std::string("golden") + ending()); }
  // Of a device class that does not draw the golden's own.
  std::filesystem::path own_picture(const std::string& device_class) const {
    return folder / ("golden." + device_class + ending());
  }
  // What a device of that class has to draw: its own picture where there is one.
  std::filesystem::path picture_for(const std::string& device_class) const {
    return has_own_picture(device_class) ? own_picture(device_class) : picture();
  }
  bool has_own_picture(const std::string& device_class) const {
    std::error_code failed;
    return std::filesystem::exists(own_picture(device_class), failed);
  }
  // What that picture was made by.
  const GoldenDevice& made_for(const std::string& device_class) const {
    const auto own = also_made.find(device_class);
    return own != also_made.end() && has_own_picture(device_class) ? own->second : made;
  }
};

// All goldens below root whose name contains `filter`, by name. A broken manifest is an error that names file and key.
Expected<std::vector<GoldenManifest>> read_goldens(const std::filesystem::path& root,
                                                   const std::filesystem::path& assets, const std::string& filter);

}  // namespace candela::cli
