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
  std::vector<KnobTableId> own_tables;  // of knobs: its own and those that it shares
  // The tables of knobs that change its work: these, and those that what it is handed follows from.
  std::vector<KnobTableId> knob_tables;
};
// In the order of passes/all_passes.h.
std::span<const PassInfo> pass_list();
const PassInfo& pass_info(std::string_view name);  // of one in the list

}  // namespace candela
