#include "passes/geometry/deform.h"

#include "shared/deform.h"

namespace candela {

Need Deform::needed(const SceneFacts& facts, const FrameRequest&) const {
  return needed_if(facts.deformed_items > 0, "nothing visible is skinned or morphed");
}

Deform::Out Deform::declare(GraphBuilder& builder, const In& in) const {
  builder.read(in.scene.constants, Access::uniform_read, "the frame's constants");
  for (const BufferHandle b : {in.scene.vertices, in.scene.deform_jobs})
    builder.read(b, Access::compute_read, "the scene");
  builder.read_optional(in.scene.joints, Access::compute_read);
  builder.read_optional(in.scene.weights, Access::compute_read);
  Out out;
  const BufferHandle vertices =
      in.polygons ? in.polygons : builder.create(BufferDesc{"deform.vertices", uint64_t(in.scene.deformed_words) * 4});
  out.deformed = builder.write(vertices, Access::compute_write);
  out.pipeline = builder.pipeline(ComputePipelineDesc{"deform.comp", {}});
  return out;
}

void Deform::record(CommandList& commands, const In& in, const Out& out) const {
  commands.bind(out.pipeline);
  shared::DeformPush push{};
  push.jobs = commands.address(in.scene.deform_jobs);
  push.joints = in.scene.joints ? commands.address(in.scene.joints) : 0;
  push.weights = in.scene.weights ? commands.address(in.scene.weights) : 0;
  push.deformed = commands.address(out.deformed);
  for (uint32_t job = 0; job < in.scene.deform_vertices.size(); ++job) {
    push.job = job;
    commands.push(push);
    commands.dispatch(std::min(in.scene.deform_vertices[job], 65535u * 64u));  // 65535 groups: what every device takes
  }
}

}  // namespace candela
