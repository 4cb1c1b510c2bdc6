#include "render/video.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>

#include "base/check.h"
#include "base/files.h"
#include "base/input.h"
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

std::string muxer_of(const fs::path& film) {
  const std::string ending = film.extension().string();
  return ending == ".mkv" ? "matroska" : ending.substr(1);
}

std::vector<std::string> arguments(const fs::path& film, const fs::path& audio, int width_px, int height_px,
                                   FrameRate rate) {
  // H.264 with 4:2:0 chroma wants even sides: odd ones grow by a black row or column. Rec.709 is said in the stream,
  // because players guess it from the height otherwise.
  std::vector<std::string> a = {"ffmpeg",
                                "-hide_banner",
                                "-nostdin",
                                "-loglevel",
                                "error",
                                "-xerror",
                                "-y",
                                "-f",
                                "rawvideo",
                                "-pix_fmt",
                                "rgb24",
                                "-s",
                                fmt::format("{}x{}", width_px, height_px),
                                "-r",
                                rate.text(),
                                "-i",
                                "pipe:0"};
  if (!audio.empty())
    a.insert(a.end(), {"-i", audio.string(), "-map", "0:v", "-map", "1:a", "-c:a", "aac", "-b:a", "192k", "-shortest"});
  a.insert(a.end(), {"-vf",
                     "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv",
                     "-c:v",
                     "libx264",
                     "-preset",
                     "medium",
                     "-crf",
                     "18",
                     "-pix_fmt",
                     "yuv420p",
                     "-colorspace",
                     "bt709",
                     "-color_primaries",
                     "bt709",
                     "-color_trc",
                     "iec61966-2-1",
                     "-movflags",
                     "+faststart",
                     "-map_metadata",
                     "-1",
                     "-fflags",
                     "+bitexact",
                     "-flags:v",
                     "+bitexact",
                     "-f",
                     muxer_of(film),
                     fmt::format("/proc/self/fd/{}", film_file)});
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

std::vector<std::byte> over_black(const DisplayImage& image) {
  CHECK(image.bits == 8);
  if (image.channels == 3) return image.pixels;
  std::vector<std::byte> rgb(image.pixels.size() / 4 * 3);
  for (size_t i = 0; i < rgb.size() / 3; ++i)
    for (size_t c = 0; c < 3; ++c)
      rgb[i * 3 + c] = std::byte((unsigned(image.pixels[i * 4 + c]) * unsigned(image.pixels[i * 4 + 3]) + 127) / 255);
  return rgb;
}

}  // namespace

Expected<void> check_video(const fs::path& path, const fs::path& audio) {
  const std::string ending = path.extension().string();
  if (ending != ".mp4" && ending != ".mov" && ending != ".mkv")
    return fail(ErrorKind::usage, "--video", "'{}' ends in none of .mp4, .mov and .mkv", path.string());
  if (!on_path("ffmpeg"))
    return fail(ErrorKind::usage, "--video", "needs the program ffmpeg, which is not on PATH (apt install ffmpeg)");
  if (!audio.empty())
    if (auto good = check_regular_file(audio); !good) return good;
  return prepare_output(path);
}

Expected<std::unique_ptr<VideoWriter>> VideoWriter::open(const fs::path& path, const fs::path& audio, int width_px,
                                                         int height_px, FrameRate rate) {
  if (auto good = check_video(path, audio); !good) return std::unexpected(good.error());
  auto film = PreparedFile::create(path);
  if (!film) return std::unexpected(film.error());
  std::unique_ptr<VideoWriter> writer(new VideoWriter(std::move(*film)));
  writer->path_ = path;
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0)
    return fail(ErrorKind::output, path.string(), "cannot make a pipe: {}", std::strerror(errno));
  int error = 0;
  // A relative name that begins with a dash would be an option to ffmpeg.
  const fs::path audio_name = audio.empty() ? audio : fs::absolute(audio);
  writer->process_ =
      spawn_reading(ends[0], writer->film_.file(), arguments(path, audio_name, width_px, height_px, rate), error);
  close(ends[0]);
  writer->pipe_ = ends[1];
  if (writer->process_ < 0)
    return fail(ErrorKind::output, path.string(), "cannot start ffmpeg: {}", std::strerror(error));
  return writer;
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
  return fail(ErrorKind::output, path_.string(), "ffmpeg ended with {} {} (its own message is above)",
              WIFEXITED(status) ? "status" : "signal", WIFEXITED(status) ? WEXITSTATUS(status) : WTERMSIG(status));
}

Expected<void> VideoWriter::add(const DisplayImage& image) {
  const std::vector<std::byte> rgb = over_black(image);
  // When ffmpeg has ended, writing must be an error here and not a signal that ends the program.
  sigset_t pipe_signal, before;
  sigemptyset(&pipe_signal);
  sigaddset(&pipe_signal, SIGPIPE);
  pthread_sigmask(SIG_BLOCK, &pipe_signal, &before);
  int error = 0;
  for (size_t done = 0; done < rgb.size() && error == 0;) {
    const ssize_t n = write(pipe_, rgb.data() + done, rgb.size() - done);
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
  return fail(ErrorKind::output, path_.string(), "ffmpeg stopped reading: {}", std::strerror(error));
}

Expected<void> VideoWriter::finish() {
  if (auto ended = wait_for_exit(); !ended) return ended;
  if (auto flushed = film_.flush(); !flushed) return flushed;
  return film_.put_in_place();
}

}  // namespace candela
