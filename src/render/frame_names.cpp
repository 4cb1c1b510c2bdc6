#include "render/frame_names.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>

#include "base/files.h"

namespace candela {
namespace fs = std::filesystem;

Expected<OutputFormat> output_format(const fs::path& path) {
  std::string ending = path.extension().string();
  for (char& c : ending) c = char(std::tolower(static_cast<unsigned char>(c)));
  if (ending == ".exr") return OutputFormat::exr;
  if (ending == ".png") return OutputFormat::png;
  return fail(ErrorKind::usage, "-o", "'{}' ends in neither .exr nor .png", path.string());
}

std::string FramePattern::name(int64_t frame) const {
  if (!numbered) return before;
  return before + fmt::format("{:0{}d}", frame, digits + (frame < 0 && digits > 0)) + after;
}

Expected<FramePattern> parse_pattern(const std::string& text) {
  FramePattern pattern;
  std::string* target = &pattern.before;
  const auto number = [&](int digits) {
    const bool first = !pattern.numbered;
    pattern.numbered = true;
    pattern.digits = digits;
    target = &pattern.after;
    return first;
  };
  const auto twice = [&] {
    return fail(ErrorKind::usage, "-o", "'{}' has more than one place for the frame number", text);
  };
  for (size_t i = 0; i < text.size();) {
    if (text[i] == '#') {
      size_t end = text.find_first_not_of('#', i);
      if (end == std::string::npos) end = text.size();
      if (!number(int(end - i))) return twice();
      i = end;
    } else if (text[i] == '%' && i + 1 < text.size() && text[i + 1] == '%') {
      *target += '%';
      i += 2;
    } else if (text[i] == '%') {
      int digits = 0;
      const char *begin = text.data() + i + 1, *end = text.data() + text.size();
      const auto read = std::from_chars(begin, end, digits);
      // %4d would fill with spaces in C; only %d and %0Nd are names that the field uses.
      const bool plain = read.ptr == begin;
      if (read.ptr == end || *read.ptr != 'd' || digits > 20 || (!plain && *begin != '0'))
        return fail(ErrorKind::usage, "-o",
                    "the % in '{}' is no frame number; write %04d or ####, and %% for a percent sign", text);
      if (!number(digits)) return twice();
      i = size_t(read.ptr + 1 - text.data());
    } else {
      *target += text[i++];
    }
  }
  return pattern;
}

Expected<void> prepare_output(const fs::path& path) {
  std::error_code failed;
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  fs::create_directories(folder, failed);
  if (failed)
    return fail(ErrorKind::output, path.string(), "cannot make the folder {}: {}", folder.string(), failed.message());
  struct stat there {};
  if (lstat(path.c_str(), &there) != 0 && errno != ENOENT)  // a name that is too long, say
    return fail(ErrorKind::output, path.string(), "cannot be written: {}", std::strerror(errno));
  if (fs::is_directory(path, failed)) return fail(ErrorKind::output, path.string(), "is a folder; name a file");
  // A file is really made: permission bits say nothing to root or about a read-only file system.
  remove_stale_temporaries(std::span(&path, 1));
  const fs::path probe = folder / temporary_beside(path).filename();
  const int file = open(probe.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (file < 0)
    return fail(ErrorKind::output, path.string(), "cannot write in {}: {}", folder.string(), std::strerror(errno));
  close(file);
  unlink(probe.c_str());
  return {};
}

Expected<Shard> parse_shard(const std::string& text) {
  Shard shard;
  const char* end = text.data() + text.size();
  const auto index = std::from_chars(text.data(), end, shard.index);
  if (index.ec == std::errc{} && index.ptr != end && *index.ptr == '/') {
    const auto count = std::from_chars(index.ptr + 1, end, shard.count);
    if (count.ec == std::errc{} && count.ptr == end && shard.index >= 1 && shard.index <= shard.count) return shard;
  }
  return fail(ErrorKind::usage, "--shard", "'{}' is not a shard; write I/N with I from 1 to N, for example 2/8", text);
}

std::vector<int64_t> shard_of(const std::vector<int64_t>& frames, Shard shard) {
  std::vector<int64_t> mine;
  for (size_t k = size_t(shard.index - 1); k < frames.size(); k += size_t(shard.count)) mine.push_back(frames[k]);
  return mine;
}

}  // namespace candela
