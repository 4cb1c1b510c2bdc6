#include "passes/shared/light_view.h"

namespace candela {
namespace {

bool is_seen_through(const DrawBatch& r) { return !r.solid() && r.topology == Topology::triangles; }

// The direction to a parallel view's light, and 0; or where the light is, and how far it reaches.
glm::vec4 light_of(const shared::View& view) {
  const glm::dmat4 rows = glm::transpose(glm::dmat4(view.clip_from_relative));
  if (!(view.flags & shared::view_is_perspective)) return {glm::normalize(glm::dvec3(rows[2])), 0};
  const glm::dmat3 across = glm::transpose(glm::dmat3(rows[0], rows[1], rows[3]));
  const glm::dvec3 at = glm::inverse(across) * -glm::dvec3(rows[0].w, rows[1].w, rows[3].w);
  const glm::dvec4 end(view.planes[4]);  // faces the light; none: it reaches everywhere
  const double reach_m = glm::dot(glm::dvec3(end), at) + end.w;
  return {at, end == glm::dvec4(0) || !(reach_m > 0) ? 3e38 : reach_m};
}

}  // namespace

bool is_blended_to_light(const DrawBatch& r) { return is_seen_through(r) && !r.refracts; }
bool is_glass_to_light(const DrawBatch& r) { return is_seen_through(r) && r.refracts; }

shared::ColoredShadowPush light_view_push(CommandList& commands, BufferHandle deformed, uint32_t drawn_px) {
  shared::ColoredShadowPush push{};
  push.deformed = deformed ? commands.address(deformed) : 0;
  push.size_px = drawn_px;
  return push;
}

void draw_light_views(CommandList& commands, const SceneInputs& scene, const Draws& draws,
                      const BatchPipelines& pipelines, const ViewImage& image, uint32_t layer,
                      shared::ColoredShadowPush push) {
  const float scale = float(push.size_px) / float(image.size_px);
  for (uint32_t v = 0; v < image.views.size(); ++v) {
    const shared::View& view = image.views[v];
    if (view.layer != layer) continue;
    const glm::vec2 corner = glm::vec2(view.origin_px) * scale, size = glm::vec2(view.size_px) * scale;
    commands.set_viewport(corner, size);
    commands.set_scissor(glm::uvec2(corner), glm::uvec2(glm::ceil(size)));
    push.clip_from_relative = view.clip_from_relative;
    push.light = light_of(view);
    push.layer = layer | (view.flags & shared::view_is_perspective ? 0u : 1u << 31);
    push.place = glm::vec4(0.5f * size, corner + 0.5f * size) / float(push.size_px);
    record_view_runs(commands, scene, draws, pipelines, v, push);
  }
}

}  // namespace candela
