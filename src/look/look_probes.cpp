// Reflection probes of a look file.
#include "look/look_rows.h"

namespace candela::look_rows {
namespace {

struct BoxFields {
  std::optional<glm::dvec3> lowest, highest;
};
struct Keys {
  ReflectionProbe probe;
  std::optional<glm::dvec3> position;
  bool has_box = false;
};

Expected<void> set_box(const Json&, const std::string& place, BoxFields& box, Keys& keys) {
  for (const auto& [corner, name] : {std::pair(&box.lowest, "min"), std::pair(&box.highest, "max")})
    if (!*corner) return wrong(place, fmt::format("lacks {}", name));
  for (int c = 0; c < 3; ++c)
    if (!((*box.lowest)[c] < (*box.highest)[c]))
      return wrong(place, fmt::format("{} of min, {}, is not below that of max, {}", "xyz"[c], (*box.lowest)[c],
                                      (*box.highest)[c]));
  keys.probe.lowest = *box.lowest, keys.probe.highest = *box.highest, keys.has_box = true;
  return {};
}

Expected<void> add_probe(const Json&, const std::string& place, Keys& keys, Look& look) {
  if (!keys.position) return wrong(place, "lacks position");
  if (!keys.has_box) return wrong(place, "lacks box");
  ReflectionProbe& probe = keys.probe;
  probe.position = *keys.position;
  for (int c = 0; c < 3; ++c)
    if (!(probe.lowest[c] < probe.position[c] && probe.position[c] < probe.highest[c]))
      return wrong(place + "/position", fmt::format("{} {} is not inside the box, between {} and {}", "xyz"[c],
                                                    probe.position[c], probe.lowest[c], probe.highest[c]));
  const auto volume = [](const ReflectionProbe& p) {
    const glm::dvec3 size = p.highest - p.lowest;
    return size.x * size.y * size.z;
  };
  const auto larger = std::upper_bound(look.probes.begin(), look.probes.end(), probe,
                                       [&](const auto& a, const auto& b) { return volume(a) < volume(b); });
  look.probes.insert(larger, probe);
  return {};
}

}  // namespace

Row<Look> probes_row() {
  const Rows<BoxFields> corners = {
      point_row<BoxFields>("min", &BoxFields::lowest, "x, y and z of the lowest corner"),
      point_row<BoxFields>("max", &BoxFields::highest, "x, y and z of the highest corner")};
  const Rows<Keys> rows = {
      point_row<Keys>("position", &Keys::position, "metres, world: where the image is taken, inside the box"),
      object_row<Keys, BoxFields>(
          "box", corners, [](Keys&) { return BoxFields{}; }, set_box,
          "metres, world: surfaces in it reflect the image, as if what is seen lay on its faces"),
      fixed_row(number_row<Keys>(
          "fade_m", above_zero(), [](Keys& k) -> double& { return k.probe.fade_m; },
          "metres outside the box, over which the light gives way to the sky's")),
      fixed_row(number_row<Keys>(
          "time_s", {}, [](Keys& k) -> double& { return k.probe.time_s; }, "seconds: of the scene in the image")),
  };
  return objects_row<Look, Keys>("probes", most_reflection_probes, rows, add_probe,
                                 "images of the scene about a point, which surfaces in a box reflect");
}

Expected<void> check_fixed(const Json& j, const std::string& place, const std::string& what) {
  if (!j.is_structured()) return {};
  if (j.is_object() && j.contains("keys"))
    return wrong(place, fmt::format("the value has keys over time; {} the same at all times", what));
  for (const auto& [key, value] : j.items())
    if (auto fixed = check_fixed(value, place + "/" + key, what); !fixed) return fixed;
  return {};
}

}  // namespace candela::look_rows
