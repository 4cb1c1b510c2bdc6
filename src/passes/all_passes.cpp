#include "passes/all_passes.h"

#include <algorithm>
#include <cstring>

#include "base/check.h"
#include "base/fields.h"
#include "passes/shadows/lamp_knobs.h"
#include "passes/shadows/sun_knobs.h"
#include "passes/shared/knob_values.h"
#include "passes/shared/pass_list.h"

namespace candela {
namespace {

template <class... P, class F>
void each_pass(std::type_identity<PassList<P...>>, F&& f) {
  (f(std::type_identity<P>{}), ...);
}

template <class Tuple, class F>
void each_table(std::type_identity<Tuple>, F&& f) {
  [&]<class... K>(std::type_identity<std::tuple<K...>>) { (f(knob_table_id<K>()), ...); }(std::type_identity<Tuple>{});
}

template <class P>
PassInfo info_of() {
  PassInfo info;
  info.name = P::name;
  if constexpr (IsEffect<P>) info.effect = P::effect;
  if constexpr (ShadesEffect<P>) info.shading_effects = P::shading_effects;
  if constexpr (HasLayers<P>) info.layers = P::layers;
  const auto add = [&](KnobTableId table) {
    if (std::ranges::find(info.knob_tables, table) == info.knob_tables.end()) info.knob_tables.push_back(table);
  };
  for (const KnobTableId table : own_knob_tables<P>()) add(table);
  if constexpr (FollowsKnobs<P>) each_table(std::type_identity<typename P::InputKnobs>{}, add);
  typename P::In in{};
  for_each_field(in, [&]<class T>(const T&) {
    if constexpr (requires { typename T::MadeBy; }) each_table(std::type_identity<typename T::MadeBy>{}, add);
  });
  return info;
}

template <class K>
void add_table(std::vector<KnobTableInfo>& tables) {
  static_assert(std::is_trivially_copyable_v<K> && alignof(K) <= alignof(int) && sizeof(K) % alignof(int) == 0);
  if (std::ranges::find(tables, knob_table_id<K>(), &KnobTableInfo::id) != tables.end()) return;
  const K knobs{};
  KnobTableInfo info{knob_table_id<K>(), K::name, K::table(), std::vector<std::byte>(sizeof(K)), 0};
  std::memcpy(info.defaults.data(), &knobs, sizeof(K));
  if (!tables.empty()) info.offset = tables.back().offset + tables.back().defaults.size();
  if constexpr (requires(const SceneFacts& facts) { K::matter(facts); }) info.matters = &K::matter;
  tables.push_back(std::move(info));
}

}  // namespace

std::span<const PassInfo> pass_list() {
  static const std::vector<PassInfo> passes = [] {
    std::vector<PassInfo> list;
    each_pass(std::type_identity<AllPasses>{}, [&]<class P>(std::type_identity<P>) { list.push_back(info_of<P>()); });
    return list;
  }();
  return passes;
}

std::span<const KnobTableInfo> knob_tables() {
  static const std::vector<KnobTableInfo> tables = [] {
    std::vector<KnobTableInfo> list;
    each_pass(std::type_identity<AllPasses>{}, [&]<class P>(std::type_identity<P>) {
      if constexpr (HasKnobs<P>) add_table<typename P::Knobs>(list);
      if constexpr (SharesKnobs<P>)
        [&]<class... K>(std::type_identity<std::tuple<K...>>) {
          (add_table<K>(list), ...);
        }(std::type_identity<typename P::SharedKnobs>{});
    });
    return list;
  }();
  return tables;
}

KnobValues::KnobValues() {
  for (const KnobTableInfo& table : knob_tables())
    bytes_.insert(bytes_.end(), table.defaults.begin(), table.defaults.end());
}

void KnobValues::declare(GraphBuilder& builder, std::span<const KnobTableId> tables, const SceneFacts& facts,
                         const std::function<bool(std::string_view)>& ignored) const {
  for (const KnobTableId id : tables) {
    const auto found = std::ranges::find(knob_tables(), id, &KnobTableInfo::id);
    CHECK_MSG(found != knob_tables().end(), "no pass of the list has or shares this table of knobs");
    const KnobTableInfo& table = *found;
    if (table.matters && !table.matters(facts)) continue;
    for (const Knob& row : table.rows)
      if (!ignored(row.name)) builder.knob(fmt::format("{}.{}", table.name, row.name), row.text(value(table, row)));
  }
}

size_t KnobValues::offset_of_table(KnobTableId id) {
  const auto found = std::ranges::find(knob_tables(), id, &KnobTableInfo::id);
  CHECK_MSG(found != knob_tables().end(), "no pass has or shares this table of knobs");
  return found->offset;
}

}  // namespace candela
