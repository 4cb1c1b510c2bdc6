#include "bench/error_walk.h"

#include <map>

#include "base/text.h"
#include "frame/plan_frame.h"
#include "gltf/gltf.h"

namespace candela {
namespace {

std::string place_of(const Configuration& c) {
  return fmt::format("{}\n{}\n{}\n{}x{}\n{:a}\n{}", c.scene.label, c.seed, c.lights.value_or(-1), c.job.width_px,
                     c.job.height_px, c.time_s, c.scene.camera.camera);
}

template <class T>
std::string_view bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

// Of all that knobs decide about a frame's work.
Hash128 work_of(const PlannedFrame& f) {
  std::string work = plan_hash(f.graph.plan).hex();
  work += std::string_view(reinterpret_cast<const char*>(&f.upload.constants), sizeof f.upload.constants);
  for (const std::string_view bytes : {bytes_of(f.upload.lights), bytes_of(f.light_grid.bounds),
                                       bytes_of(f.light_grid.chunks), bytes_of(f.light_grid.globals)})
    work += fmt::format("{} ", bytes.size()), work += bytes;
  return hash128(work);
}

class Walker {
 public:
  Walker(const Suite& whole, SceneStore& store) : whole_(whole), store_(store) {}

  // Adds rows of all knobs to a place whose rows are those of suite "whole".
  void walk(SweepPlace& place) {
    for (size_t i = 0, whole = place.rows.size(); i < whole; ++i) {
      const Configuration exact = place.rows[i].configuration;
      if (exact.job.quality != "exact" || !exact.left_out.empty()) continue;
      if (auto loaded = load(exact); !loaded) {
        place.notes.push_back(fmt::format("{}: no knob was walked: {}", exact.scene.label, loaded.error().text()));
        return;
      }
      const auto planned = plan(exact.job, exact.time_s);
      if (!planned) {
        place.notes.push_back(fmt::format("{} with {}: no knob was walked: {}", exact.scene.label, exact.job.technique,
                                          planned.error().text()));
        continue;
      }
      std::vector<std::string> same;
      for (const KnobRow& knob : knob_rows("exact"))
        if (knob.kind != "look" && knob.walk.size() > 1) walk_knob(place, i, knob, *planned, same);
      if (!same.empty())
        place.notes.push_back(fmt::format("{} with {}: the same work as at another value, and not measured again: {}",
                                          exact.scene.label, exact.job.technique, joined(same)));
    }
  }

 private:
  Expected<void> load(const Configuration& c) {
    const auto file = store_.file_of(c);
    if (!file) return std::unexpected(file.error());
    if (*file == file_) return {};
    auto scene = load_gltf(*file);
    if (!scene) return std::unexpected(scene.error());
    scene_ = std::move(*scene);
    auto layout = layout_geometry(scene_);
    if (!layout) return std::unexpected(layout.error());
    layout_ = std::move(*layout);
    file_ = *file;
    return {};
  }

  Expected<PlannedFrame> plan(const Job& job, double time_s) const {
    return plan_frame(job, PlanContext{scene_, layout_}, {.linear = true, .display = whole_.output == "both"}, time_s);
  }

  void walk_knob(SweepPlace& place, size_t exact_row, const KnobRow& knob, const PlannedFrame& exact,
                 std::vector<std::string>& same) const {
    const std::string name = knob.pass + "." + knob.knob;
    std::vector<std::string> kept;
    for (const PlanPass& pass : exact.graph.plan.passes)
      if (std::find(knob.passes.begin(), knob.passes.end(), pass.pass()) != knob.passes.end())
        kept.push_back(pass.name);
    if (kept.empty()) return;
    const Configuration c = place.rows[exact_row].configuration;
    std::vector<Hash128> works = {work_of(exact)};
    std::vector<std::string> skipped;
    for (const std::string& value : knob.walk) {
      if (value == knob.value_now) continue;
      Configuration changed = c;
      changed.job.settings = {{knob.pass, knob.knob, value}};
      const auto planned = plan(changed.job, changed.time_s);
      const Hash128 work = planned ? work_of(*planned) : Hash128{};
      if (planned && std::find(works.begin(), works.end(), work) != works.end()) {
        skipped.push_back(name + "=" + value);
        continue;
      }
      works.push_back(work);
      place.rows.push_back({"knob " + name, std::move(changed), {{name, value, knob.kind, knob.passes}}});
    }
    if (works.size() == 1) skipped = {name};
    same.insert(same.end(), skipped.begin(), skipped.end());
    if (works.size() > 1) place.rows[exact_row].knobs.push_back({name, knob.value_now, knob.kind, knob.passes});
  }

  const Suite& whole_;
  SceneStore& store_;
  std::string file_;
  Scene scene_;
  GeometryLayout layout_;
};

}  // namespace

Expected<std::vector<SweepPlace>> sweep_places(const Suite& base, SceneStore& store) {
  Suite whole = base;
  whole.set.clear();
  whole.qualities = {"exact", "draft", "normal", "high"};
  whole.samples = {0};
  // Errors are of linear pictures.
  if (whole.output == "png") whole.output = "both";
  if (whole.techniques.empty()) {
    // The job's own technique first.
    const std::string first = Job{}.technique;
    whole.techniques.push_back({first, {}});
    for (const std::string& name : technique_names())
      if (name != first) whole.techniques.push_back({name, {}});
  }
  for (SuiteTechnique& technique : whole.techniques) technique.set.clear();
  auto all = configurations(whole);
  if (!all) return std::unexpected(all.error());
  std::vector<SweepPlace> places;
  std::map<std::string, size_t> index;
  for (Configuration& c : *all) {
    const auto [at, made] = index.try_emplace(place_of(c), places.size());
    if (made) places.emplace_back();
    places[at->second].rows.push_back({"whole", std::move(c), {}});
  }
  Walker walker(whole, store);
  for (SweepPlace& place : places) walker.walk(place);
  return places;
}

}  // namespace candela
