#pragma once
#include <functional>
#include <memory>

#include "bench/picture.h"
#include "bench/row.h"
#include "bench/scene_store.h"
#include "bench/suite.h"

namespace candela {

inline constexpr int thumbnail_px = 320;

// One configuration while it is measured: its session, where memory allows to keep it, and the row that it fills.
class Measured {
 public:
  Measured(const Configuration& configuration, const Suite& suite, const RunSettings& settings);

  BenchRow row;

  // Loads, renders until warm, and fills what of the row is no sample.
  // `seen` gets each view's first frame, whose picture is every such frame's.
  Expected<void> open(const std::string& scene_file,
                      const std::function<void(const FrameResult&, const Session&)>& seen = {});
  void close();
  Expected<void> sample(const std::string& scene_file);  // opens when closed
  void fail_with(const Error& error);
  void finish();

  bool can_sample() const { return row.error.empty() && row.left_out.empty(); }
  bool wants_sample() const;
  bool lacks_runs() const;  // fewer than the least number
  // Whether this session may stay open beside so many others, which hold so many bytes of the device.
  bool fits_beside(int others, uint64_t others_bytes) const;
  uint64_t device_bytes() const;
  double first_frame_ms() const { return first_frame_ms_; }
  const std::optional<Beauty>& beauty() const { return beauty_; }  // of the first frame
  void forget_beauty() { beauty_.reset(); }

 private:
  Expected<FrameResult> render(size_t view);
  // All views once. ms is of a frame, their mean; `each` gets the frames.
  Expected<double> render_views(const std::function<void(const FrameResult&)>& each = {});
  Expected<void> open_session(const std::string& scene_file);
  Expected<void> warm_up();
  void describe(const FrameResult& frame);
  void decide_runs();

  Configuration configuration_;
  std::vector<BenchView> views_;
  SamplingRules rules_;
  RunSettings settings_;
  WantedOutputs wanted_;
  std::unique_ptr<Session> session_;
  std::optional<Beauty> beauty_;
  double first_frame_ms_ = 0, last_frame_ms_ = 0;
  int runs_ = 0;  // wanted in all
  bool decided_ = false;
};

// A single untimed frame with what can be seen in it.
struct SeenFrame {
  std::optional<Beauty> beauty;
  std::optional<LightLists> lists;
  std::vector<std::byte> thumbnail, heatmap;  // PNG, when thumbnail_px > 0 and the outputs are there
};
Expected<SeenFrame> render_once(const Configuration& configuration, SceneStore& store, const RunSettings& settings,
                                const WantedOutputs& wanted, int most_px);

// Of the machine, for rows: the processor's model, without which rows of a CPU device cannot be compared.
std::string processor_name();

}  // namespace candela
