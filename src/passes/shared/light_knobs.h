#pragma once
#include <span>
#include <string_view>

#include "base/knob.h"

namespace candela {

// How light lists are made: the knobs `lights.*`, shared by the passes that make and walk them. Apart from cap they
// change time and memory, never a bit of the picture.
enum class LightTest : int { aabb, cone_sphere, capsule, capsule_joint };
enum class LightList : int { automatic, bitmask, compact };
enum class LightOrder : int { automatic, sorted, segments };
struct LightKnobs {
  static constexpr std::string_view name = "lights";
  int test = int(LightTest::capsule_joint);
  int mask = 1;
  int list = int(LightList::automatic);
  int order = int(LightOrder::automatic);  // automatic: sorted, unless the device is a CPU (PlanContext::cpu)
  int tile_px = 32;
  int slices_per_octave = 4;
  int few = 8;
  int memory_mb = 512;
  int sift_over = 64;
  int cap = 0;
  static std::span<const Knob> table();
  bool operator==(const LightKnobs&) const = default;
};

// Where lights without a range end, for the passes that shade under them.
struct LightRangeKnobs {
  static constexpr std::string_view name = "lights";
  static constexpr float by_loss = -1;
  float lost = 0.005f;
  float floor_lux = by_loss;
  static std::span<const Knob> table();
};

}  // namespace candela
