#include "passes/transparency/fragments.h"

namespace candela {
namespace {

constexpr uint64_t bytes_a_fragment = sizeof(shared::StoredFragment) + sizeof(uint32_t);  // and its place in the order
enum FragmentsStep : uint32_t { count_step, sum_step, scan_step, rounds_step, first_round };

uint32_t quads_of(const SceneInputs& s) { return (s.width_px + 1) / 2 * ((s.height_px + 1) / 2); }
uint32_t groups_of(const SceneInputs& s) {
  return (quads_of(s) + shared::fragments_quads - 1) / shared::fragments_quads;
}
// Of threads, in two dimensions: a device has 65,535 groups in one.
glm::uvec2 sum_threads(const SceneInputs& s) {
  const uint32_t groups = groups_of(s), across = std::min(groups, 1024u);
  return {across * shared::fragments_group, (groups + across - 1) / across};
}

}  // namespace

std::span<const Knob> Fragments::Knobs::table() {
  static const Knob table[] = {
      {.name = "memory_mib",
       .member = &Knobs::memory_mib,
       .unit = "MiB",
       .lowest = 1,
       .highest = 3072,
       .levels = {},
       .description =
           "memory for stored fragments, 44 bytes each; a round uses half of it, and a quad of pixels must fit in that",
       .kind = Trades::time,
       .sweep = {64, 256}},
      {.name = "rounds",
       .member = &Knobs::rounds,
       .lowest = 1,
       .highest = 1024,
       .levels = {},
       .description = "rounds of storing, sorting and blending, at most; a frame whose fragments are more is refused",
       .kind = Trades::time,
       .sweep = {4, 16}},
  };
  return table;
}

uint64_t Fragments::room() const { return uint64_t(knobs.memory_mib) * 1024 * 1024 / bytes_a_fragment / 2; }

std::vector<std::string> Fragments::notes(const Report& report) const {
  if (!part.empty()) return {};  // beauty's notes say it
  return {
      fmt::format("layers: {} fragments of blended surfaces, at most {} in four pixels", report.total, report.most)};
}

Fragments::Knobs Fragments::most() {
  Knobs knobs;
  for (const Knob& knob : Knobs::table()) knob.set(&knobs, knob.highest);
  return knobs;
}

uint64_t Fragments::memory_bytes(uint64_t fragments_of_a_quad, uint64_t pixels, int samples) {
  const uint64_t stored = std::max(Fragments{}.room(), fragments_of_a_quad) * 2 * bytes_a_fragment;
  constexpr uint64_t cell_bytes = 9;  // nine words a quad
  return stored + pixels * (cell_bytes + uint64_t(samples) * sizeof(glm::vec4));
}

std::vector<KnobSetting> Fragments::enlarged(const Report& report) const {
  if (report.total >= shared::fragments_held) return {};
  Fragments larger;
  larger.knobs.memory_mib = knobs.memory_mib;
  const uint64_t mib = (report.most * bytes_a_fragment * 2 >> 20) + 1;
  larger.knobs.memory_mib = int(std::max<uint64_t>(uint64_t(knobs.memory_mib), mib));
  const uint64_t rounds = report.total / larger.room() + 1;
  if (larger.knobs.memory_mib > most().memory_mib || rounds > uint64_t(most().rounds)) return {};
  return {{std::string(Knobs::name), "memory_mib", fmt::format("{}", larger.knobs.memory_mib)},
          {std::string(Knobs::name), "rounds", fmt::format("{}", std::max<uint64_t>(rounds, uint64_t(knobs.rounds)))}};
}

std::string Fragments::refusal(const Report& report) const {
  const uint64_t held = room() * uint64_t(knobs.rounds);
  if (report.total <= held && report.most <= room() && report.total < shared::fragments_held) return {};
  if (report.total >= shared::fragments_held)
    return "--transparency layers: 2^31 fragments of blended surfaces or more; make the picture smaller";
  const uint64_t mib = (std::max<uint64_t>(report.most, (report.total + knobs.rounds - 1) / uint64_t(knobs.rounds)) *
                        bytes_a_fragment * 2) >>
                       20;
  return fmt::format(
      "--transparency layers: {} fragments of blended surfaces, {} of them in four pixels; fragments.memory_mib = {} "
      "and fragments.rounds = {} hold {} and {}: set memory_mib to {} or more rounds",
      report.total, report.most, knobs.memory_mib, knobs.rounds, held, room(), mib + 1);
}

Need Fragments::needed(const SceneFacts& facts, const FrameRequest& request) const {
  return needs_method(facts, request, method);
}

Fragments::Out Fragments::declare(GraphBuilder& builder, const In& in) const {
  const SceneInputs& s = in.scene;
  const uint64_t quads = quads_of(s), runs = s.draw_batches->size();
  Out out;
  const auto written = [&](BufferHandle& buffer, Access access = Access::compute_write) {
    buffer = builder.write(buffer, access);
  };
  out.buffers.cells =
      builder.create(BufferDesc{"fragments.cells", (4 + quads * 9 + groups_of(s)) * 4, BufferMemory::device, true});
  // Threads store in the order in which they arrive.
  out.buffers.stored = builder.create(
      BufferDesc{"fragments.stored", 2 * room() * sizeof(shared::StoredFragment), BufferMemory::device, false, true});
  out.buffers.order =
      builder.create(BufferDesc{"fragments.order", 2 * room() * sizeof(uint32_t), BufferMemory::device, false, true});
  out.buffers.blended = builder.create(
      BufferDesc{"fragments.blended", quads * 4 * s.samples * sizeof(glm::vec4), BufferMemory::device, false, true});
  out.buffers.rounds = builder.create(BufferDesc{"fragments.rounds", uint64_t(knobs.rounds) * (3 + runs) * 4});
  out.report = builder.create(BufferDesc{"fragments.report", sizeof(Report), BufferMemory::host_read});

  builder.begin_step();
  out.depth = in.depth;
  if (in.depth) {
    builder.read(in.depth, Access::depth_test, "depth");
  } else {
    out.depth = builder.create(ImageDesc{"fragments.z", depth_format, s.width_px, s.height_px, s.samples});
    out.depth = builder.write(out.depth, Access::depth_attachment);
  }
  GraphicsPipelineDesc counted;
  counted.vertex_shader = "draw.vert", counted.fragment_shader = "fragments_count.frag";
  counted.samples = s.samples;
  test_depth(counted, true);
  out.counted = declare_batches(builder, s, in.draws, in.deformed,
                                [](const DrawBatch& r) { return r.alpha == AlphaMode::blend; }, {counted, {}});
  written(out.buffers.cells, Access::fragment_write);

  builder.begin_step();
  out.pipelines.sum = builder.pipeline(ComputePipelineDesc{"fragments_sum.comp", {}});
  written(out.buffers.cells);
  builder.begin_step();
  out.pipelines.scan = builder.pipeline(ComputePipelineDesc{"fragments_scan.comp", {}});
  written(out.buffers.cells);
  builder.begin_step();
  out.pipelines.rounds = builder.pipeline(ComputePipelineDesc{"fragments_rounds.comp", {}});
  builder.read(in.draws.counts, Access::compute_read, "draw counts");
  written(out.buffers.cells);
  written(out.buffers.rounds);
  written(out.report);

  GraphicsPipelineDesc drawn;
  drawn.vertex_shader = "draw.vert#STORED=1";
  out.pipelines.blend = builder.pipeline(ComputePipelineDesc{"fragments_blend.comp", {{0, "SAMPLES", s.samples}}});
  for (int round = 0; round < knobs.rounds; ++round) {
    builder.begin_step();
    BlendedIn stored = in;
    stored.depth = out.depth;
    stored.draws.counts = out.buffers.rounds;
    drawn.fragment_shader = part;
    out.drawn = declare_blended(builder, stored, drawn, fmt::format("#STORED={}", s.samples));
    written(out.buffers.cells, Access::fragment_write);
    written(out.buffers.stored, Access::fragment_write);
    builder.begin_step();
    builder.read(out.buffers.rounds, Access::indirect_read, "groups of threads");
    builder.read(out.buffers.cells, Access::compute_read, "the pixels' fragments");
    builder.read(out.buffers.stored, Access::compute_read, "fragments");
    builder.read(in.color, Access::sampled_compute, "what lies behind");
    written(out.buffers.order);
    written(out.buffers.blended);
  }

  builder.begin_step();
  builder.read(out.buffers.cells, Access::fragment_read, "the pixels' fragments");
  builder.read(out.buffers.blended, Access::fragment_read, "the blended samples");
  GraphicsPipelineDesc over;
  over.vertex_shader = "background.vert", over.fragment_shader = "fragments_over.frag";
  over.constants = {{0, "SAMPLES", s.samples}};
  over.color_formats = {color_format};
  over.samples = s.samples;
  out.pipelines.over = builder.pipeline(over);
  out.color = builder.write(in.color, Access::color_attachment);
  builder.sink(out.report);
  return out;
}

void Fragments::record(CommandList& commands, const In& in, const Out& out) const {
  const SceneInputs& s = in.scene;
  const uint32_t step = commands.step(), over_step = first_round + 2 * uint32_t(knobs.rounds);
  shared::FragmentsPush push{};
  push.cells = commands.address(out.buffers.cells);
  push.size_px = {s.width_px, s.height_px};
  push.room = uint32_t(room());
  push.most_rounds = uint32_t(knobs.rounds);
  push.runs = uint32_t(s.draw_batches->size());
  const bool draws = step == count_step || (step >= first_round && step < over_step && (step - first_round) % 2 == 0);
  if (draws) {
    OwnInputs own;
    own.table = out.buffers.cells;
    commands.begin_picture({}, out.depth);
    if (step == count_step) {
      record_batches(commands, s, in.draws, in.deformed, out.counted, nullptr, nullptr, own);
    } else {
      Draws round = in.draws;
      round.counts = out.buffers.rounds;
      own.deformed_before = out.buffers.stored;
      own.number = (step - first_round) / 2;
      own.first_count = (3 * push.most_rounds + own.number * push.runs) * sizeof(uint32_t);
      record_batches(commands, s, round, in.deformed, out.drawn, &in.lists, &in.lists, own);
    }
    commands.end_rendering();
  } else if (step == sum_step || step == scan_step) {
    commands.bind(step == sum_step ? out.pipelines.sum : out.pipelines.scan);
    commands.push(push);
    const glm::uvec2 threads = sum_threads(s);
    commands.dispatch(threads.x, threads.y);
  } else if (step == rounds_step) {
    push.counts = commands.address(in.draws.counts);
    push.rounds = commands.address(out.buffers.rounds);
    push.report = commands.address(out.report);
    commands.bind(out.pipelines.rounds);
    commands.push(push);
    commands.dispatch(1);
  } else if (step < over_step) {
    push.round_number = (step - first_round) / 2;
    push.stored = commands.address(out.buffers.stored);
    push.order = commands.address(out.buffers.order);
    push.blended = commands.address(out.buffers.blended);
    push.color = commands.sampled(in.color);
    commands.bind(out.pipelines.blend);
    commands.push(push);
    commands.dispatch_indirect(out.buffers.rounds, push.round_number * 3 * sizeof(uint32_t));
  } else {
    push.blended = commands.address(out.buffers.blended);
    const CommandList::Attachment color{out.color};
    commands.begin_picture({&color, 1}, {});
    commands.bind(out.pipelines.over);
    draw_samples(commands, s.samples, push);
    commands.end_rendering();
  }
}

}  // namespace candela
