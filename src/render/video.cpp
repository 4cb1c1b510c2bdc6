#include "render/video.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <limits>

#include "base/check.h"
#include "base/files.h"
#include "base/input.h"
#include "base/log.h"
#include "base/text.h"
#include "render/frame_names.h"

extern char** environ;

namespace candela {
namespace fs = std::filesystem;
namespace {

bool on_path(const std::string& program) {
  const char* path = std::getenv("PATH");
  for (const std::string& folder : split(path ? path : "", ':'))
    if (access((fs::path(folder) / program).c_str(), X_OK) == 0) return true;
  return false;
}

// The film has this number in ffmpeg, which opens it by that: its name in the folder may be somebody else's by then.
constexpr int film_file = 3;

std::vector<std::string> arguments(const FilmCodec& codec, const FilmFile& film, int width_px, int height_px,
                                   FrameRate rate, int bits, bool alpha) {
  const char* pixels = bits == 8 ? (alpha ? "rgba" : "rgb24") : (alpha ? "rgba64le" : "rgb48le");
  std::vector<std::string> a = {"ffmpeg", "-hide_banner", "-nostdin", "-loglevel", "error", "-xerror", "-y"};
  a.insert(a.end(), {"-f", "rawvideo", "-pix_fmt", pixels, "-s", fmt::format("{}x{}", width_px, height_px), "-r",
                     rate.text(), "-i", "pipe:0"});
  if (!film.audio.empty()) {
    // A relative name that begins with a dash would be an option to ffmpeg.
    a.insert(a.end(), {"-i", fs::absolute(film.audio).string(), "-map", "0:v", "-map", "1:a", "-c:a",
                       std::string(codec.audio), "-shortest"});
    if (!codec.audio.starts_with("pcm")) a.insert(a.end(), {"-b:a", "192k"});
  }
  const std::vector<std::string> encoder = encoder_arguments(codec, film, bits, alpha);
  a.insert(a.end(), encoder.begin(), encoder.end());
  a.push_back(fmt::format("/proc/self/fd/{}", film_file));
  return a;
}

// ffmpeg gets a process group of its own: an interrupt at the terminal is ours to handle.
int spawn_reading(int pipe_end, int film, std::vector<std::string> arguments, int& error) {
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, pipe_end, STDIN_FILENO);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(&files, film, film_file);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  pid_t process = -1;
  error = posix_spawnp(&process, pointers[0], &files, &attributes, pointers.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&attributes);
  return error == 0 ? process : -1;
}

template <class Sample>
Sample sample_at(const DisplayImage& image, size_t i) {
  Sample value;
  std::memcpy(&value, image.pixels.data() + i * sizeof(Sample), sizeof(Sample));
  return value;
}

// Alpha that the stream has not is black behind the picture.
template <class From, class To>
std::vector<std::byte> converted(const DisplayImage& image, bool alpha) {
  constexpr uint64_t from_full = std::numeric_limits<From>::max(), to_full = std::numeric_limits<To>::max();
  const size_t from = size_t(image.channels), to = alpha ? 4 : 3;
  const size_t count = size_t(image.width) * size_t(image.height);
  std::vector<std::byte> pixels(count * to * sizeof(To));
  for (size_t i = 0; i < count; ++i) {
    const uint64_t a = from == 4 ? sample_at<From>(image, i * from + 3) : from_full;
    for (size_t c = 0; c < to; ++c) {
      const bool over_black = !alpha && from == 4;
      const uint64_t value = c == 3 ? a : sample_at<From>(image, i * from + c);
      const uint64_t full = over_black ? from_full * from_full : from_full;
      const To out = To(((over_black ? value * a : value) * to_full + full / 2) / full);
      std::memcpy(pixels.data() + (i * to + c) * sizeof(To), &out, sizeof(To));
    }
  }
  return pixels;
}

// As the stream has it.
std::vector<std::byte> stream_pixels(const DisplayImage& image, int bits, bool alpha) {
  if (image.bits == bits && image.channels == (alpha ? 4 : 3)) return image.pixels;
  if (image.bits == 8)
    return bits == 8 ? converted<uint8_t, uint8_t>(image, alpha) : converted<uint8_t, uint16_t>(image, alpha);
  return bits == 8 ? converted<uint16_t, uint8_t>(image, alpha) : converted<uint16_t, uint16_t>(image, alpha);
}

template <class Sample>
bool has_holes(const DisplayImage& image) {
  for (size_t i = 0; i < size_t(image.width) * size_t(image.height); ++i)
    if (sample_at<Sample>(image, i * 4 + 3) != std::numeric_limits<Sample>::max()) return true;
  return false;
}

bool shows_through(const DisplayImage& image) {
  return image.channels == 4 && (image.bits == 8 ? has_holes<uint8_t>(image) : has_holes<uint16_t>(image));
}

}  // namespace

Expected<void> check_video(const FilmFile& film) {
  if (const auto codec = film_codec(film); !codec) return std::unexpected(codec.error());
  if (!on_path("ffmpeg"))
    return fail(ErrorKind::usage, "--video", "needs the program ffmpeg, which is not on PATH (apt install ffmpeg)");
  if (!film.audio.empty())
    if (auto good = check_regular_file(film.audio); !good) return good;
  return prepare_output(film.path);
}

Expected<std::unique_ptr<VideoWriter>> VideoWriter::open(const FilmFile& film, int width_px, int height_px,
                                                         FrameRate rate) {
  if (auto good = check_video(film); !good) return std::unexpected(good.error());
  if (auto good = check_film_size(film, width_px, height_px); !good) return std::unexpected(good.error());
  auto file = PreparedFile::create(film.path);
  if (!file) return std::unexpected(file.error());
  return std::unique_ptr<VideoWriter>(
      new VideoWriter(std::move(*file), film, **film_codec(film), width_px, height_px, rate));
}

Expected<void> VideoWriter::start(const DisplayImage& first) {
  bits_ = codec_.deep ? first.bits : 8;
  alpha_ = codec_.alpha && first.channels == 4;
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0)
    return fail(ErrorKind::output, film_.path.string(), "cannot make a pipe: {}", std::strerror(errno));
  int error = 0;
  process_ = spawn_reading(ends[0], file_.file(), arguments(codec_, film_, width_px_, height_px_, rate_, bits_, alpha_),
                           error);
  close(ends[0]);
  pipe_ = ends[1];
  if (process_ >= 0) return {};
  return fail(ErrorKind::output, film_.path.string(), "cannot start ffmpeg: {}", std::strerror(error));
}

void VideoWriter::say_that_alpha_is_lost(const DisplayImage& image) {
  if (alpha_ || said_ || !shows_through(image)) return;
  said_ = true;
  if (codec_.alpha)
    log::warning("the film's first frame has no alpha, so the film has none; others stand on black");
  else
    log::warning(
        "{} has no alpha: the transparent background is black in the film (--video-codec prores4444, ffv1, png or vp9 "
        "keep alpha, --background COLOR fills it)",
        codec_.title);
}

VideoWriter::~VideoWriter() {
  if (process_ > 0) {
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }
  if (pipe_ >= 0) close(pipe_);
}

Expected<void> VideoWriter::wait_for_exit() {
  close(pipe_);
  pipe_ = -1;
  int status = 0;
  while (waitpid(process_, &status, 0) < 0 && errno == EINTR) {
  }
  process_ = -1;
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return {};
  return fail(ErrorKind::output, film_.path.string(), "ffmpeg ended with {} {} (its own message is above)",
              WIFEXITED(status) ? "status" : "signal", WIFEXITED(status) ? WEXITSTATUS(status) : WTERMSIG(status));
}

Expected<void> VideoWriter::add(const DisplayImage& image) {
  CHECK(image.width == width_px_ && image.height == height_px_);
  if (process_ < 0)
    if (auto started = start(image); !started) return started;
  say_that_alpha_is_lost(image);
  const std::vector<std::byte> pixels = stream_pixels(image, bits_, alpha_);
  // When ffmpeg has ended, writing must be an error here and not a signal that ends the program.
  sigset_t pipe_signal, before;
  sigemptyset(&pipe_signal);
  sigaddset(&pipe_signal, SIGPIPE);
  pthread_sigmask(SIG_BLOCK, &pipe_signal, &before);
  int error = 0;
  for (size_t done = 0; done < pixels.size() && error == 0;) {
    const ssize_t n = write(pipe_, pixels.data() + done, pixels.size() - done);
    if (n >= 0)
      done += size_t(n);
    else if (errno != EINTR)
      error = errno;
  }
  if (error == EPIPE) {
    const timespec now{};
    sigtimedwait(&pipe_signal, nullptr, &now);
  }
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  if (error == 0) return {};
  if (auto ended = wait_for_exit(); !ended) return ended;
  return fail(ErrorKind::output, film_.path.string(), "ffmpeg stopped reading: {}", std::strerror(error));
}

Expected<void> VideoWriter::finish() {
  CHECK(process_ >= 0);
  if (auto ended = wait_for_exit(); !ended) return ended;
  if (auto flushed = file_.flush(); !flushed) return flushed;
  return file_.put_in_place();
}

}  // namespace candela
