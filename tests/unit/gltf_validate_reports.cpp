#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "base/files.h"
#include "gltf/validate/validate.h"

// Every file for which the Khronos validator has published a report, against that report; and the real files, which
// must pass.
namespace candela::gltf_validate_reports {
namespace {

namespace fs = std::filesystem;
const fs::path assets = fs::path(CANDELA_SOURCE_DIR) / "../shared/assets";

struct Outcome {
  std::vector<Finding> findings;  // an error of the container or the JSON text comes as one fatal finding
  std::vector<std::string> fatal_codes() const {
    std::vector<std::string> codes;
    for (const Finding& finding : findings)
      if (finding.fatal) codes.push_back(finding.code);
    return codes;
  }
  bool names(const std::string& code, const std::string& pointer) const {
    return std::any_of(findings.begin(), findings.end(),
                       [&](const Finding& f) { return f.code == code && f.path == pointer; });
  }
};

Finding from_error(const Error& error) {
  const size_t open = error.message.rfind('(');
  return {true, error.message.substr(open + 1, error.message.size() - open - 2), error.place, error.message};
}

Outcome check(const fs::path& path) {
  Outcome outcome;
  const std::vector<std::byte> bytes = read_file(path).value();
  const Expected<GltfParts> parts = split_gltf(bytes, path.filename().string(), outcome.findings);
  if (!parts) return outcome;
  const auto document = parse_gltf_json(parts->json, path.filename().string());
  if (!document) {
    outcome.findings.push_back(from_error(document.error()));
    return outcome;
  }
  for (Finding& finding : validate_gltf(*document, *parts)) outcome.findings.push_back(std::move(finding));
  return outcome;
}

std::vector<fs::path> files_below(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string ending = entry.path().extension().string();
    if (ending == ".gltf" || ending == ".glb") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

struct Reported {
  std::set<std::string> errors, all;
  std::vector<std::pair<std::string, std::string>> error_places;
};
Reported read_report(const fs::path& file) {
  Reported reported;
  std::ifstream stream(file.string() + ".report.json");
  const nlohmann::json report = nlohmann::json::parse(stream);
  for (const auto& message : report["issues"]["messages"]) {
    const std::string code = message["code"];
    reported.all.insert(code);
    if (message["severity"] != 0) continue;
    reported.errors.insert(code);
    reported.error_places.emplace_back(code,
                                       message.value("pointer", "byte " + std::to_string(message.value("offset", 0))));
  }
  return reported;
}

std::string list(const Outcome& outcome) {
  std::string text;
  for (const Finding& finding : outcome.findings)
    text += (finding.fatal ? "\n  fatal " : "\n  warning ") + finding.text();
  return text;
}

TEST(ValidateReports, AgreeWithTheKhronosValidator) {
  if (!fs::exists(assets / "malformed")) GTEST_SKIP() << "the folder shared/assets is absent";
  size_t count = 0, same_place = 0, with_errors = 0;
  for (const char* folder : {"khronos-validator", "khronos-validator-ext"}) {
    for (const fs::path& file : files_below(assets / "malformed" / folder)) {
      SCOPED_TRACE(file.string());
      const Reported reported = read_report(file);
      const Outcome outcome = check(file);
      ++count;
      for (const std::string& code : outcome.fatal_codes())
        EXPECT_TRUE(reported.errors.contains(code)) << "fatal here, no error there: " << code << list(outcome);
      if (reported.errors.empty()) continue;
      ++with_errors;
      EXPECT_TRUE(std::any_of(outcome.findings.begin(), outcome.findings.end(),
                              [&](const Finding& f) { return reported.errors.contains(f.code); }))
          << "none of the report's errors is named" << list(outcome);
      const auto named = [&](const auto& place) { return outcome.names(place.first, place.second); };
      if (std::any_of(reported.error_places.begin(), reported.error_places.end(), named))
        ++same_place;
      else if (getenv("SHOW_PLACES"))
        std::cerr << file << list(outcome) << "\n";
    }
  }
  EXPECT_EQ(count, 206u);
  EXPECT_GE(same_place + 7, with_errors)
      << "JSON and container errors have no JSON pointer; the rest must be named in the same place";
}

TEST(ValidateReports, RealFilesPass) {
  if (!fs::exists(assets / "khronos")) GTEST_SKIP() << "the folder shared/assets is absent";
  size_t count = 0;
  for (const fs::path& file : files_below(assets)) {
    if (file.string().find("malformed") != std::string::npos) continue;
    SCOPED_TRACE(file.string());
    const Outcome outcome = check(file);
    ++count;
    EXPECT_TRUE(outcome.fatal_codes().empty()) << list(outcome);
    if (getenv("SHOW_WARNINGS") && !outcome.findings.empty()) std::cerr << file << list(outcome) << "\n";
  }
  EXPECT_GE(count, 149u);
}

}  // namespace
}  // namespace candela::gltf_validate_reports
