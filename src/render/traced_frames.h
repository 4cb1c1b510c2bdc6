#pragma once
#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "render/reference_frame.h"
#include "render/sequence.h"

namespace candela {

// How the reference makes a frame, beside the job.
struct TraceRequest {
  reference::TraceSettings settings;
  AccelOptions accel;
  reference::Stop stop;
};

// Errors (usage): a part of a picture whose display output meters all of it.
Expected<void> check_metering(const Job& job, const Look& look, bool display);

// Error (nonfinite): pixels that files cannot hold, unless the job allows them.
Expected<void> check_finite(const reference::Film& film, const Job& job);
// What PNG and video show of a film: view is beauty or one of reference_layer_names(), whose
// parts the film keeps.
DisplayImage traced_display(const reference::Film& film, const ReferenceFrame& frame, const Job& job,
                            const std::string& view, const reference::SamplerSettings& sampler);
// What a film keeps for files with these layers and pictures of that view.
std::vector<std::string> kept_layers(std::vector<std::string> layers, const std::string& view);
// Film of the parts that the layers need, without samples, and whose it is.
struct BegunFilm {
  reference::Film film;
  Hash128 identity;
  reference::FilmParts parts;
};
BegunFilm begin_film(const Job& job, const ReferenceFrame& frame, const TraceRequest& request,
                     const std::vector<std::string>& layers);

// The moments that samples of a film are of: with a shutter the frames of the picture (plan/subframes.h), each with the
// same number of samples, one after another; else the frame alone. A point of the lens is each sample's own.
class TracedMoments {
 public:
  // Error (usage): a shutter and no number of samples, or fewer than frames.
  static Expected<TracedMoments> open(const ReferenceFrame& frame, const Job& job, const TraceRequest& request);
  reference::Moment at(uint64_t sample);
  const std::optional<Error>& error() const { return error_; }  // why a moment could not be posed

 private:
  const ReferenceFrame* frame_ = nullptr;
  Job job_;
  TraceRequest request_;
  std::vector<double> times_s_;  // empty: the frame's own
  std::unique_ptr<ReferenceFrame> posed_;
  size_t at_ = size_t(-1);  // into times_s_
  std::optional<reference::Integrator> integrator_;
  std::optional<Error> error_;
};

// The reference as the maker of a sequence: one frame at a time, each with all cores. A frame has the pixels of
// `candela reference` at its time.
class TracedFrames final : public FrameMaker {
 public:
  // wanted: which of the two pictures files hold.
  static Expected<std::unique_ptr<TracedFrames>> open(const Job& job, const TraceRequest& request, FrameRate rate,
                                                      const WantedOutputs& wanted);
  // Where it is no longer 0 the frame in hand is given up.
  void set_stop(const std::atomic<int>* stop) { stop_ = stop; }
  const Scene& scene() const { return loaded_->scene; }
  const Hash128& scene_content() const { return loaded_->content; }
  // What stands for a driver in identities and records: all that decides a pixel beside job and scene.
  std::string request_text() const;

  size_t in_flight() const override { return 1; }
  Expected<void> begin(double time_s) override;
  Expected<std::optional<FinishedFrame>> finish(int64_t number) override;
  std::string identity(double time_s, int64_t number, FrameRate rate) const override;
  uint64_t bytes_in_hand(const FinishedFrame& frame) const override;
  Expected<PreparedOutputs> prepare(FinishedFrame& frame, FrameRate rate,
                                    const std::vector<std::filesystem::path>& paths,
                                    bool display_wanted) const override;

 private:
  TracedFrames(const Job& job, const TraceRequest& request, FrameRate rate, const WantedOutputs& wanted,
               std::shared_ptr<const ReferenceScene> loaded)
      : job_(job), request_(request), rate_(rate), wanted_(wanted), loaded_(std::move(loaded)) {}

  Job job_;
  TraceRequest request_;
  FrameRate rate_;
  WantedOutputs wanted_;
  const std::atomic<int>* stop_ = nullptr;
  std::shared_ptr<const ReferenceScene> loaded_;
  double time_s_ = 0;  // of the frame that was begun
};

}  // namespace candela
