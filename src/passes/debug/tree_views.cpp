#include "passes/debug/tree_views.h"

#include "passes/shared/features.h"
#include "shared/visibility.h"

namespace candela {
namespace {
constexpr uint32_t box_vertices = 24;  // of twelve lines
}

bool shows_trees(const FrameRequest& request) {
  return request.has_layer(TraversalHeat::layers[0].name) || request.has_layer(TreeBoxes::layers[0].name);
}

Need TraversalHeat::needed(const SceneFacts&, const FrameRequest& request) const {
  return needed_if(request.has_layer(layers[0].name), "no heat map of the trees for rays is wanted (--view, --layers)");
}

TraversalHeat::Out TraversalHeat::declare(GraphBuilder& builder, const In& in) const {
  const SceneInputs& s = in.scene;
  Out out;
  const std::string layer(layers[0].name);
  out.cost = builder.write(builder.create(ImageDesc{layer, VK_FORMAT_R32_SFLOAT, s.width_px, s.height_px}),
                           s.trees ? Access::storage_image_write : Access::transfer_destination);
  builder.publish(layer, out.cost);
  if (!s.trees) return out;  // nothing is there
  builder.read(s.constants, Access::uniform_read, "the frame's constants");
  builder.read(s.trees, Access::compute_read, "the trees for rays");
  builder.read(s.materials, Access::compute_read, "the scene");
  out.pipeline =
      builder.pipeline(ComputePipelineDesc{"traversal_heat.comp", ray_constants(s.rays.stack, false, false)});
  return out;
}

void TraversalHeat::record(CommandList& commands, const In& in, const Out& out) const {
  if (!in.scene.trees) {
    commands.clear_image(out.cost, glm::vec4(0));
    return;
  }
  commands.bind(out.pipeline);
  commands.push(shared::TraversalHeatPush{commands.address(in.scene.trees), {0, 0}, commands.storage(out.cost)});
  commands.dispatch_picture(in.scene.width_px, in.scene.height_px);
}

Need TreeBoxes::needed(const SceneFacts&, const FrameRequest& request) const {
  return needed_if(request.has_layer(layers[0].name), "no view of the trees for rays is wanted (--view, --layers)");
}

TreeBoxes::Out TreeBoxes::declare(GraphBuilder& builder, const In& in) const {
  const SceneInputs& s = in.scene;
  if (s.trees) {
    builder.read(s.constants, Access::uniform_read, "the frame's constants");
    builder.read(s.trees, Access::vertex_read, "the trees for rays");
  }
  GraphicsPipelineDesc desc;
  desc.vertex_shader = "tree_boxes.vert";
  desc.fragment_shader = "tree_boxes.frag";
  desc.color_formats = {color_format};
  desc.topology = VK_PRIMITIVE_TOPOLOGY_LINE_LIST;
  Out out;
  const std::string layer(layers[0].name);
  out.lines =
      builder.write(builder.create(ImageDesc{layer, color_format, s.width_px, s.height_px}), Access::color_attachment);
  builder.publish(layer, out.lines);
  out.pipeline = builder.pipeline(desc);
  return out;
}

void TreeBoxes::record(CommandList& commands, const In& in, const Out& out) const {
  const CommandList::Attachment lines{out.lines};
  commands.begin_picture({&lines, 1}, {});
  commands.bind(out.pipeline);
  commands.set_cull(false, false);
  const std::vector<TreeRange> none, &trees = in.scene.trees ? *in.scene.tree_ranges : none;
  for (const uint32_t leaves : {0u, 1u})
    for (const TreeRange& tree : trees) {
      commands.push(shared::TreeBoxesPush{commands.address(in.scene.trees), tree.first_node, tree.nodes, tree.instance,
                                          tree.holds_instances ? 1u : 0u, leaves});
      commands.draw(box_vertices, 8 * tree.nodes + 1);
    }
  commands.end_rendering();
}

}  // namespace candela
