#include <bit>
#include <charconv>

#include "graph/plan.h"

namespace candela {
namespace {

// Every field ends in a separator and every string says its length, so that no two plans give the same text.
class Text {
 public:
  void number(uint64_t value) { digits(value), text_ += ';'; }
  void word(std::string_view value) { text_ += value, text_ += ';'; }
  void string(const std::string& value) { digits(value.size()), text_ += ':', word(value); }
  const std::string& text() const { return text_; }

 private:
  void digits(uint64_t value) {
    char digits[20];
    text_.append(digits, std::to_chars(std::begin(digits), std::end(digits), value).ptr);
  }
  std::string text_;
};

void add(Text& out, const std::vector<SpecConstant>& constants) {
  out.number(constants.size());
  for (const SpecConstant& c : constants) out.number(c.id), out.string(c.name), out.number(c.value);
}
void add(Text& out, const ComputePipelineDesc& desc) {
  out.string(desc.shader);
  add(out, desc.constants);
}
void add(Text& out, const GraphicsPipelineDesc& desc) {
  out.string(desc.vertex_shader);
  out.string(desc.fragment_shader);
  add(out, desc.constants);
  out.number(desc.topology);
  out.number(desc.color_formats.size());
  for (const VkFormat format : desc.color_formats) out.number(format);
  for (const uint64_t field : {uint64_t(desc.depth_format), uint64_t(desc.samples), uint64_t(desc.depth_compare),
                               uint64_t(desc.depth_test), uint64_t(desc.depth_write), uint64_t(desc.blend)})
    out.number(field);
  if (!desc.attachments.empty()) {
    out.word("attachments");
    out.number(desc.attachments.size());
    for (const AttachmentState& a : desc.attachments) out.number(uint64_t(a.blend)), out.number(a.write_mask);
  }
  if (desc.stencil_test) {
    out.word("stencil");
    const StencilState& s = desc.stencil;
    for (const uint64_t field : {uint64_t(s.compare), uint64_t(s.fail), uint64_t(s.depth_fail), uint64_t(s.pass),
                                 uint64_t(s.read_mask), uint64_t(s.write_mask)})
      out.number(field);
  }
  if (desc.depth_bias_constant != 0 || desc.depth_bias_slope != 0 || desc.depth_clamp) {
    out.word("bias");
    for (const uint32_t field : {std::bit_cast<uint32_t>(desc.depth_bias_constant),
                                 std::bit_cast<uint32_t>(desc.depth_bias_slope), uint32_t(desc.depth_clamp)})
      out.number(field);
  }
}
void add(Text& out, const RayPipelineDesc& desc) {
  for (const std::string* shader :
       {&desc.raygen_shader, &desc.miss_shader, &desc.closest_hit_shader, &desc.any_hit_shader})
    out.string(*shader);
  add(out, desc.constants);
}
void add(Text& out, const ImageDesc& desc) {
  out.string(desc.name);
  for (const uint32_t field : {uint32_t(desc.format), desc.width_px, desc.height_px, desc.samples}) out.number(field);
  for (const float channel : desc.clear) out.number(std::bit_cast<uint32_t>(channel));
  out.number(desc.covered);
  if (desc.kind == ImageKind::d2 && desc.mips == 1) return;
  out.word("shape");
  for (const uint32_t field : {uint32_t(desc.kind), desc.mips, desc.layers, desc.depth_px}) out.number(field);
}
void add(Text& out, const ImageRange& range) {
  for (const uint32_t field : {range.first_mip, range.mip_count, range.first_layer, range.layer_count})
    out.number(field);
}
// Words that no number can be, and only where there is something to say: the plan of plain images keeps its hash.
void add_part(Text& out, const PlanUse& use) {
  const bool plain = use.range == ImageRange{0, 1, 0, 1} && use.view == ImageKind::d2;
  if (!plain) {
    out.word("part");
    add(out, use.range);
    out.number(uint64_t(use.view));
  }
  if (use.step != PlanUse::every_step) {
    out.word("step");
    out.number(uint64_t(use.step));
  }
}
void add(Text& out, const BufferDesc& desc) {
  out.string(desc.name);
  out.number(desc.size_bytes);
  out.number(uint64_t(desc.memory));
  out.number(desc.zeroed);
}

}  // namespace

// Equal hashes mean that the same physical resources serve both plans: the places of the used resources count, what was
// left out does not.
Hash128 plan_hash(const FramePlan& plan) {
  Text out;
  out.number(plan.passes.size());
  for (const PlanPass& pass : plan.passes) {
    out.string(pass.name);
    out.number(uint64_t(pass.queue));
    out.number(pass.uses.size());
    for (const PlanUse& use : pass.uses) {
      for (const uint64_t field :
           {uint64_t(use.resource), uint64_t(use.access), uint64_t(use.version), uint64_t(use.writes)})
        out.number(field);
      add_part(out, use);
    }
    if (pass.steps() > 1) {
      out.word("steps");
      out.number(pass.steps());
    }
    out.number(pass.pipelines.size());
    for (const int pipeline : pass.pipelines) out.number(uint64_t(pipeline));
    out.number(pass.knobs.size());
    for (const PlanKnob& knob : pass.knobs) out.string(knob.name), out.string(knob.value);
  }
  out.number(plan.pipelines.size());
  for (const PipelineDesc& pipeline : plan.pipelines) {
    out.number(pipeline.index());
    std::visit([&](const auto& desc) { add(out, desc); }, pipeline);
  }
  for (size_t i = 0; i < plan.resources.size(); ++i) {
    const PlanResource& resource = plan.resources[i];
    if (resource.first_pass < 0) continue;
    out.number(i);
    out.number(resource.desc.index());
    std::visit([&](const auto& desc) { add(out, desc); }, resource.desc);
    for (const uint64_t field :
         {uint64_t(resource.imported), uint64_t(resource.last_pass), uint64_t(resource.block + 1)})
      out.number(field);
    if (resource.to_fill) out.word("fill");
  }
  if (plan.parts) {
    out.word("region");
    for (const PixelRect& r : {plan.parts->seen, plan.parts->shaded})
      for (const int field : {r.x, r.y, r.width, r.height}) out.number(uint64_t(field));
  }
  return hash128(out.text());
}

}  // namespace candela
