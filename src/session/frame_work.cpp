#include "plan/plan_frame.h"
#include "session/session.h"

namespace candela {
namespace {

template <class T>
std::string_view bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

}  // namespace

FrameWork work_of(const PlannedFrame& f) {
  FrameWork result;
  std::string work = f.graph().hash.hex();
  work += std::string_view(reinterpret_cast<const char*>(&f.upload.constants), sizeof f.upload.constants);
  for (const std::string_view bytes : {bytes_of(f.upload.lights), bytes_of(f.light_grid.bounds),
                                       bytes_of(f.light_grid.chunks), bytes_of(f.light_grid.globals)})
    work += fmt::format("{} ", bytes.size()), work += bytes;
  result.hash = hash128(work);
  for (const PlanPass& pass : f.graph().plan.passes) result.passes.emplace(pass.pass());
  return result;
}

Expected<FrameResult> Session::render(double time_s, bool hash_outputs) {
  const auto ticket = begin(time_s, hash_outputs);
  if (!ticket) return std::unexpected(ticket.error());
  return finish(*ticket);
}

}  // namespace candela
