#pragma once
#include <cstddef>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "base/knob.h"
#include "graph/builder.h"
#include "scene/survey.h"

namespace candela {

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
