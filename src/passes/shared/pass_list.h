#pragma once
#include <span>
#include <string_view>
#include <vector>

#include "passes/shared/pass.h"

namespace candela {

// A pass without its type: what names, layers and effects there are, and whose work a knob changes.
struct PassInfo {
  std::string_view name;
  std::string_view effect;  // empty: of none
  std::span<const std::string_view> shading_effects;
  std::span<const LayerName> layers;
  // The tables of knobs that change its work: its own, shared ones, and those that what it is handed follows from.
  std::vector<KnobTableId> knob_tables;
};
// In the order of passes/all_passes.h.
std::span<const PassInfo> pass_list();

}  // namespace candela
