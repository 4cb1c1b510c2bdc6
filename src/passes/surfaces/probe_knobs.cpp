#include "passes/surfaces/probe_knobs.h"

namespace candela {

std::span<const Knob> ProbeKnobs::table() {
  static const Knob rows[] = {
      {.name = "size_px",
       .member = &ProbeKnobs::size_px,
       .unit = "px",
       .lowest = 8,
       .highest = 512,
       .levels = {64, 128, 256, 512},
       .description = "side of each of the six views that a reflection probe takes of the scene",
       .sweep = {16, 32, 64, 128, 256, 512}},
  };
  return rows;
}

bool ProbeKnobs::matter(const SceneFacts& facts) { return facts.probes > 0; }

}  // namespace candela
