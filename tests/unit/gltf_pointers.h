#pragma once
#include "gltf_builder.h"

namespace candela::test {

// A property that an animation of one second moves (KHR_animation_pointer). type: an accessor's.
struct Pointed {
  const char* pointer;
  const char* type;
  std::vector<float> values;
};
inline void animate_pointers(GltfBuilder& b, const std::vector<Pointed>& all) {
  b.use("KHR_animation_pointer");
  const int times = b.accessor<float>("SCALAR", {0, 1});
  Json animation = {{"channels", Json::array()}, {"samplers", Json::array()}};
  for (const Pointed& p : all) {
    animation["samplers"].push_back({{"input", times}, {"output", b.accessor<float>(p.type, p.values)}});
    animation["channels"].push_back(
        {{"sampler", animation["samplers"].size() - 1},
         {"target", {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", p.pointer}}}}}}}});
  }
  b.json["animations"].push_back(animation);
}

}  // namespace candela::test
