#include "render/reference_layers.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "base/check.h"
#include "reference/centre_surface.h"

namespace candela {
namespace {

constexpr float no_depth_m = 1e10f;
constexpr uint32_t no_id = 0xffffffffu;

using Centres = std::vector<std::optional<reference::CentreSurface>>;

Centres centres_of(const ReferenceFrame& frame, int width, int height) {
  Centres centres(size_t(width) * size_t(height));
  tbb::parallel_for(0, height, [&](int y) {
    for (int x = 0; x < width; ++x)
      centres[size_t(y) * size_t(width) + size_t(x)] = reference::centre_surface(*frame.world, x, y, width, height);
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
  Channel channel{layer, ChannelType::uint32, {}, {}};
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
    all.emplace_back("shadow");
    all.emplace_back("shadow.lamps");
    all.emplace_back("occlusion");
    return all;
  }();
  return names;
}

reference::FilmParts film_parts(const ReferenceFrame& frame, const std::vector<std::string>& layers) {
  return {.fog = !frame.world->media().empty(),
          .terms = std::ranges::any_of(term_layer_names(), is_in(layers)),
          .lamp_shadow = is_in(layers)("shadow.lamps")};
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
  if (is_in(layers)("shadow")) add("shadow.Y", [&](size_t i) { return film.shadow(i); });
  if (is_in(layers)("shadow.lamps")) add("shadow.lamps.Y", [&](size_t i) { return film.lamp_shadow(i); });
  if (is_in(layers)("occlusion")) add("occlusion.Y", [&](size_t i) { return film.occlusion(i); });
}

void add_surface_layers(FloatImage& image, const ReferenceFrame& frame, const std::vector<std::string>& layers,
                        ChannelType type) {
  using reference::CentreSurface, reference::Surface;
  const auto wanted = is_in(layers);
  const std::vector<std::string>& all = surface_layer_names();
  if (std::none_of(all.begin(), all.end(), wanted)) return;
  const Centres centres = centres_of(frame, image.width, image.height);
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
