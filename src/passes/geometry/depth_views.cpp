#include "passes/geometry/depth_views.h"

#include <algorithm>
#include <bit>
#include <functional>
#include <map>
#include <span>

#include "shared/draw.h"

namespace candela {
namespace {

// Of the layers that views of a size are drawn into before they are copied, in each round.
constexpr uint32_t round_texels = 1 << 20, most_round_layers = 256;

uint32_t layers_of_round(uint32_t size_px) {
  return std::clamp(round_texels / (size_px * size_px), 1u, most_round_layers);
}

// Of those that are drawn over others, or of the others; the largest first.
std::span<const shared::View> views_of(const ViewImage& image, bool over) {
  const std::span<const shared::View> all(image.views);
  return over ? all.subspan(image.first_over()) : all.first(image.first_over());
}
std::span<const shared::View> views_of(const ViewImage& image, bool over, uint32_t size_px) {
  const auto found = std::ranges::equal_range(views_of(image, over), size_px, std::greater(),
                                              [](const auto& v) { return v.size_px.x; });
  return {found.begin(), found.end()};
}

void declare_rounds(GraphBuilder& builder, const ViewImage& image, DepthViews::Out& out) {
  builder.begin_step();
  out.cleared = out.depth = builder.write(out.depth, Access::transfer_destination);
  std::map<uint32_t, ImageHandle> layers_of;  // by size
  std::vector<ViewRounds> all;
  view_rounds(image, all);
  for (const ViewRounds& of : all) {
    ImageDesc desc{fmt::format("{}.{}", image.name, of.size_px), depth_format, of.size_px, of.size_px};
    desc.kind = ImageKind::d2_array;
    desc.layers = layers_of_round(of.size_px);
    desc.covered = true;
    ImageHandle& layers = layers_of[of.size_px];
    if (!layers) layers = builder.create(desc);
    for (uint32_t r = 0; r < of.rounds; ++r) {
      DepthViews::Round round;
      round.size_px = of.size_px, round.number = r, round.most = desc.layers;
      if (of.over) {
        builder.begin_step();
        builder.read(out.depth, Access::transfer_source, "what stands");
        round.under = out.depth;
        round.loaded = layers = builder.write(layers, Access::transfer_destination);
        out.steps.push_back({uint32_t(out.rounds.size()), DepthViews::RoundStep::load});
      }
      builder.begin_step();
      round.layers = layers = builder.write(layers, Access::depth_attachment);
      out.steps.push_back({uint32_t(out.rounds.size()), DepthViews::RoundStep::draw});
      builder.begin_step();
      builder.read(layers, Access::transfer_source, "the views' depths");
      round.depth = out.depth = builder.write(out.depth, Access::transfer_destination);
      out.steps.push_back({uint32_t(out.rounds.size()), DepthViews::RoundStep::store});
      out.rounds.push_back(round);
    }
  }
}

void record_round(CommandList& commands, const DepthViews::In& in, const DepthViews::Out& out) {
  const ViewImage& image = *in.image;
  if (commands.step() == 0) {
    if (!image.outlives) commands.clear_image(out.cleared, glm::vec4(0));
    return;
  }
  const auto [number, what] = out.steps[commands.step() - 1];
  const DepthViews::Round& round = out.rounds[number];
  const std::span<const shared::View> views = views_of(image, bool(round.loaded), round.size_px);
  const uint32_t count = uint32_t(views.size()), past = std::min(round.number * round.most, count);
  const uint32_t first_view = uint32_t(views.data() - image.views.data()) + past;
  const auto first = std::ranges::lower_bound(image.drawn, first_view);
  const auto end = std::ranges::lower_bound(image.drawn, first_view + std::min(round.most, count - past));
  if (first == end) return;
  if (what != DepthViews::RoundStep::draw) {
    for (auto v = first; v != end; ++v) {
      const shared::View& view = image.views[*v];
      const CommandList::Tile layer{{0, 0}, *v - first_view};
      if (what == DepthViews::RoundStep::load)
        commands.copy_tile(round.under, {view.under_px, view.under_layer}, round.loaded, layer, round.size_px);
      else
        commands.copy_tile(round.layers, layer, round.depth, {view.tile_px, view.tile_layer}, round.size_px);
    }
    return;
  }
  commands.begin_rendering({}, round.layers);
  for (auto v = first; v != end && !round.loaded; ++v)
    commands.clear_depth_layer(*v - first_view, image.views[*v].least_depth);
  for (auto v = first; v != end; ++v) {
    const shared::View& view = image.views[*v];
    shared::DepthLampPush push{};
    push.deformed = in.deformed ? commands.address(in.deformed) : 0;
    push.places = commands.address(in.scene.places);
    push.clip_from_relative = view.clip_from_relative;
    push.origin = view.origin, push.origin_rest = view.origin_rest;
    push.layer = *v - first_view;
    record_view_runs(commands, in.scene, in.draws, out.pipelines, uint32_t(v - image.drawn.begin()), push,
                     in.scene.open_sides);
  }
  commands.end_rendering();
}

}  // namespace

void view_rounds(const ViewImage& image, std::vector<ViewRounds>& rounds) {
  rounds.clear();
  if (!image.apart) return;
  for (const bool over : {false, true}) {
    const std::span<const shared::View> views = views_of(image, over);
    for (size_t first = 0; first < views.size();) {
      const uint32_t size_px = views[first].size_px.x, count = uint32_t(views_of(image, over, size_px).size());
      const uint32_t most = layers_of_round(size_px);
      rounds.push_back({size_px, std::bit_ceil((count + most - 1) / most), over});
      first += count;
    }
  }
}

// Maps in which nothing opaque stands too: of what is seen through there are images beside them.
Need DepthViews::needed(const SceneFacts& facts, const FrameRequest&) const {
  if (facts.blend_items + facts.refracting_items > 0) return {};
  return needed_for_solid_surfaces(facts);
}

DepthViews::Out DepthViews::declare(GraphBuilder& builder, const In& in) const {
  Out out;
  BatchPipelineChoice choice;
  choice.desc.vertex_shader = in.image->apart ? "depth_view.vert#LAMPS=1" : "depth_view.vert";
  choice.desc.depth_format = depth_format;
  choice.desc.depth_test = choice.desc.depth_write = true;
  choice.desc.depth_compare = VK_COMPARE_OP_GREATER_OR_EQUAL;
  choice.masked_fragment = "depth_prepass.frag";
  choice.relief_fragment = in.image->apart ? "relief_view.frag#LAMPS=1" : "relief_view.frag";
  out.pipelines = declare_batches(
      builder, in.scene, in.draws, in.deformed,
      [](const DrawBatch& r) { return r.solid() && r.topology == Topology::triangles; }, choice);
  out.depth = builder.create(image_desc(*in.image, depth_format));
  if (in.image->apart) {
    builder.read(in.scene.places, Access::vertex_read, "where things are in the world");
    declare_rounds(builder, *in.image, out);
    return out;
  }
  for (uint32_t layer = 0; layer < in.image->layers; ++layer)
    out.depth = builder.write(out.depth, Access::depth_attachment, ImageRange::layer(layer));
  return out;
}

void DepthViews::record(CommandList& commands, const In& in, const Out& out) const {
  if (in.image->apart) return record_round(commands, in, out);
  const std::vector<shared::View>& views = in.image->views;
  for (uint32_t v = 0; v < views.size(); ++v) {
    const shared::View& view = views[v];
    if (v == 0 || views[v - 1].layer != view.layer)
      commands.begin_rendering({}, out.depth, ImageRange::layer(view.layer));
    if (view.size_px != glm::uvec2(in.image->size_px)) {
      commands.set_viewport(view.origin_px, view.size_px);
      commands.set_scissor(view.origin_px, view.size_px);
    }
    record_view_depth(commands, in.scene, in.draws, in.deformed, out.pipelines, v, view);
    if (v + 1 == views.size() || views[v + 1].layer != view.layer) commands.end_rendering();
  }
}

}  // namespace candela
