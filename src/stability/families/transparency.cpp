// Blended surfaces by every method of transparency: a thousand in a pixel, next to nothing and all, light beyond what a
// half holds.
#include "job/frame_choices.h"
#include "stability/stage.h"

namespace candela::stability {
namespace {

json see_through(glm::dvec3 color, double alpha, bool unlit = false) {
  json material = lit(color, 0, 0.5);
  material["alphaMode"] = "BLEND";
  material["pbrMetallicRoughness"]["baseColorFactor"][3] = alpha;
  if (unlit) material["extensions"]["KHR_materials_unlit"] = json::object();
  return material;
}

// Sheets as wide as the picture, from the farthest: half a metre to a metre and a half before the eye.
Fill sheets(int count, const std::function<json(int)>& material) {
  return [=](GlbWriter& out) {
    for (const char* extension : {"KHR_materials_unlit", "KHR_materials_emissive_strength"})
      out.use_extension(extension);
    const json sheet = out.primitive(quad(20, 20));
    for (int i = 0; i < count; ++i)
      out.node("sheet", {{"mesh", out.mesh("sheet", sheet, out.material("sheet", material(i)))},
                         {"translation", exact({0, 1, 3 + double(i) / count})}});
  };
}
Fill alike(int count, double alpha) {
  return sheets(count, [=](int) { return see_through({0.9, 0.3, 0.6}, alpha, true); });
}
json shining(double light, double alpha) {
  json material = see_through({0.5, 0.5, 0.5}, alpha);
  material["emissiveFactor"] = {1, 0.5, 0.25};
  material["extensions"]["KHR_materials_emissive_strength"] = {{"emissiveStrength", light}};
  return material;
}

// A square whose left half has alpha 0 and whose right half has alpha 1, or the right half alone.
Fill nothing_and_all(bool both) {
  return [=](GlbWriter& out) {
    Shape halves;
    for (const double left : {-0.75, 0.0}) {
      if (left < 0 && !both) continue;
      const uint32_t first = uint32_t(halves.position.size());
      for (const glm::dvec2 corner : {glm::dvec2(0, 0), glm::dvec2(1, 0), glm::dvec2(1, 1), glm::dvec2(0, 1)}) {
        halves.position.emplace_back(left + 0.75 * corner.x, 1.5 * corner.y - 0.75, 0);
        halves.normal.emplace_back(0, 0, 1);
        halves.color.emplace_back(1, 1, 1, left < 0 ? 0 : 1);
      }
      for (const uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) halves.index.push_back(first + i);
    }
    json material = see_through({0.9, 0.3, 0.6}, 1);
    if (!both) material["alphaMode"] = "OPAQUE";
    place(out, halves, material, {0, 1, 1.5});
  };
}

StabilityScene small(StabilityScene scene, const std::string& method) {
  scene.job.width_px = 12, scene.job.height_px = 9;
  scene.job.transparency = method;
  return scene;
}

// What is true whatever the method.
void add_method(Recipes& all, const std::string& method) {
  const auto add = [&](const char* name, std::string what, std::function<StabilityScene(StabilityInput&)> make) {
    all.push_back({"transparency", std::string(name) + " by " + method, std::move(what),
                   [=](StabilityInput& in) { return small(make(in), method); }});
  };
  for (const auto& [name, alpha] : {std::pair("1000 layers of alpha 0.001", 1e-3),
                                    {"1000 layers of alpha 0.5", 0.5},
                                    {"1000 layers of alpha 1e-7", 1e-7}})
    add(name, "of one colour: one sheet that covers as much", [=](StabilityInput& in) {
      const double together = -std::expm1(1000 * std::log1p(-alpha));
      // The float nearest to 1e-7 is 1e-8 of it off; a thousand products of numbers next to 1 round by 2^-25 each.
      return filled_alike(in, alike(1000, alpha), alike(1, together), 1e-4);
    });
  add("1000 layers", "of two colours: between them, and no more than there is", [](StabilityInput& in) {
    StabilityScene scene =
        filled(in, sheets(1000, [](int i) {
                 return see_through(i % 2 == 0 ? glm::dvec3(1, 0, 0.2) : glm::dvec3(0, 1, 0.2), 0.02, true);
               }));
    scene.reference = false;
    scene.most = 1 + 1e-4;
    return scene;
  });
  add("alpha 0 and 1 in one mesh", "half of it is not there, the other opaque",
      [](StabilityInput& in) { return filled_alike(in, nothing_and_all(true), nothing_and_all(false), 1e-5); });
  add("light of 1e30 under alpha 1e-7", "eight sheets", [](StabilityInput& in) {
    StabilityScene scene = filled(in, sheets(8, [](int) { return shining(1e30, 1e-7); }));
    scene.clamps = true;
    return scene;
  });
  add("light of 1e30 under alpha 1", "eight sheets", [](StabilityInput& in) {
    StabilityScene scene = filled(in, sheets(8, [](int) { return shining(1e30, 1); }));
    scene.clamps = true;
    return scene;
  });
  add("light of 1e6 under alpha 0.5", "a sheet: more than a half holds", [](StabilityInput& in) {
    StabilityScene scene = filled(in, sheets(1, [](int) { return shining(1e6, 0.5); }));
    scene.clamps = true;
    return scene;
  });
  add("light of 3e38 under alpha 1e-15", "a sum of a thousand", [](StabilityInput& in) {
    StabilityScene scene = filled(in, sheets(1000, [](int) { return shining(3e38, 1e-15); }));
    scene.reference = false;
    scene.clamps = true;
    return scene;
  });
}

}  // namespace

void add_transparency(Recipes& all) {
  for (const std::string& method : transparency_names()) add_method(all, method);
  // Methods that keep the order.
  for (const char* method : {"sorted", "layers"})
    all.push_back(
        {"transparency", std::string("1000 colours by ") + method, "lit, alpha 0.003 to 0.02", [=](StabilityInput& in) {
           return small(filled(in, sheets(1000,
                                          [](int i) {
                                            const double t = i / 1000.0;
                                            return see_through({0.5 + 0.5 * std::sin(40 * t), t, 1 - t},
                                                               0.003 + 0.017 * std::abs(std::cos(17 * t)));
                                          })),
                        method);
         }});
  all.push_back(
      {"transparency", "200 blended sheets", "alpha 0.05, a hundredth of a metre apart", [](StabilityInput& in) {
         return filled(in, [](GlbWriter& out) {
           for (int i = 0; i < 200; ++i)
             place(out, quad(2, 2), see_through({0.9, 0.3, 0.6}, 0.05), {0, 1, 1.5 + i / 128.0});
         });
       }});
}

}  // namespace candela::stability
