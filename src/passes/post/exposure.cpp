#include "passes/post/exposure.h"

namespace candela {

std::span<const Knob> Exposure::Knobs::table() {
  static const Knob table[] = {
      {.name = "bins",
       .member = &Knobs::bins,
       .lowest = 16,
       .highest = 4096,
       .levels = {64, 256, 1024, 4096},
       .description = "bins of the histogram over 48 stops; a luminance counts as the middle of its bin",
       .sweep = {16, 64, 256, 1024, 4096}},
  };
  return table;
}

std::vector<std::string> Exposure::warnings(const Report&) const { return {}; }

std::vector<std::string> Exposure::notes(const Report& report) const {
  return {fmt::format("exposure: {:+.3f} stops by the luminance of {} pixels", report.ev, report.pixels)};
}

Need Exposure::needed(const SceneFacts&, const FrameRequest& request) const {
  if (!request.wants_looked("exposure", request.look.exposure.automatic.has_value()))
    return {false, "the look has no automatic exposure (--look, --effects)"};
  return needed_if(request.want_display && request.view_is_light, "only display output is exposed, and none is wanted");
}

Exposure::Out Exposure::declare(GraphBuilder& builder, const In& in) const {
  const std::vector<SpecConstant> bins = {{0, "BINS", uint32_t(knobs.bins)}};
  Out out;
  out.counts = builder.create(
      BufferDesc{.name = "exposure.counts", .size_bytes = uint64_t(knobs.bins) * sizeof(uint32_t), .zeroed = true});
  out.pipelines = {builder.pipeline(ComputePipelineDesc{"exposure_count.comp", bins}),
                   builder.pipeline(ComputePipelineDesc{"exposure_mean.comp", bins})};
  builder.begin_step();
  builder.read(in.color, Access::sampled_compute, "color");
  out.counts = builder.write(out.counts, Access::compute_write);
  builder.begin_step();
  builder.read(out.counts, Access::compute_read, "the histogram");
  out.exposure = builder.write(builder.create(BufferDesc{"exposure.factor", sizeof(Report)}), Access::compute_write);
  out.report = builder.write(builder.create(BufferDesc{"exposure.report", sizeof(Report), BufferMemory::host_read}),
                             Access::compute_write);
  builder.sink(out.report);
  return out;
}

void Exposure::record(CommandList& commands, const In& in, const Out& out) const {
  commands.bind(out.pipelines[commands.step()]);
  if (commands.step() == 0) {
    commands.push(shared::ExposureCountPush{
        commands.address(out.counts), commands.sampled(in.color), {in.width_px, in.height_px}, *in.scale});
    commands.dispatch(in.width_px, (in.height_px + shared::exposure_rows - 1) / shared::exposure_rows);
  } else {
    shared::ExposureMeanPush push{};
    push.counts = commands.address(out.counts);
    push.result = commands.address(out.exposure), push.report = commands.address(out.report);
    push.low = float(in.look->low_percent / 100), push.high = float(in.look->high_percent / 100);
    push.target = float(in.look->target);
    push.min_ev = float(in.look->min_ev), push.max_ev = float(in.look->max_ev);
    commands.push(push);
    commands.dispatch(1);
  }
}

}  // namespace candela
