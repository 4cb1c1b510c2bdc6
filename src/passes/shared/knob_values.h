#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <vector>

#include "base/knob.h"
#include "graph/builder.h"
#include "passes/shared/pass.h"
#include "scene/survey.h"

namespace candela {

namespace knobs_detail {
template <class Tuple, class K>
struct Append;
template <class... Ks, class K>
struct Append<std::tuple<Ks...>, K> {
  using type = std::conditional_t<(std::is_same_v<Ks, K> || ...), std::tuple<Ks...>, std::tuple<Ks..., K>>;
};
template <class Tuple, class More>
struct AppendAll {
  using type = Tuple;
};
template <class Tuple, class K, class... More>
struct AppendAll<Tuple, std::tuple<K, More...>> : AppendAll<typename Append<Tuple, K>::type, std::tuple<More...>> {};

// The tables of a pass: its own, and those that it shares.
template <class P>
auto tables_of() {
  if constexpr (HasKnobs<P> && SharesKnobs<P>)
    return typename AppendAll<std::tuple<typename P::Knobs>, typename P::SharedKnobs>::type{};
  else if constexpr (HasKnobs<P>)
    return std::tuple<typename P::Knobs>{};
  else if constexpr (SharesKnobs<P>)
    return typename P::SharedKnobs{};
  else
    return std::tuple<>{};
}
}  // namespace knobs_detail

// A table of knobs without its type.
struct KnobTableInfo {
  KnobTableId id;
  std::string_view name;  // the TABLE of --set
  std::span<const Knob> rows;
  std::vector<std::byte> defaults;  // of the struct
  size_t offset = 0;                // of the struct among all, in bytes
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

  // Tells an open pass of the builder the values that it works with. A table may say that it does nothing in a scene.
  template <class P>
  void declare(GraphBuilder& builder, const P& pass, const SceneFacts& facts) const {
    const auto table = [&]<class K>(const K&) {
      if constexpr (requires { K::matter(facts); })
        if (!K::matter(facts)) return;
      for (const Knob& row : K::table()) {
        if constexpr (IgnoresKnobs<P>)
          if (pass.ignores(row.name)) continue;
        builder.knob(std::string(K::name) + "." + std::string(row.name), row.text(row.value(&get<K>())));
      }
    };
    std::apply([&](const auto&... knobs) { (table(knobs), ...); }, knobs_detail::tables_of<P>());
  }

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
