#include "render/reference_layers.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>

#include "base/check.h"
#include "reference/centre_surface.h"
#include "reference/deform.h"
#include "reference/metaballs.h"
#include "render/cryptomatte.h"
#include "scene/matte_names.h"

namespace candela {
namespace {

constexpr float no_depth_m = 1e10f;
constexpr uint32_t no_id = 0xffffffffu;

using Centres = std::vector<std::optional<reference::CentreSurface>>;

Centres centres_of(const ReferenceFrame& frame, const PictureWindow& window) {
  const PixelRect& part = window.part;
  Centres centres(size_t(part.width) * size_t(part.height));
  tbb::parallel_for(0, part.height, [&](int y) {
    for (int x = 0; x < part.width; ++x)
      centres[size_t(y) * size_t(part.width) + size_t(x)] =
          reference::centre_surface(*frame.world, part.x + x, part.y + y, window.width_px, window.height_px);
  });
  return centres;
}

void add_depth(FloatImage& image, const Centres& centres) {
  Channel channel{"depth.Z", ChannelType::float32, {}, {}};
  for (const auto& c : centres) channel.f.push_back(c ? std::min(float(c->depth_m), no_depth_m) : no_depth_m);
  image.channels.push_back(std::move(channel));
}

template <class Id>
void add_ids(FloatImage& image, const Centres& centres, const std::string& layer, Id&& id) {
  Channel channel{layer + ".X", ChannelType::uint32, {}, {}};
  for (const auto& c : centres) channel.u.push_back(c ? id(*c) : no_id);
  image.channels.push_back(std::move(channel));
}

template <class Value>
void add_vectors(FloatImage& image, const Centres& centres, const std::string& layer, const char* parts,
                 ChannelType type, Value&& value) {
  for (int part = 0; part < 3; ++part) {
    Channel channel{layer + "." + parts[part], type, {}, {}};
    for (const auto& c : centres) channel.f.push_back(c ? float(value(c->surface)[part]) : 0.0f);
    image.channels.push_back(std::move(channel));
  }
}

// A pixel's ids with the samples that each covers, the most first, of equal ones the lower id.
using Ranks = std::vector<std::pair<uint32_t, uint64_t>>;

Ranks ranks_of(const std::vector<uint32_t>& ids) {
  Ranks ranks;
  for (const uint32_t id : ids) {
    const auto found = std::ranges::find(ranks, id, [](const auto& rank) { return rank.first; });
    if (found == ranks.end())
      ranks.emplace_back(id, 1);
    else
      ++found->second;
  }
  std::ranges::sort(ranks, [](const auto& a, const auto& b) {
    return a.second != b.second ? a.second > b.second : a.first < b.first;
  });
  return ranks;
}

// Channels of as many levels as the pixels need, three at least: what readers are used to.
void add_ranks(FloatImage& image, const std::string& layer, const std::vector<Ranks>& pixels, uint64_t samples) {
  size_t most = 6;
  for (const Ranks& ranks : pixels) most = std::max(most, ranks.size());
  for (size_t level = 0; 2 * level < most; ++level) {
    const std::vector<std::string> names = matte_channels(layer, uint32_t(level));
    for (size_t c = 0; c < 4; ++c) {
      Channel channel{names[c], ChannelType::float32, std::vector<float>(pixels.size()), {}};
      for (size_t i = 0; i < pixels.size(); ++i) {
        const size_t rank = 2 * level + c / 2;
        if (rank >= pixels[i].size()) continue;
        const auto& [id, count] = pixels[i][rank];
        channel.f[i] = c % 2 == 0 ? std::bit_cast<float>(id) : float(double(count) / double(samples));
      }
      image.channels.push_back(std::move(channel));
    }
  }
}

auto is_in(const std::vector<std::string>& layers) {
  return [&layers](const std::string& name) { return std::find(layers.begin(), layers.end(), name) != layers.end(); };
}

}  // namespace

const std::vector<std::string>& surface_layer_names() {
  static const std::vector<std::string> names = {"depth", "normal", "albedo", "object_id", "material_id"};
  return names;
}

const std::vector<std::string>& term_layer_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (size_t t = 0; t < reference::term_count; ++t) all.emplace_back(name_of(reference::Term(t)));
    all.emplace_back("shadow_sun");
    all.emplace_back("shadow_local");
    all.emplace_back("occlusion");
    return all;
  }();
  return names;
}

reference::FilmParts film_parts(const ReferenceFrame& frame, const std::vector<std::string>& layers) {
  return {.fog = !frame.world->media().empty(),
          .terms = std::ranges::any_of(term_layer_names(), is_in(layers)),
          .lamp_shadow = is_in(layers)("shadow_local"),
          .traversal = is_in(layers)("heatmap_traversal")};
}

namespace {

// Points of triangles in the picture, in pixels from its middle, y up.
class Places {
 public:
  Places(const Scene& scene, const FrameData& data, const View& view, int width, int height)
      : scene_(scene), data_(data), view_(view), half_px_(0.5 * width, 0.5 * height) {
    deformed_ = deform_all(scene, data, false);
  }
  // Of the surface's point at the time of the data; behind the camera there is none. now: where the centres are of,
  // which metaballs are asked where they were.
  std::optional<glm::dvec2> of(const reference::CentreSurface& c, const FrameData& now) const {
    const DrawItem& shown = now.items[c.item];
    if (shown.deformed >= 0)
      if (const int body = now.deformations[size_t(shown.deformed)].body; body >= 0)
        return placed(glm::dvec4(MetaballSurface(now.metaballs[size_t(body)])
                                     .place_at(MetaballSurface(data_.metaballs[size_t(body)]), c.surface.position),
                                 1.0));
    const DrawItem& item = data_.items[c.item];
    const MeshSection& section = scene_.meshes[item.mesh].sections[item.section];
    const glm::dmat4 relative_from_local(data_.relative_from_local[item.transform]);
    const std::vector<glm::vec3>& vertices =
        item.deformed >= 0 ? deformed_[size_t(item.deformed)].position : section.position;
    const glm::dvec3 weights(1 - c.weights.x - c.weights.y, c.weights.x, c.weights.y);
    glm::dvec4 point(0, 0, 0, 1);
    for (int i = 0; i < 3; ++i) {
      const uint32_t vertex = section.index[3 * size_t(c.primitive) + size_t(i)];
      const glm::dvec4 corner = relative_from_local * glm::dvec4(glm::dvec3(vertices[vertex]), 1.0);
      point += weights[i] * glm::dvec4(glm::dvec3(corner), 0.0);
    }
    return placed(point);
  }

 private:
  std::optional<glm::dvec2> placed(glm::dvec4 point) const {
    const glm::dvec4 clip = view_.clip_from_relative * point;
    if (!(clip.w > 0)) return std::nullopt;
    return glm::dvec2(clip.x, -clip.y) / clip.w * half_px_;
  }

  const Scene& scene_;
  const FrameData& data_;
  const View& view_;
  glm::dvec2 half_px_;
  std::vector<DeformedVertices> deformed_;
};

}  // namespace

void add_motion_layer(FloatImage& image, const ReferenceFrame& frame, const PictureWindow& window,
                      const std::vector<std::string>& layers) {
  if (!is_in(layers)("motion")) return;
  CHECK(frame.before);
  const Places now(frame.scene(), frame.data, frame.view, window.width_px, window.height_px),
      before(frame.scene(), frame.before->data, frame.before->view, window.width_px, window.height_px);
  Channel x{"motion.X", ChannelType::float32, {}, {}}, y{"motion.Y", ChannelType::float32, {}, {}};
  for (const auto& c : centres_of(frame, window)) {
    const auto to = c ? now.of(*c, frame.data) : std::nullopt, from = c ? before.of(*c, frame.data) : std::nullopt;
    glm::vec2 moved(0);
    if (to && from) moved = glm::vec2(*to - *from);
    if (!std::isfinite(moved.x) || !std::isfinite(moved.y)) moved = glm::vec2(0);
    x.f.push_back(moved.x), y.f.push_back(moved.y);
  }
  image.channels.push_back(std::move(x));
  image.channels.push_back(std::move(y));
}

const std::vector<std::string>& matte_layer_names() {
  static const std::vector<std::string> names = {"crypto_object", "crypto_material"};
  return names;
}

void add_matte_layers(FloatImage& image, const ReferenceFrame& frame, const PictureWindow& window,
                      const std::vector<std::string>& layers, const reference::SamplerSettings& sampler,
                      uint64_t samples) {
  if (std::ranges::none_of(matte_layer_names(), is_in(layers))) return;
  const auto objects = matte_ids(node_names(frame.scene())), materials = matte_ids(material_names(frame.scene()));
  const size_t pixels = size_t(image.width) * size_t(image.height);
  std::vector<Ranks> by_object(pixels), by_material(pixels);
  tbb::parallel_for(0, image.height, [&](int y) {
    std::vector<uint32_t> seen[2];
    for (int x = 0; x < image.width; ++x) {
      for (auto& ids : seen) ids.clear();
      for (uint64_t s = 0; s < samples; ++s) {
        const int px = window.part.x + x, py = window.part.y + y;
        const glm::dvec2 place = glm::dvec2(px, py) + reference::SampleStream(sampler, px, py, s).pixel();
        const auto hit =
            reference::nearest_surface(*frame.world, frame.world->camera_ray(place, window.width_px, window.height_px));
        if (!hit) continue;
        const DrawItem& item = frame.data.items[hit->item];
        seen[0].push_back(objects[item.node]);
        seen[1].push_back(item.material >= 0 ? materials[size_t(item.material)] : materials.back());
      }
      const size_t i = size_t(y) * size_t(image.width) + size_t(x);
      by_object[i] = ranks_of(seen[0]), by_material[i] = ranks_of(seen[1]);
    }
  });
  for (const std::string& layer : matte_layer_names()) {
    if (!is_in(layers)(layer)) continue;
    add_ranks(image, layer, layer == "crypto_object" ? by_object : by_material, samples);
    add_cryptomatte(image.metadata, frame.scene(), layer);
  }
}

void add_term_layers(FloatImage& image, const reference::Film& film, const std::vector<std::string>& layers,
                     ChannelType type) {
  if (std::ranges::none_of(term_layer_names(), is_in(layers))) return;
  CHECK(film.has_terms());
  const auto add = [&](const std::string& name, auto&& value) {
    Channel& channel = image.channels.emplace_back();
    channel.name = name, channel.type = type;
    for (size_t i = 0; i < film.pixels(); ++i) channel.f.push_back(float(value(i)));
  };
  for (size_t t = 0; t < reference::term_count; ++t) {
    const std::string name(name_of(reference::Term(t)));
    if (!is_in(layers)(name)) continue;
    for (int c = 0; c < 3; ++c)
      add(name + "." + "RGB"[c], [&](size_t i) { return film.term(reference::Term(t), i)[c]; });
  }
  if (is_in(layers)("shadow_sun")) add("shadow_sun.Y", [&](size_t i) { return film.shadow(i); });
  if (is_in(layers)("shadow_local")) add("shadow_local.Y", [&](size_t i) { return film.lamp_shadow(i); });
  if (is_in(layers)("occlusion")) add("occlusion.Y", [&](size_t i) { return film.occlusion(i); });
}

void add_light_group_layers(FloatImage& image, const reference::Film& film, const std::vector<std::string>& layers,
                            ChannelType type) {
  for (uint32_t g = 0; g < layers.size(); ++g)
    for (int c = 0; c < 3; ++c) {
      Channel& channel = image.channels.emplace_back();
      channel.name = layers[g] + "." + "RGB"[c], channel.type = type;
      for (size_t i = 0; i < film.pixels(); ++i) channel.f.push_back(float(film.light_of_group(g, i)[c]));
    }
}

void add_surface_layers(FloatImage& image, const ReferenceFrame& frame, const PictureWindow& window,
                        const std::vector<std::string>& layers, ChannelType type) {
  using reference::CentreSurface, reference::Surface;
  const auto wanted = is_in(layers);
  const std::vector<std::string>& all = surface_layer_names();
  if (std::none_of(all.begin(), all.end(), wanted)) return;
  const Centres centres = centres_of(frame, window);
  const auto item_of = [&](const CentreSurface& c) -> const DrawItem& { return frame.data.items[c.item]; };
  if (wanted("depth")) add_depth(image, centres);
  if (wanted("normal"))
    add_vectors(image, centres, "normal", "XYZ", type,
                [](const Surface& s) { return s.unlit ? glm::dvec3(0) : s.normal; });
  if (wanted("albedo"))
    add_vectors(image, centres, "albedo", "RGB", type, [](const Surface& s) { return s.base_color; });
  if (wanted("object_id"))
    add_ids(image, centres, "object_id", [&](const CentreSurface& c) { return item_of(c).node; });
  if (wanted("material_id"))
    add_ids(image, centres, "material_id", [&](const CentreSurface& c) { return uint32_t(item_of(c).material); });
}

}  // namespace candela
