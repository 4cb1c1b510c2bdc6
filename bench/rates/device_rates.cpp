// What the device can do at most, as JSON: bytes, fused multiply-adds and 64-bit atomics a second, and the time of a
// pass that does nothing. bench/floors.py holds the times of a frame's passes against it.
//   device_rates [DEVICE [SHADERS]]
#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "gpu/command_list.h"
#include "gpu/device.h"
#include "gpu/device_select.h"
#include "gpu/frame_runner.h"
#include "graph/builder.h"

using namespace candela;

namespace {

struct Push {
  uint64_t source, target;
  uint32_t count, padding;
};

// The least time of a pass of `count` threads on buffers of 16 bytes a thread, in milliseconds.
double least_ms(gpu::FrameRunner& runner, const char* shader, uint32_t count, bool reads) {
  GraphBuilder builder;
  // An empty target: the pass makes one.
  const auto pass = [&](const char* name, const char* code, BufferHandle source, BufferHandle target) {
    builder.begin_pass(name);
    if (source) builder.read(source, Access::compute_read, "words");
    if (!target)
      target = builder.create(BufferDesc{.name = std::string(name) + ".words", .size_bytes = uint64_t(count) * 16});
    target = builder.write(target, Access::compute_write);
    const PipelineHandle pipeline = builder.pipeline(ComputePipelineDesc{.shader = code});
    builder.end_pass([=](CommandList& commands) {
      commands.bind(pipeline);
      commands.push(Push{source ? commands.address(source) : 0, commands.address(target), count, 0});
      const uint32_t groups = (count + 63) / 64, rows = (groups + 65534) / 65535;
      commands.dispatch((groups + rows - 1) / rows * 64, rows);
    });
    return target;
  };
  const BufferHandle source = reads ? pass("source", "write.comp", {}, {}) : BufferHandle{};
  builder.sink(pass("measured", shader, source, pass("target", "write.comp", {}, {})));
  const CompiledGraph graph = compile_graph(builder);
  if (const auto prepared = runner.prepare(graph); !prepared) throw std::runtime_error(prepared.error().text());
  double least = 1e9;
  for (int run = 0; run < 12; ++run)
    for (const gpu::PassTime& time : runner.run(graph, {}, {.timed = true}).passes)
      if (time.name == "measured") least = std::min(least, time.gpu_ms);
  return least;
}

}  // namespace

int main(int argc, char** argv) {
  auto opened = gpu::Device::open({.which = argc > 1 ? argv[1] : ""});
  if (!opened) {
    std::fprintf(stderr, "%s\n", opened.error().text().c_str());
    return int(opened.error().kind);
  }
  gpu::Device& device = **opened;
  gpu::Bindless bindless(device);
  gpu::FrameRunner runner(device, bindless, glsl::ShaderCompiler(argc > 2 ? argv[2] : CANDELA_RATES_SHADERS), {});
  const uint32_t large = device.info().is_cpu ? 1u << 20 : 1u << 25;  // 16 MiB or 512 MiB a buffer
  const double empty = least_ms(runner, "write.comp", 1, false);
  const auto rate = [&](const char* shader, bool reads, double each) {
    return each * double(large) / (least_ms(runner, shader, large, reads) * 1e-3);
  };
  const nlohmann::ordered_json json = {
      {"device", device.info().name},
      {"driver", device.info().driver},
      {"empty_pass_us", empty * 1e3},
      {"copied_bytes_per_s", rate("copy.comp", true, 32)},
      {"written_bytes_per_s", rate("write.comp", false, 16)},
      {"multiply_adds_per_s", rate("multiply_add.comp", false, 4096)},
      {"atomics_64_per_s", gpu::has_int64_atomics(device.physical()) ? rate("atomic_max.comp", false, 1) : 0.0}};
  std::printf("%s\n", json.dump(1).c_str());
}
