#pragma once
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "bench/suite.h"

namespace candela {

// Renders scenes in all techniques and counts pixels that are not bit-equal to the reference technique's: light lists
// may change the time, never the picture.
struct ExactnessOptions {
  int fields = 200;                                                // seeded, of the generated scene light-field
  uint64_t seed = 1;                                               // of the first
  std::vector<std::pair<int, int>> sizes = {{96, 64}, {101, 67}};  // the second is no multiple of any tile
  std::vector<int> samples = {1, 4};
  std::vector<SuiteTechnique> techniques;  // empty: all, each as it is and with knobs drawn by lot
  std::string reference = "brute-force";
  std::vector<SuiteScene> scenes;  // beside the fields
};
// Scenes with lights among the assets, and generated ones, two of them with very many; those that are not there carry
// the reason.
std::vector<SuiteScene> scenes_with_lights(const std::filesystem::path& assets);

// Over all sizes, sample counts and, of fields, seeds.
struct ExactnessRow {
  std::string scene, technique;  // technique: with its settings
  uint64_t pictures = 0, differing_pictures = 0, differing_pixels = 0;
  double max_difference = 0;
  std::string worst;  // how to see the picture with the most differing pixels again
  uint64_t worst_pixels = 0;
};
struct ExactnessReport {
  std::vector<ExactnessRow> rows;
  std::vector<std::string> skipped;  // scenes, with reasons
  std::string device, driver;
  uint64_t pictures = 0, differing_pixels = 0;
  double wall_s = 0;
  bool stopped = false;
};
Expected<ExactnessReport> check_exactness(const ExactnessOptions& options, const RunSettings& settings,
                                          const std::function<bool()>& stop);

// Knobs that must not change the picture, with the values that are drawn; and those that do. Together they are all
// knobs there are (a test).
struct DrawnKnob {
  std::string pass, knob;
  std::vector<std::string> values;
};
std::span<const DrawnKnob> drawn_knobs();
std::vector<std::string> picture_changing_knobs();
std::vector<KnobSetting> drawn_settings(uint64_t seed);
// How many lights the field of a seed has: from 1 to 512, each factor of 2 as often.
int lights_of_field(uint64_t seed);

}  // namespace candela
