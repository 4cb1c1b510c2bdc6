#include <nlohmann/json.hpp>

#include "graph/formats.h"
#include "graph/plan.h"

namespace candela {
namespace {

using Json = nlohmann::ordered_json;

Json constants_json(const std::vector<SpecConstant>& constants) {
  Json result = Json::object();
  for (const SpecConstant& c : constants) result[c.name] = c.value;
  return result;
}
Json to_json(const ComputePipelineDesc& desc) {
  return {{"kind", "compute"}, {"shader", desc.shader}, {"constants", constants_json(desc.constants)}};
}
Json to_json(const GraphicsPipelineDesc& desc) {
  Json formats = Json::array();
  for (const VkFormat format : desc.color_formats) formats.push_back(format_name(format));
  constexpr const char* blends[] = {"none", "premultiplied_over", "additive", "coverage", "greatest"};
  Json result = {{"kind", "graphics"},
                 {"vertex_shader", desc.vertex_shader},
                 {"fragment_shader", desc.fragment_shader},
                 {"constants", constants_json(desc.constants)},
                 {"color_formats", formats},
                 {"samples", desc.samples},
                 {"depth_test", desc.depth_test},
                 {"depth_write", desc.depth_write},
                 {"blend", blends[int(desc.blend)]}};
  for (const AttachmentState& a : desc.attachments)
    result["attachments"].push_back({{"blend", blends[int(a.blend)]}, {"write_mask", a.write_mask}});
  if (desc.stencil_test) result["stencil_test"] = true;
  if (desc.depth_bias_constant != 0 || desc.depth_bias_slope != 0)
    result["depth_bias"] = {desc.depth_bias_constant, desc.depth_bias_slope};
  if (desc.depth_clamp) result["depth_clamp"] = true;
  return result;
}

Json to_json(const RayPipelineDesc& desc) {
  return {{"kind", "rays"},
          {"raygen_shader", desc.raygen_shader},
          {"miss_shader", desc.miss_shader},
          {"closest_hit_shader", desc.closest_hit_shader},
          {"any_hit_shader", desc.any_hit_shader},
          {"constants", constants_json(desc.constants)}};
}

Json knobs_json(const std::vector<PlanKnob>& knobs) {
  Json result = Json::object();
  for (const PlanKnob& knob : knobs) result[knob.name] = knob.value;
  return result;
}

Json use_json(const FramePlan& plan, const PlanUse& use) {
  const PlanResource& resource = plan.resources[use.resource];
  Json result = {{"resource", resource.name()},
                 {"access", access_info(use.access).name},
                 {"version", use.version},
                 {"writes", use.writes}};
  const auto* image = std::get_if<ImageDesc>(&resource.desc);
  if (image && use.range != whole(*image)) {
    result["mips"] = {use.range.first_mip, use.range.mip_count};  // first, count
    result["layers"] = {use.range.first_layer, use.range.layer_count};
  }
  if (image && use.view != image->kind) result["view"] = image_kind_name(use.view);
  if (use.step != PlanUse::every_step) result["step"] = use.step;
  return result;
}

Json pass_json(const FramePlan& plan, const PlanPass& pass) {
  Json reads = Json::array(), writes = Json::array(), uses = Json::array(), pipelines = Json::array();
  for (const PlanUse& use : pass.uses) {
    const std::string& name = plan.resources[use.resource].name();
    Json& side = use.writes ? writes : reads;
    if (std::find(side.begin(), side.end(), name) == side.end()) side.push_back(name);
    uses.push_back(use_json(plan, use));
  }
  for (const int pipeline : pass.pipelines)
    pipelines.push_back(std::visit([](const auto& desc) { return to_json(desc); }, plan.pipelines[pipeline]));
  Json result = {{"name", pass.name},
                 {"queue", pass.queue == Queue::compute ? "compute" : "main"},
                 {"reads", reads},
                 {"writes", writes},
                 {"uses", uses},
                 {"pipelines", pipelines},
                 {"knobs", knobs_json(pass.knobs)}};
  if (pass.steps() > 1) result["steps"] = pass.steps();
  return result;
}

Json resource_json(const PlanResource& resource) {
  constexpr const char* lifetimes[] = {"scene", "frame", "readback"};
  Json result = {{"name", resource.name()}, {"kind", resource.is_image() ? "image" : "buffer"}};
  if (const auto* image = std::get_if<ImageDesc>(&resource.desc)) {
    result["format"] = format_name(image->format);
    result["width"] = image->width_px;
    result["height"] = image->height_px;
    result["samples"] = image->samples;
    if (image->kind != ImageKind::d2) {
      result["shape"] = image_kind_name(image->kind);
      result["layers"] = image->layers;
      result["depth"] = image->depth_px;
    }
    if (image->mips > 1) result["mips"] = image->mips;
    result["block"] = resource.block;
  }
  result["bytes"] = resource.bytes;
  if (const auto& part = resource.resident) result["resident"] = {part->x, part->y, part->width, part->height};
  result["lifetime"] = lifetimes[int(resource.lifetime)];
  result["first_pass"] = resource.first_pass;
  result["last_pass"] = resource.last_pass;
  return result;
}

}  // namespace

std::string plan_json(const FramePlan& plan) {
  Json passes = Json::array(), left_out = Json::array(), resources = Json::array();
  for (const PlanPass& pass : plan.passes) passes.push_back(pass_json(plan, pass));
  for (const LeftOut& l : plan.left_out) left_out.push_back({{"pass", l.pass}, {"reason", l.reason}});
  for (const PlanResource& resource : plan.resources)
    if (resource.first_pass >= 0) resources.push_back(resource_json(resource));
  Json result = {{"passes", passes},
                 {"left_out", left_out},
                 {"resources", resources},
                 {"memory",
                  {{"transient_bytes", transient_bytes(plan)},
                   {"transient_bytes_unaliased", transient_bytes_unaliased(plan)},
                   {"transient_bytes_whole", transient_bytes_whole(plan)},
                   {"block_bytes", plan.block_bytes}}},
                 {"hash", plan_hash(plan).hex()}};
  for (const QueueBatch& batch : plan.batches)
    result["batches"].push_back({{"queue", batch.queue == Queue::compute ? "compute" : "main"},
                                 {"passes", batch.passes},
                                 {"waits", batch.waits}});
  return result.dump(2) + "\n";
}

}  // namespace candela
