#include "bench/sweep_places.h"

#include <map>
#include <set>
#include <utility>

#include "base/check.h"
#include "base/text.h"
#include "bench/error_views.h"
#include "job/job_look.h"
#include "plan/plan_frame.h"
#include "plan/posed_scene.h"
#include "session/session.h"

namespace candela {
namespace {

std::string place_of(const Configuration& c) {
  return fmt::format("{}\n{}\n{}\n{}x{}\n{:a}\n{}\n{}\n{}\n{}\n{}", c.scene.label, c.seed, c.lights.value_or(-1),
                     c.job.width_px, c.job.height_px, c.time_s, c.scene.camera.camera, c.scene.sky.label,
                     c.scene.look.label, c.job.effects, c.job.transparency);
}

class KnobSweeps {
 public:
  KnobSweeps(const Suite& whole, SceneStore& store) : whole_(whole), store_(store) {}

  // Chooses the views, makes what plans the same work one row, and adds rows of all knobs to a place whose rows are
  // those of suite "whole".
  void add_to(SweepPlace& place) {
    const Configuration first = place.rows.front().configuration;
    place.views = {{first.job.camera, first.time_s}};
    if (!first.left_out.empty()) return;
    if (auto loaded = load(first); !loaded) {
      place.notes.push_back(fmt::format("{}: no knob was swept: {}", first.scene.label, loaded.error().text()));
      return;
    }
    if (auto chosen = choose_views(place, first); !chosen)
      place.notes.push_back(fmt::format("{}: one view: {}", first.scene.label, chosen.error().text()));
    works_.clear();
    for (SweepRow& row : std::exchange(place.rows, {})) add(place, std::move(row));
    for (const auto& [technique, work] : exact_) sweep_technique(place, technique, work);
    exact_.clear();
  }

 private:
  Expected<void> load(const Configuration& c) {
    const auto file = store_.file_of(c);
    if (!file) return std::unexpected(file.error());
    Job job = c.job;
    job.scene = *file;
    if (auto read = load_scene_of(job); !read) return read;
    const auto look = look_of(job, c.time_s);
    if (!look) return std::unexpected(look.error());
    std::vector<std::string> warnings;
    auto sky = JobSky::read(job, *look, scene_, warnings);
    if (!sky) return std::unexpected(sky.error());
    sky_ = std::move(*sky);
    return {};
  }

  Expected<void> load_scene_of(const Job& job) {
    const std::string files = job.scene + "\n" + job.look;  // whose paths and instances are the scene's
    if (files == files_) return {};
    auto scene = load_scene(job);
    if (!scene) return std::unexpected(scene.error());
    scene_ = std::move(*scene);
    auto layout = layout_geometry(scene_);
    if (!layout) return std::unexpected(layout.error());
    layout_ = std::move(*layout);
    files_ = files;
    return {};
  }

  Expected<void> choose_views(SweepPlace& place, const Configuration& c) {
    if (!whole_.views.empty()) {
      place.views = whole_.views;
      return {};
    }
    auto views = views_around(scene_, c.job, c.time_s, whole_.view_count);
    if (!views) return std::unexpected(views.error());
    place.views = std::move(*views);
    if (int(place.views.size()) < whole_.view_count)
      place.notes.push_back(fmt::format("{}: one view: the camera is orthographic and stands", c.scene.label));
    return {};
  }

  struct Work {
    Hash128 hash;
    std::set<std::string> passes;  // kept in any view
  };
  struct NotSwept {
    std::vector<std::string> same, unused;  // knobs, or their values
  };
  // Over all views; nullopt where one cannot be planned.
  Expected<Work> work_of_all(const SweepPlace& place, Job job) const {
    Work work;
    std::string all;
    for (const BenchView& view : place.views) {
      job.camera = view.camera;
      const auto planned = plan_frame(job, PlanContext{scene_, layout_, &sky_},
                                      {.linear = true, .display = whole_.output == "both"}, view.time_s);
      if (!planned) return std::unexpected(planned.error());
      const FrameWork of_view = work_of(*planned);
      all += of_view.hash.hex();
      work.passes.insert(of_view.passes.begin(), of_view.passes.end());
    }
    work.hash = hash128(all);
    return work;
  }

  // A row of its own, or one more name of the row that does the same work.
  void add(SweepPlace& place, SweepRow row) {
    row.configuration.views = place.views;
    const Job& job = row.configuration.job;
    const auto work = work_of_all(place, job);
    if (!work) {
      place.notes.push_back(fmt::format("{} with {}, quality {}: {}", row.configuration.scene.label, job.technique,
                                        job.quality, work.error().text()));
      place.rows.push_back(std::move(row));
      return;
    }
    const auto [at, made] = works_.try_emplace(work->hash, place.rows.size());
    if (row.suite == "whole" && job.quality == "exact") exact_.emplace_back(row.configuration, *work);
    if (made)
      place.rows.push_back(std::move(row));
    else
      place.rows[at->second].same_work.push_back(
          {row.suite, job.technique, job.quality, settings_text(job), job_json(job), row.knobs, {}});
  }

  void sweep_technique(SweepPlace& place, const Configuration& exact, const Work& work) {
    NotSwept not_swept;
    beside_.clear();
    for (const KnobRow& knob : knob_rows("exact"))
      if (knob.kind != "look" && knob.sweep.size() > 1) sweep_knob(place, exact, knob, work, not_swept);
    const auto note = [&](const std::vector<std::string>& names, std::string_view why) {
      if (!names.empty())
        place.notes.push_back(
            fmt::format("{} with {}: {}: {}", exact.scene.label, exact.job.technique, why, joined(names)));
    };
    note(not_swept.same, "the same work as at another value, and not measured again");
    note(not_swept.unused, "the frame has none of their passes");
  }

  // The knob points of the technique's exact end, whichever row does its work.
  std::vector<KnobPoint>& exact_points(SweepPlace& place, const std::string& technique) const {
    std::vector<KnobPoint>* points = nullptr;
    for (SweepRow& row : place.rows) {
      const Job& job = row.configuration.job;
      if (row.suite == "whole" && job.quality == "exact" && job.technique == technique) points = &row.knobs;
      for (SameWork& other : row.same_work)
        if (other.suite == "whole" && other.quality == "exact" && other.technique == technique) points = &other.knobs;
    }
    CHECK_MSG(points, technique);
    return *points;
  }

  // The exact end with what must stand beside a knob, which may put its passes into the frame.
  const Work& work_beside(const SweepPlace& place, const Configuration& exact, const KnobRow& knob,
                          const Work& exact_work) {
    if (knob.required.empty()) return exact_work;
    const auto [at, made] = beside_.try_emplace(joined(knob.required));
    if (!made) return at->second;
    Job job = exact.job;
    job.settings.clear();
    for (const std::string& setting : knob.required) job.settings.push_back(*parse_knob_setting(setting));
    auto work = work_of_all(place, job);
    return at->second = work ? std::move(*work) : exact_work;
  }

  void sweep_knob(SweepPlace& place, const Configuration& exact, const KnobRow& knob, const Work& exact_work,
                  NotSwept& not_swept) {
    const std::string name = knob.pass + "." + knob.knob;
    const auto holds_it = [&](const Work& work) {
      return std::ranges::any_of(knob.passes, [&](const std::string& pass) { return work.passes.contains(pass); });
    };
    if (!holds_it(work_beside(place, exact, knob, exact_work))) {
      not_swept.unused.push_back(name);
      return;
    }
    std::vector<Hash128> works = {exact_work.hash};
    std::vector<std::string> skipped;
    for (const std::string& value : knob.sweep) {
      if (value == knob.value_now && knob.required.empty()) continue;
      Configuration changed = exact;
      changed.job.settings = {{knob.pass, knob.knob, value}};
      for (const std::string& setting : knob.required) changed.job.settings.push_back(*parse_knob_setting(setting));
      const auto work = work_of_all(place, changed.job);
      if (work && std::find(works.begin(), works.end(), work->hash) != works.end()) {
        skipped.push_back(name + "=" + value);
        continue;
      }
      works.push_back(work ? work->hash : Hash128{});
      add(place, {"knob " + name, std::move(changed), {{name, value, knob.kind, knob.passes}}, {}});
    }
    if (works.size() == 1) skipped = {name};
    not_swept.same.insert(not_swept.same.end(), skipped.begin(), skipped.end());
    // Where the exact end is without the passes, the knob's own exact value beside what it requires is its last row.
    if (works.size() > 1 && holds_it(exact_work))
      exact_points(place, exact.job.technique).push_back({name, knob.value_now, knob.kind, knob.passes});
  }

  const Suite& whole_;
  SceneStore& store_;
  std::string files_;
  Scene scene_;
  GeometryLayout layout_;
  JobSky sky_;                                         // of the place at hand
  std::map<Hash128, size_t> works_;                    // of the place at hand: row that does it
  std::vector<std::pair<Configuration, Work>> exact_;  // the same: exact ends of techniques
  std::map<std::string, Work> beside_;                 // of the technique at hand, by the settings
};

// What a sweep asks of all places.
Suite whole_suite(const Suite& base) {
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
  return whole;
}

}  // namespace

Expected<std::vector<SweepPlace>> whole_places(const Suite& base) {
  const Suite whole = whole_suite(base);
  auto all = configurations(whole);
  if (!all) return std::unexpected(all.error());
  std::vector<SweepPlace> places;
  std::map<std::string, size_t> index;
  for (Configuration& c : *all) {
    const auto [at, made] = index.try_emplace(place_of(c), places.size());
    if (made) places.emplace_back();
    places[at->second].rows.push_back({"whole", std::move(c), {}, {}});
  }
  return places;
}

Expected<std::vector<SweepPlace>> sweep_places(const Suite& base, SceneStore& store) {
  auto places = whole_places(base);
  if (!places) return places;
  const Suite whole = whole_suite(base);
  KnobSweeps sweeps(whole, store);
  for (SweepPlace& place : *places) sweeps.add_to(place);
  return places;
}

}  // namespace candela
