#pragma once
#include <algorithm>
#include <cstddef>
#include <functional>
#include <span>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <vector>

#include "base/knob.h"
#include "graph/builder.h"
#include "passes/shared/pass.h"
#include "scene/survey.h"

namespace candela {

// The tables of a pass: its own, and those that it shares.
template <class P>
std::span<const KnobTableId> own_knob_tables() {
  static const std::vector<KnobTableId> tables = [] {
    std::vector<KnobTableId> ids;
    const auto add = [&](KnobTableId id) {
      if (std::ranges::find(ids, id) == ids.end()) ids.push_back(id);
    };
    if constexpr (HasKnobs<P>) add(knob_table_id<typename P::Knobs>());
    if constexpr (SharesKnobs<P>)
      [&]<class... K>(std::type_identity<std::tuple<K...>>) {
        (add(knob_table_id<K>()), ...);
      }(std::type_identity<typename P::SharedKnobs>{});
    return ids;
  }();
  return tables;
}

// A table of knobs without its type.
struct KnobTableInfo {
  KnobTableId id;
  std::string_view name;  // the TABLE of --set
  std::span<const Knob> rows;
  std::vector<std::byte> defaults;  // of the struct
  size_t offset = 0;                // of the struct among all, in bytes
  // Whether it does anything in a scene; null: in every one.
  bool (*matters)(const SceneFacts& facts) = nullptr;
};
// Every table that some pass has or shares, once, in the order of the passes (passes/all_passes.h).
std::span<const KnobTableInfo> knob_tables();

// One value of every knob.
class KnobValues {
 public:
  KnobValues();  // the defaults
  template <KnobTable K>
  const K& get() const {
    return *reinterpret_cast<const K*>(bytes_.data() + offset_of<K>());
  }
  template <KnobTable K>
  K& get() {
    return *reinterpret_cast<K*>(bytes_.data() + offset_of<K>());
  }
  bool operator==(const KnobValues&) const = default;
  double value(const KnobTableInfo& table, const Knob& knob) const { return knob.value(bytes_.data() + table.offset); }
  void set(const KnobTableInfo& table, const Knob& knob, double to) { knob.set(bytes_.data() + table.offset, to); }

  // Tells the open pass of the builder the values of its tables that it works with. ignored: of the knob's name.
  void declare(GraphBuilder& builder, std::span<const KnobTableId> tables, const SceneFacts& facts,
               const std::function<bool(std::string_view)>& ignored) const;

 private:
  template <class K>
  static size_t offset_of() {
    static const size_t offset = offset_of_table(knob_table_id<K>());
    return offset;
  }
  static size_t offset_of_table(KnobTableId id);
  std::vector<std::byte> bytes_;  // the structs of all tables
};

}  // namespace candela
