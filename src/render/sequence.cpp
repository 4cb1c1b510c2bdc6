#include "render/sequence.h"

#include <atomic>
#include <deque>
#include <future>
#include <set>

#include "base/check.h"
#include "base/file_uses.h"
#include "base/files.h"
#include "base/log.h"
#include "image/prepare.h"
#include "job/picture_window.h"
#include "render/current_error.h"
#include "render/film_frames.h"
#include "render/outputs.h"
#include "render/video.h"

namespace candela {
namespace fs = std::filesystem;
namespace {

std::vector<fs::path> paths_of(const SequenceSettings& settings, int64_t frame) {
  std::vector<fs::path> paths;
  for (const FramePattern& pattern : settings.patterns) paths.emplace_back(pattern.name(frame));
  if (settings.kept) paths.emplace_back(settings.kept->name(frame));
  return paths;
}

// The file that a film has its frame from where it was rendered before.
fs::path film_frame(const SequenceSettings& settings, int64_t frame) {
  if (settings.kept) return settings.kept->name(frame);
  const auto png = std::ranges::find_if(settings.patterns, [](const FramePattern& pattern) {
    const auto format = output_format(pattern.name(0));
    return format && *format == OutputFormat::png;
  });
  CHECK(png != settings.patterns.end());
  return png->name(frame);
}

void add_sums(Timings& sums, Timings frame, bool keep_spans) {
  for (auto& [stage, milliseconds] : frame.cpu_ms) sums.add(stage, milliseconds);
  for (const gpu::PassTime& pass : frame.gpu_ms) {
    auto found =
        std::find_if(sums.gpu_ms.begin(), sums.gpu_ms.end(), [&](const auto& p) { return p.name == pass.name; });
    if (found == sums.gpu_ms.end())
      sums.gpu_ms.push_back(pass);
    else
      found->gpu_ms += pass.gpu_ms;
  }
  sums.frame_gpu_ms += frame.frame_gpu_ms;
  sums.lamp_maps += frame.lamp_maps, sums.lamp_maps_drawn += frame.lamp_maps_drawn;
  sums.lamp_maps_over += frame.lamp_maps_over;
  sums.uploaded_bytes += frame.uploaded_bytes, sums.heap_allocations += frame.heap_allocations;
  if (keep_spans) sums.spans.insert(sums.spans.end(), frame.spans.begin(), frame.spans.end());
}

// Files side by side need no threads of their own; few frames do, for then there are workers with nothing to do.
class FileThreads {
 public:
  explicit FileThreads(bool own) : before_(set_file_threads(own)) {}
  ~FileThreads() { set_file_threads(before_); }
  FileThreads(const FileThreads&) = delete;
  FileThreads& operator=(const FileThreads&) = delete;

 private:
  bool before_;
};

// Frames of the GPU.
class SessionFrames final : public FrameMaker {
 public:
  SessionFrames(Session& session, const Job& job, const SequenceSettings& settings)
      : session_(session), job_(job), in_flight_(settings.in_flight) {}
  size_t in_flight() const override { return size_t(in_flight_ > 0 ? in_flight_ : session_.in_flight()); }
  Expected<void> begin(double time_s) override {
    const auto ticket = session_.begin(time_s);
    if (!ticket) return std::unexpected(ticket.error());
    begun_.push_back(*ticket);
    return {};
  }
  Expected<std::optional<FinishedFrame>> finish(int64_t number) override {
    const FrameTicket ticket = begun_.front();
    begun_.pop_front();
    auto frame = session_.finish(ticket);
    if (!frame) return std::unexpected(frame.error());
    return FinishedFrame{.frame = std::move(*frame), .number = number, .traced = nullptr};
  }
  std::string identity(double time_s, int64_t number, FrameRate rate) const override {
    return file_identity(job_, session_, time_s, number, rate);
  }
  // Beside the read-back in 16 bytes a pixel of a colour stand the planes of floats, 16, those of halves, 8, and the
  // file, at most 8; of other formats it is no more.
  uint64_t bytes_in_hand(const FinishedFrame& finished) const override {
    uint64_t bytes = 0;
    for (const auto& [resource, readback] : finished.frame.readbacks) bytes += readback->bytes().size();
    return 4 * bytes;
  }
  Expected<PreparedOutputs> prepare(FinishedFrame& finished, FrameRate rate, const std::vector<fs::path>& paths,
                                    bool display_wanted) const override {
    return prepare_outputs(finished.frame, job_, session_, finished.number, rate, paths, display_wanted);
  }

 private:
  Session& session_;
  const Job& job_;
  int in_flight_;
  std::deque<FrameTicket> begun_;  // in order
};

class Run {
 public:
  Run(FrameMaker& maker, const Job& job, const SequenceSettings& settings)
      : maker_(maker), job_(job), settings_(settings), limits_(encoder_limits(settings.encoders)) {}

  Expected<SequenceResult> all() {
    if (!settings_.film.path.empty()) {
      const PixelRect data = picture_window(job_).data;
      auto video = VideoWriter::open(settings_.film, data.width, data.height, settings_.rate);
      if (!video) return std::unexpected(video.error());
      video_ = std::move(*video);
      was_there_.resize(settings_.frames.size());
    }
    if (settings_.kept)
      if (auto ready = prepare_output(settings_.kept->name(settings_.frames[0])); !ready)
        return std::unexpected(ready.error());
    const auto made = make_all();
    if (made && !result_.stopped)
      remove_kept();
    else
      say_what_is_kept();
    if (!made) return std::unexpected(made.error());
    return std::move(result_);
  }

 private:
  Expected<void> make_all() {
    if (auto rendered = render_all(); !rendered) return rendered;
    if (!video_ || result_.stopped) return {};
    if (auto added = add_frames_that_were_there(); !added) return added;
    return video_->finish();
  }

  void remove_kept() const {
    if (settings_.kept) remove_kept_frames(settings_.film.path);
  }

  void say_what_is_kept() const {
    if (!settings_.kept) return;
    const fs::path folder = fs::path(settings_.kept->name(0)).parent_path();
    std::error_code failed;
    if (fs::remove(folder, failed); fs::exists(folder, failed))  // an empty one goes
      log::info(
          "{0} holds the frames made so far; the same command with --resume goes on from them, and candela film {0} "
          "-o part{1} makes a film of them",
          folder.string(), settings_.film.path.extension().string());
  }

  Expected<void> render_all() {
    const FileThreads threads(limits_.workers == 1 || settings_.frames.size() < limits_.workers);
    EncoderPool encoder(limits_, [this](FinishedFrame& frame, size_t worker) { return encode(frame, worker); });
    log::debug("{} encoders; at most {} frames and {} MiB in memory", limits_.workers, limits_.frames,
               limits_.bytes >> 20);
    start_us_ = process_clock_us();
    const Expected<void> rendered = begin_and_finish(encoder);
    drop_begun();
    // Frames in hand are still written, and an encoder's error came first.
    if (auto finished = finish(encoder); !finished) return finished;
    result_.most_frames = encoder.most_frames();
    return rendered;
  }

  static Expected<void> finish(EncoderPool& encoder) {
    try {
      return encoder.finish();
    } catch (...) {
      return std::unexpected(in_frame(encoder.failed_frame().value_or(0), current_error()));
    }
  }

  // Frame N + 1 is begun before N is finished, as far as the session has room for both.
  Expected<void> begin_and_finish(EncoderPool& encoder) {
    const size_t room = maker_.in_flight() - 1;
    for (size_t i = 0; i < settings_.frames.size(); ++i) {
      const int64_t number = settings_.frames[i];
      if (settings_.stop && *settings_.stop != 0) {
        result_.stopped = true;
        break;
      }
      if (settings_.claim && !settings_.claim(i)) continue;
      if (settings_.resume && (settings_.claim ? holds_its_frame(number) : is_done(i))) {
        ++result_.skipped;
        if (video_) was_there_[i] = 1;
        if (settings_.finished) settings_.finished(i, false);
        report(number);
        continue;
      }
      const auto begun = maker_.begin(settings_.rate.seconds(number));
      if (begun) begun_.push_back(number);
      // Before an error of this frame, those of the frames before it: the first frame that fails is the one named.
      const auto going = finish_down_to(begun ? room : 0, encoder);
      if (!going) return std::unexpected(going.error());
      if (!begun) return std::unexpected(in_frame(number, begun.error()));
      if (!*going) return {};
    }
    if (const auto going = finish_down_to(0, encoder); !going) return std::unexpected(going.error());
    return {};
  }

  // False: the run ends, because the encoder has failed or a frame was given up.
  Expected<bool> finish_down_to(size_t left, EncoderPool& encoder) {
    while (begun_.size() > left) {
      const int64_t number = begun_.front();
      begun_.pop_front();
      auto finished = maker_.finish(number);
      if (!finished) return std::unexpected(in_frame(number, finished.error()));
      if (!*finished) {
        result_.stopped = true;
        return false;
      }
      FrameResult* frame = &(*finished)->frame;
      if (settings_.rendered)
        if (auto accepted = settings_.rendered(number, *frame); !accepted) return std::unexpected(accepted.error());
      const Hash128 hash = frame->plan_hash;
      if (std::find(result_.plan_hashes.begin(), result_.plan_hashes.end(), hash) == result_.plan_hashes.end())
        result_.plan_hashes.push_back(hash);
      if (frame->plan && frame->plan != last_plan_) last_plan_ = frame->plan, result_.plan = *last_plan_;
      const uint64_t bytes = maker_.bytes_in_hand(**finished);
      if (!encoder.push(std::move(**finished), bytes)) return false;
      ++result_.rendered;
      report(number);
    }
    return true;
  }

  // After an error the frames behind it are not written, but the device must be done with them.
  void drop_begun() {
    for (const int64_t number : begun_)
      if (const auto dropped = maker_.finish(number); !dropped)
        log::debug("frame {}: {}", number, dropped.error().text());
    begun_.clear();
  }

  static Error in_frame(int64_t number, const Error& error) {
    return {error.kind, fmt::format("frame {}: {}", number, error.message), error.place};
  }

  // Looks at the files of as many frames at once as there are encoders: to see that one is whole it is decoded.
  bool is_done(size_t i) {
    if (i < done_.size()) return done_[i] != 0;
    const size_t first = done_.size(), last = std::min(settings_.frames.size(), i + limits_.workers);
    done_.resize(last);
    std::atomic<size_t> next = first;
    const auto look = [&] {
      for (size_t at = next++; at < last; at = next++) done_[at] = holds_its_frame(settings_.frames[at]);
    };
    std::vector<std::future<void>> others;
    while (others.size() + 1 < last - first) others.push_back(std::async(std::launch::async, look));
    look();
    for (std::future<void>& other : others) other.get();
    return done_[i] != 0;
  }

  bool holds_its_frame(int64_t number) const {
    const std::vector<fs::path> paths = paths_of(settings_, number);
    std::error_code failed;
    if (!std::all_of(paths.begin(), paths.end(), [&](const fs::path& path) { return fs::exists(path, failed); }))
      return false;
    const std::string identity = maker_.identity(settings_.rate.seconds(number), number, settings_.rate);
    return std::all_of(paths.begin(), paths.end(), [&](const fs::path& path) { return holds_frame(path, identity); });
  }

  void report(int64_t newest) const {
    if (!settings_.progress) return;
    SequenceProgress progress{
        .done = result_.rendered + result_.skipped, .skipped = result_.skipped, .total = settings_.frames.size()};
    progress.frame = newest;
    const double passed_s = (process_clock_us() - start_us_) * 1e-6;
    if (result_.rendered > 0 && passed_s > 0) {
      progress.frames_per_s = double(result_.rendered) / passed_s;
      progress.left_s = double(progress.total - progress.done) / progress.frames_per_s;
    }
    settings_.progress(progress);
  }

  Expected<EncoderPool::Complete> encode(FinishedFrame& finished, size_t worker) {
    FrameResult& frame = finished.frame;
    const int64_t number = finished.number;
    const size_t said = frame.warnings.size();
    auto prepared = maker_.prepare(finished, settings_.rate, paths_of(settings_, number), video_ != nullptr);
    if (!prepared) return std::unexpected(in_frame(number, prepared.error()));
    if (!video_) prepared->display = {};
    if (worker > 0)
      for (Timings::Span& span : frame.timings.spans)
        if (span.lane == "encode") span.lane = fmt::format("encode {}", worker + 1);
    std::vector<std::string> warnings(frame.warnings.begin() + ptrdiff_t(said), frame.warnings.end());
    return [this, number, prepared = std::move(*prepared), warnings = std::move(warnings),
            timings = std::move(frame.timings)]() mutable { return complete(number, prepared, warnings, timings); };
  }

  // In the order of frames, one at a time.
  Expected<void> complete(int64_t number, PreparedOutputs& prepared, const std::vector<std::string>& warnings,
                          Timings& timings) {
    for (PreparedFile& file : prepared.files)
      if (auto placed = file.put_in_place(); !placed) return std::unexpected(in_frame(number, placed.error()));
    for (const std::string& warning : warnings) log::warning("frame {}: {}", number, warning);
    if (settings_.finished) settings_.finished(place_of(number), true);
    if (video_) {
      if (auto added = add_frames_that_were_there(); !added) return added;
      if (auto added = video_->add(prepared.display); !added) return added;
      ++video_next_;
    }
    add_sums(result_.timings, std::move(timings), settings_.keep_spans);  // read again after the threads have ended
    return {};
  }

  // Those that come next in the film.
  Expected<void> add_frames_that_were_there() {
    for (; video_next_ < was_there_.size() && was_there_[video_next_] != 0; ++video_next_) {
      const int64_t number = settings_.frames[video_next_];
      const PixelRect data = picture_window(job_).data;
      const auto image = read_film_frame(film_frame(settings_, number), data.width, data.height);
      if (!image) return std::unexpected(in_frame(number, image.error()));
      if (auto added = video_->add(*image); !added) return added;
    }
    return {};
  }

  size_t place_of(int64_t number) const { return settings_.frames.place_of(number).value(); }

  FrameMaker& maker_;
  const Job& job_;
  const SequenceSettings& settings_;
  SequenceResult result_;
  std::unique_ptr<VideoWriter> video_;
  // By index of the frame: the film has it from its file. Those before a frame are set before it is pushed, so that
  // the thread that completes it reads what is no longer written.
  std::vector<uint8_t> was_there_;
  size_t video_next_ = 0;  // index of the film's next frame
  std::shared_ptr<const FramePlan> last_plan_;
  std::deque<int64_t> begun_;  // in order
  EncoderLimits limits_;
  std::vector<uint8_t> done_;  // by index of the frame: its files were there. As far as looked
  double start_us_ = 0;
};

}  // namespace

Expected<SequenceResult> run_sequence(FrameMaker& maker, const Job& job, const SequenceSettings& settings) {
  remove_stale_temporaries(folders_of(settings), [&](const std::function<bool(const fs::path&)>& is_target) {
    for (const int64_t frame : settings.frames)
      for (const fs::path& path : paths_of(settings, frame))
        if (is_target(path)) return;
  });
  return Run(maker, job, settings).all();
}

Expected<SequenceResult> run_sequence(Session& session, const Job& job, const SequenceSettings& settings) {
  SessionFrames frames(session, job, settings);
  return run_sequence(frames, job, settings);
}

}  // namespace candela
