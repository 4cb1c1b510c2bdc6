#pragma once
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/error.h"
#include "gpu/frame_runner.h"
#include "graph/plan.h"
#include "job/job.h"
#include "job/picture_window.h"
#include "job/wanted_outputs.h"
#include "plan/frame_dumps.h"
#include "scene/survey.h"
#include "scene/view.h"

namespace candela {

struct FrameRays;
struct PlannedFrame;

// CPU milliseconds of one frame or of the start, by stage name: load, decode, upload, those of planning (animate,
// light_grid, sun_shadows, fog, local_shadows, trees, plan), compile (beside decode, upload and allocate), allocate,
// warm_up (when timed), record, wait, read_back, encode. GPU milliseconds by pass when timed.
struct Timings {
  std::vector<std::pair<std::string, double>> cpu_ms;
  std::vector<gpu::PassTime> gpu_ms;
  double frame_gpu_ms = 0;
  // Numbers of shadow maps of point and spot lights: those that the frame reads; of these those that it draws (the
  // others are kept from earlier frames); and those in which moving objects are drawn over a copy of the rest.
  uint64_t lamp_maps = 0, lamp_maps_drawn = 0, lamp_maps_over = 0;
  // By the thread that plans the frame, from when everything is posed until the device has the frame
  // (base/allocations.h). 0 in a film as long as its plan stays.
  uint64_t heap_allocations = 0;
  uint64_t uploaded_bytes = 0;  // sent to the device; a frame sends only what has changed
  // Spans for the Chrome trace: name, start and length in microseconds since the process began, lane ("cpu",
  // "compile", "encode", "gpu").
  struct Span {
    std::string name, lane;
    double start_us, length_us;
  };
  std::vector<Span> spans;
  // When asked for: the frame as a whole on the device, with passes side by side on both queues and with one queue.
  // Medians of as many interleaved runs.
  struct Overlap {
    int queues = 1;  // of the device
    int batches = 1, runs = 0;
    double all_queues_ms = 0, one_queue_ms = 0;
  };
  std::optional<Overlap> overlap;
  void add(std::string stage, double milliseconds);
  double total(std::string_view stage) const;
};
double process_clock_us();  // microseconds since the process began

// A rendered frame before encoding. The pixel data is in mapped device memory, kept alive by the shared pointers.
struct FrameResult {
  int width_px = 0, height_px = 0;  // of the output
  PictureWindow window;             // where the output lies in the picture
  double time_s = 0;
  View view;
  bool sees_items = false;  // the bounds of an item that the host posed are in view
  FrameRequest request;
  std::vector<FrameOutput> outputs;                         // what each readback holds
  std::map<int, std::shared_ptr<gpu::Readback>> readbacks;  // by FrameOutput::resource
  std::vector<FrameDump> dumps;                             // likewise
  std::vector<shared::PackCounts> counts;                   // by FrameOutput::counts
  double pre_exposure = 1;                                  // linear outputs are divided by it when encoded
  Hash128 plan_hash;
  std::shared_ptr<const FramePlan> plan;  // includes what was left out; frames share it
  std::shared_ptr<const FrameRays> rays;  // the trees that its rays were traced in; null: no rays
  Timings timings;
  std::vector<gpu::PassHash> hashes;  // when asked for
  std::vector<std::string> notes;
  std::vector<std::string> warnings;  // textures that could not be decoded, by the first frame that needs them
};

// What knobs decide about a frame: its passes with their pipelines and sizes, constants, lights and light boxes. Frames
// of equal hash do the same work.
struct FrameWork {
  Hash128 hash;
  std::set<std::string> passes;  // kept ones, by name
};
FrameWork work_of(const PlannedFrame& planned);

// A frame that has begun and is not finished yet.
using FrameTicket = gpu::FrameTicket;

// A device with a scene on it. Opening loads and uploads what does not change with time; frames are then independent.
class Session {
 public:
  static Expected<std::unique_ptr<Session>> open(const Job& job, const WantedOutputs& wanted,
                                                 const RunSettings& settings);
  virtual ~Session() = default;
  // Plans a frame and hands it to the device. GpuError becomes an Error here.
  virtual Expected<FrameTicket> begin(double time_s, bool hash_outputs = false) = 0;
  // Waits for it; each ticket once. The result is the same whatever was begun in between.
  virtual Expected<FrameResult> finish(FrameTicket ticket) = 0;
  Expected<FrameResult> render(double time_s, bool hash_outputs = false);
  virtual int in_flight() const = 0;  // how many frames to have begun at once on this device
  // Frames begun from now on use this camera.
  virtual void set_camera(const CameraRequest& camera) = 0;
  // Frames begun from now on are made with the job's technique, quality, samples, settings and size, as a session of
  // its own would make them; nothing else of the job counts. Errors: those of check_job() and of what the device cannot
  // do.
  virtual Expected<void> set_settings(const Job& job) = 0;
  // For `watch`, while no frame is in flight: reads look, sky and files of paths again. False: a new session is needed,
  // because other nodes move or textures were added. After false and after an error nothing has changed.
  virtual Expected<bool> reread_look() = 0;
  // Also for `watch`: frames begun from now on use the shader folder's present contents.
  virtual void reread_shaders() = 0;
  // Reuses the trees of an earlier session where the geometry is the same.
  virtual void take_trees(const Session& earlier) = 0;
  // What a frame at that time would do: planned, not rendered.
  virtual Expected<FrameWork> work(double time_s) const = 0;
  virtual const Scene& scene() const = 0;
  virtual const gpu::Device& device() const = 0;
  virtual const Timings& opening() const = 0;                  // load, decode, upload
  virtual Hash128 scene_content() const = 0;                   // of all files read
  virtual std::shared_ptr<const FrameRays> trees() const = 0;  // of the last frame that had some
};

}  // namespace candela
