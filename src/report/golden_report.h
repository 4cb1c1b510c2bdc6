#pragma once
#include <cmath>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "report/page.h"
#include "report/picture_viewer.h"

namespace candela {

// One golden as judged; every number was computed before. Picture paths may be empty where there is no picture.
struct GoldenRow {
  std::string name;     // scene and view: unique in a report
  std::string verdict;  // "identical", "nearly identical", "similar", "warned", "failed", "missing golden", ...
  bool passed = false;
  bool warned = false;  // passed, but somebody should look
  bool blank = false;   // the frame shows a single colour
  std::string message;
  std::string device_class, device;
  double time_s = 0;
  std::map<std::string, double> metrics;
  struct Bound {
    std::string name;
    double value = 0;
    double fails = NAN, warns = NAN, clean = NAN;  // what is beyond fails, is warned of, is looked at by FLIP; or none
  };
  std::vector<Bound> bounds;                       // what the gate compared
  std::filesystem::path golden, actual, heat_map;  // PNG
  std::optional<ViewedPictures> pictures;          // where there are two to compare; else the files are shown
};

// One HTML page without other files: pictures lie inside as base64, in viewers (report/picture_viewer.h). Failures
// first, then warned and blank, then the rest by name; the pictures of clean passes are left out. A picture that
// cannot be read is named in its place, not an error. head: title and facts; how many failed is added to its findings.
std::string golden_html(std::span<const GoldenRow> rows, PageHead head);
// JUnit XML as CI systems read it: a test case a row, class name "golden.<device class>".
std::string golden_junit(std::span<const GoldenRow> rows, const std::string& suite);

Expected<void> write_golden_html(const std::filesystem::path& path, std::span<const GoldenRow> rows,
                                 const PageHead& head);
Expected<void> write_golden_junit(const std::filesystem::path& path, std::span<const GoldenRow> rows,
                                  const std::string& suite);

}  // namespace candela
