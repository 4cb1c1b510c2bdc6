// Our silhouettes against other engines' pictures of the same models (glTF Render Fidelity), framed as their manifest
// says.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "image/io.h"
#include "render/outputs.h"
#include "session/session.h"

namespace candela {
namespace {
namespace fs = std::filesystem;

const fs::path shared_folder = fs::path(CANDELA_SOURCE_DIR) / ".." / "shared";

struct Row {
  std::string model;
  glm::dvec3 target, eye;
  std::vector<std::string> engines;
};

std::string trimmed(const std::string& text) {
  const size_t first = text.find_first_not_of(' ');
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(' ') - first + 1);
}
std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::stringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) parts.push_back(trimmed(part));
  return parts;
}
glm::dvec3 vector_of(const std::string& text) {
  const auto parts = split(text, ',');
  return {std::stod(parts.at(0)), std::stod(parts.at(1)), std::stod(parts.at(2))};
}

// The table of goldens/MANIFEST.md: model, file, size, target, orbit, eye, engines, note, silhouette IoU of another
// renderer.
std::vector<Row> manifest_rows() {
  std::vector<Row> rows;
  std::ifstream file(shared_folder / "goldens" / "MANIFEST.md");
  for (std::string line; std::getline(file, line);) {
    const auto cells = split(line, '|');
    const bool has_outline = cells.size() >= 10 && !cells[9].empty() && std::isdigit(cells[9][0]);
    if (has_outline) rows.push_back({cells[1], vector_of(cells[4]), vector_of(cells[6]), split(cells[7], ',')});
  }
  return rows;
}

fs::path model_file(const std::string& model) {
  const std::string folder = model == "BoxTexturedNonPowerOfTwo" ? "BoxTextured" : model;
  const fs::path root = shared_folder / "assets" / "khronos" / folder;
  for (const auto& entry : fs::recursive_directory_iterator(root))
    if (entry.path().extension() == ".gltf" || entry.path().extension() == ".glb") return entry.path();
  return {};
}

std::vector<bool> coverage_of(const Channel& alpha) {
  std::vector<bool> covered;
  for (const float a : alpha.f) covered.push_back(a > 0.5f);
  return covered;
}

double intersection_over_union(const std::vector<bool>& a, const std::vector<bool>& b) {
  size_t both = 0, either = 0;
  for (size_t i = 0; i < a.size(); ++i) both += a[i] && b[i], either += a[i] || b[i];
  return either ? double(both) / double(either) : 0;
}

Expected<std::vector<bool>> our_coverage(const Row& row, int width, int height) {
  Job job;
  job.scene = model_file(row.model).string();
  job.animation = "none";
  job.camera.eye = row.eye;
  job.camera.target = row.target;
  job.camera.yfov_deg = 45;
  job.width_px = width;
  job.height_px = height;
  const auto session = Session::open(job, {true, false, 8}, {.device = "cpu", .validate = true});
  if (!session) return std::unexpected(session.error());
  const auto frame = (*session)->render(0);
  if (!frame) return std::unexpected(frame.error());
  NonFinite nonfinite;
  const FloatImage image = linear_image(*frame, job, **session, 0, FrameRate{}, nonfinite);
  return coverage_of(*image.find("A"));
}

// Named here, so that each is counted where the pictures are not there.
const char* const models[] = {"AlphaBlendModeTest",
                              "AnimatedCube",
                              "AnimatedMorphCube",
                              "AttenuationTest",
                              "BoxTextured",
                              "BoxTexturedNonPowerOfTwo",
                              "CesiumMan",
                              "CesiumMilkTruck",
                              "ClearCoatTest",
                              "FlightHelmet",
                              "Fox",
                              "InterpolationTest",
                              "MorphPrimitivesTest",
                              "MorphStressTest",
                              "NormalTangentMirrorTest",
                              "NormalTangentTest",
                              "OrientationTest",
                              "RiggedSimple",
                              "SimpleMorph",
                              "SimpleSkin",
                              "SimpleSparseAccessor",
                              "TextureSettingsTest",
                              "TextureTransformTest",
                              "TransmissionRoughnessTest",
                              "Triangle",
                              "TriangleWithoutIndices",
                              "TwoSidedPlane",
                              "UnlitTest",
                              "VertexColorTest"};

class Silhouette : public testing::TestWithParam<const char*> {};

// Engines pose some models differently, so the best agreement of all counts (the manifest names the differences).
TEST_P(Silhouette, AgreesWithAnotherEngine) {
  if (!fs::exists(shared_folder / "goldens")) GTEST_SKIP() << "the folder shared/goldens is absent";
  const std::vector<Row> rows = manifest_rows();
  const auto row = std::ranges::find(rows, GetParam(), &Row::model);
  ASSERT_NE(row, rows.end()) << "the manifest has no such model";
  double best = 0;
  std::string best_engine;
  std::map<std::pair<int, int>, std::vector<bool>> ours;
  for (const std::string& engine : row->engines) {
    const auto theirs = read_image(shared_folder / "goldens" / row->model / (engine + ".webp"));
    ASSERT_TRUE(theirs) << theirs.error().text();
    const Channel* alpha = theirs->find("A");
    if (!alpha) continue;
    auto& coverage = ours[{theirs->width, theirs->height}];
    if (coverage.empty()) {
      auto made = our_coverage(*row, theirs->width, theirs->height);
      ASSERT_TRUE(made) << made.error().text();
      coverage = std::move(*made);
    }
    const double agreement = intersection_over_union(coverage, coverage_of(*alpha));
    if (agreement > best) best = agreement, best_engine = engine;
  }
  RecordProperty("iou", std::to_string(best));
  std::printf("%-26s %.4f (%s)\n", row->model.c_str(), best, best_engine.c_str());
  EXPECT_GT(best, 0.97);
}

INSTANTIATE_TEST_SUITE_P(Engines, Silhouette, testing::ValuesIn(models),
                         [](const testing::TestParamInfo<const char*>& info) { return info.param; });

TEST(SilhouetteManifest, HasTheseModelsAndNoOther) {
  if (!fs::exists(shared_folder / "goldens")) GTEST_SKIP() << "the folder shared/goldens is absent";
  std::vector<std::string> named;
  for (const Row& row : manifest_rows()) named.push_back(row.model);
  EXPECT_EQ(named, std::vector<std::string>(std::begin(models), std::end(models)));
}

}  // namespace
}  // namespace candela
