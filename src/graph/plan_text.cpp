#include "graph/formats.h"
#include "graph/plan.h"

namespace candela {
namespace {

// Rows of cells, each column as wide as its widest cell; the first row is the heading.
class Table {
 public:
  explicit Table(std::vector<std::string> heading, std::string_view right_aligned = {})
      : rows_{std::move(heading)}, right_aligned_(right_aligned) {}
  void row(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }
  bool empty() const { return rows_.size() == 1; }
  bool has(const std::vector<std::string>& cells) const {
    return std::find(rows_.begin(), rows_.end(), cells) != rows_.end();
  }

  std::string text() const {
    std::vector<size_t> width(rows_[0].size(), 0);
    for (const auto& row : rows_)
      for (size_t c = 0; c < row.size(); ++c) width[c] = std::max(width[c], row[c].size());
    std::string result;
    for (const auto& row : rows_) {
      std::string line;
      for (size_t c = 0; c < row.size(); ++c)
        line += right(c) ? fmt::format("  {:>{}}", row[c], width[c]) : fmt::format("  {:<{}}", row[c], width[c]);
      line.erase(line.find_last_not_of(' ') + 1);
      result += line + "\n";
    }
    return result;
  }

 private:
  bool right(size_t column) const { return column < right_aligned_.size() && right_aligned_[column] == '>'; }
  std::vector<std::vector<std::string>> rows_;
  std::string_view right_aligned_;  // a '>' for each column with numbers
};

std::string human_bytes(uint64_t bytes) {
  if (bytes < 1024) return fmt::format("{} B", bytes);
  double value = double(bytes);
  size_t unit = 0;
  constexpr const char* units[] = {"B", "KiB", "MiB", "GiB"};
  for (; value >= 1024 && unit + 1 < std::size(units); ++unit) value /= 1024;
  return fmt::format("{:.2f} {}", value, units[unit]);
}

std::string use_text(const FramePlan& plan, const PlanUse& use) {
  const PlanResource& resource = plan.resources[use.resource];
  const auto* image = std::get_if<ImageDesc>(&resource.desc);
  return fmt::format("{}{} ({}{}){}", resource.name(), image ? range_text(use.range, *image) : "",
                     access_info(use.access).name,
                     image && use.view != image->kind ? fmt::format(" as {}", image_kind_name(use.view)) : "",
                     use.step == PlanUse::every_step ? "" : fmt::format(" in step {}", use.step));
}

std::string constants_text(const std::vector<SpecConstant>& constants) {
  std::string text;
  for (const SpecConstant& c : constants) text += fmt::format("{}{}={}", text.empty() ? "" : " ", c.name, c.value);
  return text;
}
std::string shaders_text(const ComputePipelineDesc& desc) { return desc.shader; }
std::string shaders_text(const GraphicsPipelineDesc& desc) {
  return desc.fragment_shader.empty() ? desc.vertex_shader : desc.vertex_shader + " " + desc.fragment_shader;
}

std::string shaders_text(const RayPipelineDesc& desc) {
  return fmt::format("{} {} {} {}", desc.raygen_shader, desc.miss_shader, desc.closest_hit_shader, desc.any_hit_shader);
}

std::string passes_text(const FramePlan& plan) {
  Table table({"#", "pass", "reads", "writes"}, ">");
  for (size_t i = 0; i < plan.passes.size(); ++i) {
    const PlanPass& pass = plan.passes[i];
    std::vector<std::string> reads, writes;
    for (const PlanUse& use : pass.uses) (use.writes ? writes : reads).push_back(use_text(plan, use));
    std::string name = pass.queue == Queue::compute ? pass.name + " [compute queue]" : pass.name;
    if (pass.steps() > 1) name += fmt::format(" [{} steps]", pass.steps());
    for (size_t line = 0; line < std::max({reads.size(), writes.size(), size_t(1)}); ++line)
      table.row({line ? "" : fmt::format("{}", i), line ? "" : name, line < reads.size() ? reads[line] : "",
                 line < writes.size() ? writes[line] : ""});
  }
  return table.text();
}

std::string pipelines_text(const FramePlan& plan) {
  Table table({"pass", "shaders", "constants"});
  for (const PlanPass& pass : plan.passes)
    for (const int pipeline : pass.pipelines)
      std::visit(
          [&](const auto& desc) {
            // Pipelines that differ in fixed state alone (topology, blending) are one line.
            std::vector<std::string> row = {pass.name, shaders_text(desc), constants_text(desc.constants)};
            if (!table.has(row)) table.row(std::move(row));
          },
          plan.pipelines[pipeline]);
  return table.empty() ? "" : "\npipelines\n" + table.text();
}

std::string knobs_text(const FramePlan& plan) {
  Table table({"knob", "value", "passes"});
  for (const PlanKnob& knob : plan_knobs(plan)) {
    std::string passes;
    for (const PlanPass& pass : plan.passes)
      if (std::find(pass.knobs.begin(), pass.knobs.end(), knob) != pass.knobs.end())
        passes += (passes.empty() ? "" : " ") + pass.name;
    table.row({knob.name, knob.value, passes});
  }
  return table.empty() ? "" : "\nknobs\n" + table.text();
}

// Nothing where one queue does all.
std::string batches_text(const FramePlan& plan) {
  Table table({"#", "queue", "passes", "waits for"}, "> ");
  for (size_t i = 0; i < plan.batches.size(); ++i) {
    const QueueBatch& batch = plan.batches[i];
    std::string passes, waits;
    for (const int pass : batch.passes) passes += fmt::format("{}{}", passes.empty() ? "" : ", ", pass);
    for (const int wait : batch.waits) waits += fmt::format("{}{}", waits.empty() ? "" : ", ", wait);
    table.row({fmt::format("{}", i), batch.queue == Queue::compute ? "compute" : "main", passes, waits});
  }
  return table.empty() ? "" : "\nbatches\n" + table.text();
}

std::string left_out_text(const FramePlan& plan) {
  Table table({"pass", "reason"});
  for (const LeftOut& left_out : plan.left_out) table.row({left_out.pass, left_out.reason});
  return table.empty() ? "" : "\nleft out\n" + table.text();
}

std::string images_text(const FramePlan& plan) {
  Table table({"image", "format", "size", "samples", "bytes", "passes", "block"}, "   >> >");
  for (const PlanResource& resource : plan.resources) {
    const auto* image = std::get_if<ImageDesc>(&resource.desc);
    if (!image || resource.first_pass < 0) continue;
    table.row({image->name, std::string(format_name(image->format)), image_size_text(*image),
               fmt::format("{}", image->samples), human_bytes(resource.bytes),
               fmt::format("{}-{}", resource.first_pass, resource.last_pass),
               resource.to_fill     ? "to keep"
               : resource.imported  ? "kept"
               : resource.block < 0 ? ""
                                    : fmt::format("{}", resource.block)});
  }
  return table.empty() ? "" : "\nimages\n" + table.text();
}

std::string buffers_text(const FramePlan& plan) {
  Table table({"buffer", "lifetime", "bytes", "passes", "block"}, "  > >");
  constexpr const char* lifetimes[] = {"scene", "frame", "readback"};
  for (const PlanResource& resource : plan.resources) {
    if (resource.is_image() || resource.first_pass < 0) continue;
    table.row({resource.name(), lifetimes[int(resource.lifetime)], human_bytes(resource.bytes),
               fmt::format("{}-{}", resource.first_pass, resource.last_pass),
               resource.block < 0 ? "" : fmt::format("{}", resource.block)});
  }
  return table.empty() ? "" : "\nbuffers\n" + table.text();
}

}  // namespace

std::vector<PlanKnob> plan_knobs(const FramePlan& plan) {
  std::vector<PlanKnob> knobs;
  for (const PlanPass& pass : plan.passes)
    for (const PlanKnob& knob : pass.knobs)
      if (std::find(knobs.begin(), knobs.end(), knob) == knobs.end()) knobs.push_back(knob);
  return knobs;
}

std::string image_size_text(const ImageDesc& image) {
  std::string text = fmt::format("{}x{}", image.width_px, image.height_px);
  if (image.kind == ImageKind::d3) text += fmt::format("x{}", image.depth_px);
  if (image.kind != ImageKind::d2) text += fmt::format(" {}", image_kind_name(image.kind));
  if (image.layers > 1 && image.kind != ImageKind::cube) text += fmt::format(" of {}", image.layers);
  if (image.mips > 1) text += fmt::format(", {} mips", image.mips);
  return text;
}

std::string plan_text(const FramePlan& plan) {
  const uint64_t aliased = transient_bytes(plan), unaliased = transient_bytes_unaliased(plan);
  const bool any_pages = std::ranges::any_of(plan.resources, [](const PlanResource& r) { return bool(r.resident); });
  const std::string whole = any_pages ? fmt::format("  {} on a device that has no memory by pages\n",
                                                    human_bytes(transient_bytes_whole(plan)))
                                      : "";
  return fmt::format(
      "plan {}: {} passes, {} left out\n\npasses\n{}{}{}{}{}{}{}\nmemory of the frame\n  {} ({} without aliasing)\n{}",
      plan_hash(plan).hex(), plan.passes.size(), plan.left_out.size(), passes_text(plan), batches_text(plan),
      left_out_text(plan), images_text(plan), buffers_text(plan), pipelines_text(plan), knobs_text(plan),
      human_bytes(aliased), human_bytes(unaliased), whole);
}

}  // namespace candela
