#pragma once
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "image/image.h"
#include "job/job.h"
#include "plan/posed_scene.h"
#include "reference/film.h"
#include "sky/job_sky.h"

namespace candela {

// The technique of a job that the reference traces as a film: its layers and view are the reference's.
inline constexpr const char* traced_technique = "reference";
// As check_job() for both kinds.
Expected<void> check_traced_job(const Job& job);

// What all moments of a job have in common.
struct ReferenceScene {
  Scene scene;
  std::optional<LookFile> look;
  std::optional<JobSky> sky;
  Hash128 content;  // of all files read
  std::vector<std::string> warnings;
};
// path: light goes through transmissive surfaces, and the scene is loaded with what that needs.
Expected<std::shared_ptr<const ReferenceScene>> load_reference(const Job& job, reference::Mode mode);

// One moment of a scene, ready for the reference: the same scene, camera, lights and sky that plan_frame() gives the
// GPU, but for the floor at which the GPU ends lights without range. Holds everything that the world points into, so it
// does not move.
struct ReferenceFrame {
  std::shared_ptr<const ReferenceScene> loaded;
  const Scene& scene() const { return loaded->scene; }
  Pose pose;
  View view;
  FrameData data;
  double time_s = 0;
  Look look;  // of that time
  const Hash128& scene_content() const { return loaded->content; }
  std::vector<std::string> notes, warnings;
  std::unique_ptr<reference::World> world;
  std::optional<PosedScene> before;  // the time before, for the layer motion
};
// Poses the time before where the layers ask for motion. Errors: those of pose_before().
Expected<void> add_time_before(ReferenceFrame& frame, const Job& job, const std::vector<std::string>& layers);
Expected<std::unique_ptr<ReferenceFrame>> pose_reference(std::shared_ptr<const ReferenceScene> loaded, const Job& job,
                                                         double time_s, const AccelOptions& accel,
                                                         reference::Mode mode);
// Both at once.
Expected<std::unique_ptr<ReferenceFrame>> open_reference(const Job& job, double time_s, const AccelOptions& accel,
                                                         reference::Mode mode = reference::Mode::direct);

// What `reference --set bvh.NAME=VALUE` reaches of how trees are built.
struct TreeKnob {
  std::string_view name, meaning;
  double lowest, highest;
  bool whole;
  double (*get)(const BvhOptions&);
  void (*set)(BvhOptions&, double);
};
std::span<const TreeKnob> tree_knobs();
Expected<void> set_tree_knob(const std::string& text, BvhOptions& options);  // "bvh.NAME=VALUE"

// What decides the reference's pixels beside the job, as JSON: mode, sampler, bvh and the rest. Stable order; one line.
std::string settings_json(const reference::TraceSettings& settings, const AccelOptions& accel);
std::string_view name_of(reference::Mode mode);
std::string_view name_of(reference::SamplerKind kind);
std::string_view name_of(reference::Ambient ambient);
std::string_view name_of(BvhBuilder builder);

// Of all that decides the sums of a film. How they are shown and stored, and their number where the sampler does not
// need it, is left out: those may change between a run and its resumption. with_terms: the film keeps terms.
Hash128 film_identity(const Job& job, const ReferenceFrame& frame, const reference::TraceSettings& settings,
                      const AccelOptions& accel, bool with_terms = false);

Expected<void> check_traced_layers(const std::vector<std::string>& layers);
Expected<void> check_traced_view(const std::string& view, const Job& job);
// Layers that the reference can write beside beauty.
std::vector<std::string> reference_layer_names();  // variance, fog, fog_transmittance, terms, surface layers, counts
// Of a layer of counts: heatmap_traversal, heatmap_leaves.
std::vector<float> reference_counts(const reference::Film& film, const ReferenceFrame& frame, const std::string& layer);

// The film as an image of linear radiance with layers and metadata, of the same form as linear_image() of a GPU's
// frame. sampler: of the film's samples.
FloatImage reference_image(const reference::Film& film, const ReferenceFrame& frame, const Job& job,
                           const std::string& settings, const std::vector<std::string>& layers,
                           std::optional<int64_t> frame_number, FrameRate rate,
                           const reference::SamplerSettings& sampler = {});

}  // namespace candela
