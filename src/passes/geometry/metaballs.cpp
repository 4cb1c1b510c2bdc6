#include "passes/geometry/metaballs.h"

#include "shared/metaballs.h"

namespace candela {

std::span<const Knob> MetaballKnobs::table() {
  static const Knob table[] = {
      {.name = "cell",
       .member = &MetaballKnobs::cell,
       .lowest = 0.0625,
       .highest = 16,
       .levels = {2, 1, 0.5, 0.25},
       .description = "side of the cells that polygons are made in, as a multiple of the scene's; half the side leaves "
                      "a quarter of the error and needs eight times the evaluations",
       .kind = Trades::error,
       .sweep = {4, 2, 1, 0.5, 0.25}},
  };
  return table;
}

Need MetaballPolygons::needed(const SceneFacts& facts, const FrameRequest&) const {
  return needed_if(facts.metaball_chunks > 0, "no metaballs are visible (CANDELA_metaballs)");
}

MetaballPolygons::Out MetaballPolygons::declare(GraphBuilder& builder, const In& in) const {
  const SceneInputs& s = in.scene;
  for (const BufferHandle b : {s.metaball_bodies, s.metaballs, s.metaball_blocks, s.metaball_lists})
    builder.read(b, Access::compute_read, "the metaballs");
  builder.read_optional(s.metaballs_before, Access::compute_read);
  Out out;
  out.sums = builder.create(BufferDesc{"metaballs.sums", uint64_t(s.metaball_block_room) * 2 * sizeof(uint32_t)});
  const uint64_t bytes = uint64_t(s.deformed_words) * sizeof(float);
  const BufferHandle vertices = builder.create(BufferDesc{"deform.vertices", bytes});
  BufferHandle before;
  if (s.metaballs_before) before = builder.create(BufferDesc{"deform.vertices_before", bytes});
  out.count = builder.pipeline(ComputePipelineDesc{"metaballs_count.comp", {}});
  out.scan = builder.pipeline(ComputePipelineDesc{"metaballs_scan.comp", {}});
  ComputePipelineDesc emit{"metaballs_emit.comp", {}};
  if (before) emit.constants = {{0, "HAS_BEFORE", 1}};
  out.emit = builder.pipeline(emit);
  builder.begin_step();
  out.sums = builder.write(out.sums, Access::compute_write);
  builder.begin_step();
  out.sums = builder.write(out.sums, Access::compute_write);
  out.items = builder.write(s.items, Access::compute_write);
  builder.begin_step();
  builder.read(out.sums, Access::compute_read, "sums of triangles");
  out.vertices = builder.write(vertices, Access::compute_write);
  if (before) out.before = builder.write(before, Access::compute_write);
  return out;
}

void MetaballPolygons::record(CommandList& commands, const In& in, const Out& out) const {
  const SceneInputs& s = in.scene;
  shared::MetaballsPush push{};
  push.bodies = commands.address(s.metaball_bodies);
  push.balls = commands.address(s.metaballs);
  push.blocks = commands.address(s.metaball_blocks);
  push.lists = commands.address(s.metaball_lists);
  push.sums = commands.address(out.sums);
  push.block_count = s.values->metaball_blocks;
  const glm::uvec2 blocks = shared::metaball_block_threads(s.values->metaball_blocks);
  switch (commands.step()) {
    case 0:
      commands.bind(out.count);
      commands.push(push);
      return commands.dispatch(blocks.x, blocks.y);
    case 1:
      push.items = commands.address(out.items);
      commands.bind(out.scan);
      commands.push(push);
      return commands.dispatch(s.metaball_body_count * shared::metaball_scan_threads);
    default:
      push.deformed = commands.address(out.vertices);
      if (out.before) {
        push.balls_before = commands.address(s.metaballs_before);
        push.deformed_before = commands.address(out.before);
      }
      commands.bind(out.emit);
      commands.push(push);
      return commands.dispatch(blocks.x, blocks.y);
  }
}

}  // namespace candela
