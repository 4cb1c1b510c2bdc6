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
  // The same in a session that others use, too: each visit makes its settings this one's. `over` is asked between
  // frames, and may end a visit: then the answer is false, and nothing of that frame is kept.
  Expected<bool> open_in(Session& session, const std::function<bool()>& over,
                         const std::function<void(size_t view, const FrameResult&, const Session&)>& seen);
  // A sample of that round (BenchRow::rounds). visited: another was there since; then a frame that is not timed comes
  // first, for images are made anew.
  Expected<bool> sample_in(Session& session, int round, bool visited, const std::function<bool()>& over);
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
  Expected<double> render_views();                                // all views once; milliseconds of a frame, their mean
  Expected<bool> take_sample(const std::function<bool()>& over);  // false: over, and nothing of it is kept
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
  Session* used_ = nullptr;  // session_, or that of others
  std::optional<Beauty> beauty_;
  double first_frame_ms_ = 0, last_frame_ms_ = 0;
  int runs_ = 0;  // wanted in all
  bool decided_ = false;
};

// What an earlier run measured of the same in the session's place, or of any setting there; null: nothing. Errors
// (input): it was of another content of the scene.
Expected<const BenchRow*> kept_row(const std::vector<BenchRow>& all, const BenchRow& wanted, const Session& session,
                                   bool any_setting = false);

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
