// The layers beside beauty, from the GPU and from the reference: one sample at the centre of each pixel, of the same
// surface.
#include "reference_layer_pairs.h"

#include <set>

namespace candela::test {
namespace {

bool same_surface(const LayerPair& p, size_t a, size_t b) {  // the GPU's at a, the reference's at b
  return p.ids(p.gpu, "object_id.X")[a] == p.ids(p.reference, "object_id.X")[b] &&
         p.ids(p.gpu, "material_id.X")[a] == p.ids(p.reference, "material_id.X")[b];
}
// Calls see(pixel) for the pixels about one.
template <class See>
void around(const LayerPair& p, size_t pixel, See&& see) {
  const int x = int(pixel) % p.w(), y = int(pixel) / p.w();
  for (int j = std::max(y - 1, 0); j <= std::min(y + 1, p.h() - 1); ++j)
    for (int i = std::max(x - 1, 0); i <= std::min(x + 1, p.w() - 1); ++i)
      if (i != x || j != y) see(size_t(j) * size_t(p.w()) + size_t(i));
}

struct Bound {
  std::string channel;
  double floor;     // of 32-bit arithmetic and of textures' codes; depth: relative, else of the channel's largest value
                    // where above 1
  double fraction;  // of the change to the next pixels: rasterizers move corners to a grid of 1/256 pixel
};
// The error beyond the floor, as a fraction of how much the channel changes to the next pixels.
double share_of_change(const LayerPair& p, const Bound& bound, size_t i) {
  const std::vector<float>&a = p.reference.find(bound.channel)->f, &b = p.gpu.find(bound.channel)->f;
  const double scale = bound.channel == "depth.Z" ? a[i] : std::max(*std::max_element(a.begin(), a.end()), 1.0f);
  double change = 0;
  around(p, i, [&](size_t k) { change = std::max(change, std::abs(double(a[k]) - a[i]) / scale); });
  return (std::abs(double(b[i]) - a[i]) / scale - bound.floor) / std::max(change, 1e-12);
}

bool agrees(const LayerPair& p, const std::vector<Bound>& bounds, size_t i) {
  return same_surface(p, i, i) && std::all_of(bounds.begin(), bounds.end(),
                                              [&](const Bound& b) { return share_of_change(p, b, i) <= b.fraction; });
}

// Where a sample of the GPU met another surface than the reference's: an edge or a crease runs by the centre of the
// pixel, or exactly through it. Then the reference, in a pixel beside this one, shows what the GPU has here.
bool is_seen_beside(const LayerPair& p, const std::vector<Bound>& bounds, size_t i) {
  bool beside = false;
  around(p, i, [&](size_t k) {
    if (same_surface(p, i, k) && !same_surface(p, i, i)) beside = true;  // another object, as its ids say
    beside |= same_surface(p, i, k) && std::all_of(bounds.begin(), bounds.end(), [&](const Bound& b) {
                const std::vector<float>& a = p.reference.find(b.channel)->f;
                const double seen = p.gpu.find(b.channel)->f[i], there = std::abs(a[k] - seen),
                             here = std::abs(a[i] - seen);
                // Another face of it; what the neighbour has is not what would be here, but must be nearer to it.
                return there <= here || there <= 0.05 * std::max(std::abs(seen), 1.0);
              });
  });
  return beside;
}

}  // namespace

class ReferenceLayers : public ReferenceLayerPairs {
 protected:
  static LayerPair layers_of(const Job& job, double time_s) {
    std::vector<std::string> layers = surface_layer_names();
    layers.push_back("motion");
    return ReferenceLayerPairs::layers_of(job, time_s, std::move(layers));
  }
};

TEST_F(ReferenceLayers, AgreeOnGeneratedScenes) {
  for (const std::string& name : scene_names()) {
    if (name == "primitive-modes" || name == "animated") continue;  // lines and points, which rays do not meet
    if (name == "metaballs") continue;  // polygons stand for the surface (reference_metaballs.cpp)
    SCOPED_TRACE(name);
    const LayerPair p = layers_of(job_for(one_lamp(scene(name), Light::kept), width * 2, height * 2), 17.0 / 24);
    // The rounding of a filtered normal map to 8-bit codes (docs/understanding/reference.md), and llvmpipe's cubic for
    // sRGB, which is off by up to 1.2e-3.
    const double normal_floor = name == "normal-mapped" ? 9e-3 : 2e-5, colour_floor = 2e-3;
    std::vector<Bound> bounds = {{"depth.Z", 1e-6, 0.01}};
    for (const char* part : {"X", "Y", "Z"}) bounds.push_back({std::string("normal.") + part, normal_floor, 0.02});
    for (const char* part : {"R", "G", "B"}) bounds.push_back({std::string("albedo.") + part, colour_floor, 0.02});
    size_t edges = 0, surfaces = 0;
    for (size_t i = 0; i < size_t(p.w()) * size_t(p.h()); ++i) {
      const std::string at = fmt::format("pixel {},{}", i % size_t(p.w()), i / size_t(p.w()));
      surfaces += p.ids(p.reference, "object_id.X")[i] != 0xffffffffu;
      if (agrees(p, bounds, i)) continue;
      ++edges;
      if (is_seen_beside(p, bounds, i)) continue;
      for (const Bound& bound : bounds)
        EXPECT_LE(share_of_change(p, bound, i), bound.fraction)
            << at << ": " << bound.channel << " is " << p.gpu.find(bound.channel)->f[i] << " for "
            << p.reference.find(bound.channel)->f[i];
      EXPECT_TRUE(same_surface(p, i, i)) << at;
    }
    EXPECT_GT(surfaces, 100u);
    fmt::print("{}: {} pixels at edges of {} with a surface\n", name, edges, surfaces);
    EXPECT_LE(double(edges), 0.03 * p.w() * p.h());
  }
}

// Motion of the same point of the same surface, as its depth says: cameras, nodes, instances, skins and morphs that
// move. What does not move has exactly 0 in both.
TEST_F(ReferenceLayers, AgreeOnMotion) {
  std::set<std::string> moving_scenes;
  for (const std::string& name : scene_names()) {
    if (name == "primitive-modes") continue;  // lines and points, which rays do not meet
    if (name == "metaballs") continue;        // polygons stand for the surface (reference_metaballs.cpp)
    SCOPED_TRACE(name);
    const LayerPair p = layers_of(job_for(scene(name), width * 2, height * 2), 17.0 / 24);
    const std::vector<float>&z = p.gpu.find("depth.Z")->f, &zr = p.reference.find("depth.Z")->f;
    size_t same = 0, moving = 0;
    for (size_t i = 0; i < z.size(); ++i) {
      if (!same_surface(p, i, i) || std::abs(double(z[i]) - zr[i]) > 1e-5 * zr[i]) continue;
      ++same;
      bool moves = false;
      for (const char* channel : {"motion.X", "motion.Y"}) {
        const float a = p.reference.find(channel)->f[i], b = p.gpu.find(channel)->f[i];
        EXPECT_EQ(a == 0, b == 0) << i;
        EXPECT_LE(share_of_change(p, {channel, 2e-5, 0}, i), 0.02)
            << i << ": " << channel << " is " << b << " for " << a;
        moves |= a != 0;
      }
      moving += moves;
    }
    EXPECT_GT(same, 0.85 * p.w() * p.h());
    if (moving > 200) moving_scenes.insert(name);
  }
  for (const char* name : {"animated", "animation-pointer", "morph", "skinned", "street"})
    EXPECT_TRUE(moving_scenes.contains(name)) << name;
}

}  // namespace candela::test
