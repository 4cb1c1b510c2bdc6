#include "session/one_picture.h"

#include <algorithm>

namespace candela {
namespace {

// Stages and passes under their names, as sums; of maps and bytes likewise.
void add_times(const Timings& of, Timings& to) {
  for (const auto& [stage, ms] : of.cpu_ms) to.add(stage, ms);
  for (const gpu::PassTime& pass : of.gpu_ms) {
    const auto same = std::ranges::find(to.gpu_ms, pass.name, &gpu::PassTime::name);
    if (same == to.gpu_ms.end())
      to.gpu_ms.push_back(pass);
    else
      same->gpu_ms += pass.gpu_ms;
  }
  to.frame_gpu_ms += of.frame_gpu_ms;
  to.lamp_maps += of.lamp_maps, to.lamp_maps_drawn += of.lamp_maps_drawn, to.lamp_maps_over += of.lamp_maps_over;
  to.uploaded_bytes += of.uploaded_bytes, to.heap_allocations += of.heap_allocations;
  to.spans.insert(to.spans.end(), of.spans.begin(), of.spans.end());
}

void add_new(const std::vector<std::string>& lines, std::vector<std::string>& to) {
  for (const std::string& line : lines)
    if (std::ranges::find(to, line) == to.end()) to.push_back(line);
}

}  // namespace

FrameResult one_picture(std::vector<FrameResult> frames) {
  FrameResult picture = std::move(frames.back());
  if (frames.size() == 1) return picture;
  Timings times;
  std::vector<std::string> notes, warnings;
  std::vector<gpu::PassHash> hashes;
  const auto take = [&](const FrameResult& frame) {
    add_times(frame.timings, times);
    add_new(frame.notes, notes), add_new(frame.warnings, warnings);
    hashes.insert(hashes.end(), frame.hashes.begin(), frame.hashes.end());
  };
  for (size_t i = 0; i + 1 < frames.size(); ++i) take(frames[i]);
  take(picture);
  times.overlap = picture.timings.overlap;
  picture.timings = std::move(times), picture.hashes = std::move(hashes);
  picture.notes = std::move(notes), picture.warnings = std::move(warnings);
  picture.plan_hash = hash128(frames.front().plan_hash.hex() + picture.plan_hash.hex());
  return picture;
}

}  // namespace candela
