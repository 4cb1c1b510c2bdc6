#include "passes/post/bloom.h"

#include <cmath>

#include "base/scratch.h"

namespace candela {
namespace {

// What the steps do, in order: down (levels), up (one fewer), or two convolutions a level; then composite, which goes
// up to the picture's size itself, and energy.
struct Steps {
  uint32_t levels = 0;  // of the pyramid; 0: convolutions
  uint32_t convolutions = 0;
  uint32_t composite() const { return levels > 0 ? 2 * levels - 1 : 2 * convolutions; }
};

Steps steps_of(const BloomPass& pass, const BloomPass::In& in) {
  const uint32_t wanted = uint32_t(in.look->weights.size());
  if (pass.knobs.levels == 0) return {0, wanted};
  // Halving ends at one texel.
  uint32_t possible = 1;
  while (possible < 31 && (std::max(in.width_px, in.height_px) >> (possible + 1)) > 0) ++possible;
  return {std::min({wanted, uint32_t(pass.knobs.levels), possible}), 0};
}

// Levels that the pyramid does not have are drawn as wide as its last. Their sum is 1, so that no sum of levels is
// beyond floats.
void find_weights(const Steps& steps, const Bloom& look, ScratchVector<float>& weights) {
  weights.assign(steps.levels > 0 ? steps.levels : look.weights.size(), 0.0f);
  double sum = 0;
  for (const double w : look.weights) sum += w;
  for (size_t k = 0; k < look.weights.size(); ++k)
    weights[std::min(k, weights.size() - 1)] += float(look.weights[k] / sum);
}

ImageHandle source_of(const BloomPass::In& in) { return in.look->of_emission ? in.source : in.color; }

// Of the composition and the steps up: a thread makes the pixels at 2 q - 1 and 2 q of each axis.
glm::uvec2 threads_up(glm::uvec2 size_px) { return size_px / 2u + 1u; }
uint64_t groups_of(glm::uvec2 threads) {
  return uint64_t((threads.x + shared::bloom_group - 1) / shared::bloom_group) * threads.y;
}

}  // namespace

std::span<const Knob> BloomPass::Knobs::table() {
  static const Knob table[] = {
      {.name = "levels",
       .member = &Knobs::levels,
       .lowest = 0,
       .highest = 12,
       .levels = {3, 6, 12, 0},
       .description = "levels of the pyramid, at most; fewer than the look has weights make the glow narrower; 0: "
                      "convolution in float",
       .sweep = {1, 2, 3, 6, 12, 0}},
      {.name = "karis",
       .member = &Knobs::karis,
       .lowest = 0,
       .highest = 1,
       .levels = {1, 1, 0, 0},
       .description = "1 holds single bright pixels down (no flicker of small lights), and loses their energy",
       .sweep = {1, 0}},
  };
  return table;
}

std::vector<std::string> BloomPass::warnings(const Report& report) const {
  if (report.nonfinite == 0) return {};
  return {fmt::format("bloom took {} non-finite pixels for black", report.nonfinite)};
}

std::vector<std::string> BloomPass::notes(const Report& report) const {
  if (!(report.before > 0)) return {};
  return {fmt::format("bloom: the picture's luminance sums to {:.6f} of what it was", report.after / report.before)};
}

Need BloomPass::needed(const SceneFacts&, const FrameRequest& request) const {
  if (!request.wants_looked("bloom", request.look.bloom.has_value()))
    return {false, "the look has no bloom (--look, --effects)"};
  return needed_if(request.draws_bloom(), "only display output shows bloom, and none is wanted");
}

BloomPass::Out BloomPass::declare(GraphBuilder& builder, const In& in) const {
  const Steps steps = steps_of(*this, in);
  // Half the picture, and a border that goes on with its edge, so that every level is exactly half the one before.
  const uint32_t unit = 1u << (std::max(steps.levels, 1u) - 1);
  const auto padded = [&](uint32_t size_px) { return (size_px + 2 * unit - 1) / (2 * unit) * unit; };
  const glm::uvec2 half{padded(in.width_px), padded(in.height_px)};
  Out out;
  out.report = builder.create(BufferDesc{"bloom.report", sizeof(Report), BufferMemory::host_read, true});
  const auto full = [&](const char* image) {
    return builder.create(
        ImageDesc{.name = image, .format = color_format, .width_px = in.width_px, .height_px = in.height_px});
  };
  const auto chain = [&](const char* image) {
    return builder.create(ImageDesc{.name = image,
                                    .format = color_format,
                                    .width_px = half.x,
                                    .height_px = half.y,
                                    .mips = std::max(steps.levels, 1u)});
  };
  const auto pipeline = [&](const char* shader, std::vector<SpecConstant> constants) {
    out.pipelines.push_back(builder.pipeline(ComputePipelineDesc{shader, std::move(constants)}));
  };
  if (steps.levels > 0) {
    out.down = chain("bloom.down");
    for (uint32_t k = 0; k < steps.levels; ++k) {
      pipeline("bloom_down.comp",
               k > 0 ? std::vector<SpecConstant>{}
                     : std::vector<SpecConstant>{{0, "IS_FIRST", 1}, {1, "KARIS", uint32_t(knobs.karis)}});
      builder.begin_step();
      if (k == 0) {
        builder.read(source_of(in), Access::sampled_compute, "what glows");
        out.report = builder.write(out.report, Access::compute_write);
      } else {
        builder.read(out.down, Access::sampled_compute, "the level before", ImageRange::mip(k - 1));
      }
      out.down = builder.write(out.down, Access::storage_image_write, ImageRange::mip(k));
    }
    if (steps.levels > 1) out.up = chain("bloom.up");
    for (uint32_t k = steps.levels - 1; k > 0; --k) {
      pipeline("bloom_up.comp", {});
      builder.begin_step();
      builder.read(k + 1 == steps.levels ? out.down : out.up, Access::sampled_compute, "the coarser level",
                   ImageRange::mip(k));
      builder.read(out.down, Access::sampled_compute, "the level", ImageRange::mip(k - 1));
      out.up = builder.write(out.up, Access::storage_image_write, ImageRange::mip(k - 1));
    }
  } else {
    // Each level: along x into `down`, along y onto the sum, which goes to and fro between `up` and `blurred`.
    out.down = full("bloom.along_x");
    out.up = full("bloom.sum");
    out.blurred = full("bloom.blurred");
    for (uint32_t k = 0; k < steps.convolutions; ++k) {
      pipeline("bloom_convolve.comp",
               k == 0 ? std::vector<SpecConstant>{{2, "COUNTS", 1}} : std::vector<SpecConstant>{});
      builder.begin_step();
      builder.read(source_of(in), Access::sampled_compute, "what glows");
      if (k == 0) out.report = builder.write(out.report, Access::compute_write);
      out.down = builder.write(out.down, Access::storage_image_write);
      pipeline("bloom_convolve.comp", k == 0 ? std::vector<SpecConstant>{{0, "ALONG_Y", 1}}
                                             : std::vector<SpecConstant>{{0, "ALONG_Y", 1}, {1, "ADDS", 1}});
      builder.begin_step();
      builder.read(out.down, Access::sampled_compute, "the rows");
      const bool last_is_blurred = (steps.convolutions - 1 - k) % 2 == 0;
      ImageHandle& target = last_is_blurred ? out.blurred : out.up;
      if (k > 0) builder.read(last_is_blurred ? out.up : out.blurred, Access::sampled_compute, "the sum");
      target = builder.write(target, Access::storage_image_write);
    }
  }
  std::vector<SpecConstant> composed;
  if (in.glow_wanted) composed.push_back({0, "HAS_GLOW", 1});
  if (in.look->of_emission) composed.push_back({1, "HAS_SOURCE", 1});
  if (steps.levels > 0) composed.push_back({2, "HALVED", 1});
  pipeline("bloom_composite.comp", composed);
  builder.begin_step();
  builder.read(in.color, Access::sampled_compute, "color");
  if (in.look->of_emission) builder.read(in.source, Access::sampled_compute, "what glows");
  if (steps.levels > 0)
    builder.read(steps.levels > 1 ? out.up : out.down, Access::sampled_compute, "the blurred levels",
                 ImageRange::mip(0));
  else
    builder.read(out.blurred, Access::sampled_compute, "the blurred levels");
  out.color = builder.write(full("bloomed"), Access::storage_image_write);
  if (in.glow_wanted) {
    out.glow = builder.write(full("bloom.glow"), Access::storage_image_write);
    builder.publish("bloom", out.glow);
  }
  out.energies =
      builder.write(builder.create(BufferDesc{"bloom.energies",
                                              groups_of(threads_up({in.width_px, in.height_px})) * sizeof(glm::vec2)}),
                    Access::compute_write);
  pipeline("bloom_energy.comp", {});
  builder.begin_step();
  builder.read(out.energies, Access::compute_read, "the groups' luminance");
  out.report = builder.write(out.report, Access::compute_write);
  builder.sink(out.report);
  return out;
}

void BloomPass::record(CommandList& commands, const In& in, const Out& out) const {
  const Steps steps = steps_of(*this, in);
  const uint32_t step = commands.step(), composite = steps.composite();
  Scratch scratch;
  ScratchVector<float> weights(&scratch);
  find_weights(steps, *in.look, weights);
  const float threshold = float(in.look->threshold) / *in.exposure, knee = float(in.look->knee) / *in.exposure;
  const glm::uvec2 full{in.width_px, in.height_px};
  const glm::uvec2 threads = threads_up(full);  // of the composition
  commands.bind(out.pipelines[step]);
  if (step == composite + 1) {
    commands.push(shared::BloomEnergyPush{commands.address(out.energies), commands.address(out.report),
                                          uint32_t(groups_of(threads))});
    commands.dispatch(shared::bloom_energy_group);
  } else if (step == composite) {
    shared::BloomCompositePush push{};
    push.color = commands.sampled(in.color);
    push.source = in.look->of_emission ? commands.sampled(in.source) : 0;
    if (steps.levels > 0) {
      push.bloom = commands.sampled(steps.levels > 1 ? out.up : out.down, ImageRange::mip(0));
      push.bloom_weight = steps.levels > 1 ? 1.0f : weights[0];
    } else {
      push.bloom = commands.sampled(out.blurred);
    }
    push.composed = commands.storage(out.color);
    push.glow = out.glow ? commands.storage(out.glow) : 0;
    push.size_px = full;
    push.strength = float(in.look->strength);
    push.threshold = threshold, push.knee = knee;
    push.keeps = in.look->keeps ? 1 : 0;
    push.energies = commands.address(out.energies);
    commands.push(push);
    commands.dispatch(threads.x, threads.y);
  } else if (steps.levels == 0) {
    const uint32_t k = step / 2;
    const bool along_y = step % 2 != 0, to_blurred = (steps.convolutions - 1 - k) % 2 == 0;
    shared::BloomConvolvePush push{};
    push.source = along_y ? commands.sampled(out.down) : commands.sampled(source_of(in));
    push.target = commands.storage(!along_y ? out.down : to_blurred ? out.blurred : out.up);
    if (along_y && k > 0) push.sum = commands.sampled(to_blurred ? out.up : out.blurred);
    push.size_px = full;
    push.sigma_px = float(std::sqrt(Bloom::variance_px2(k)));
    push.weight = weights[k];
    push.threshold = threshold, push.knee = knee;
    push.report = step == 0 ? commands.address(out.report) : 0;
    commands.push(push);
    commands.dispatch(full.x, full.y);
  } else if (step < steps.levels) {
    shared::BloomDownPush push{};
    push.source = step == 0 ? commands.sampled(source_of(in)) : commands.sampled(out.down);
    push.target = commands.storage(out.down);
    push.source_px = step == 0 ? full : commands.size(out.down, step - 1);
    push.target_px = commands.size(out.down, step);
    push.threshold = threshold, push.knee = knee;
    push.report = step == 0 ? commands.address(out.report) : 0;
    commands.push(push);
    const glm::uvec2 quads = (push.target_px + 1u) / 2u;
    commands.dispatch(quads.x, quads.y);
  } else {
    const uint32_t k = 2 * steps.levels - 1 - step;  // from mip k to mip k - 1
    shared::BloomUpPush push{};
    push.coarse = commands.sampled(k + 1 == steps.levels ? out.down : out.up, ImageRange::mip(k));
    push.coarse_weight = k + 1 == steps.levels ? weights[k] : 1.0f;
    push.fine = commands.sampled(out.down, ImageRange::mip(k - 1));
    push.fine_weight = weights[k - 1];
    push.target = commands.storage(out.up);
    push.target_px = commands.size(out.up, k - 1);
    commands.push(push);
    const glm::uvec2 up = threads_up(push.target_px);
    commands.dispatch(up.x, up.y);
  }
}

}  // namespace candela
