#include "render/frame_names.h"

#include <sys/stat.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <optional>
#include <string_view>
#include <utility>

#include "base/files.h"
#include "base/prepared_file.h"

namespace candela {
namespace fs = std::filesystem;

Expected<OutputFormat> output_format(const fs::path& path) {
  std::string ending = path.extension().string();
  for (char& c : ending) c = char(std::tolower(static_cast<unsigned char>(c)));
  if (ending == ".exr") return OutputFormat::exr;
  if (ending == ".png") return OutputFormat::png;
  if (ending == ".jpg" || ending == ".jpeg" || ending == ".webp")
    return fail(ErrorKind::usage, "-o",
                "'{}' ends in neither .exr nor .png; JPEG and WebP lose what pictures are compared by and are not "
                "written: convert a PNG, for example with oiiotool a.png -o a{}",
                path.string(), ending);
  return fail(ErrorKind::usage, "-o", "'{}' ends in neither .exr nor .png", path.string());
}

std::string FramePattern::name(int64_t frame, const std::string& camera) const {
  std::string name;
  for (const Piece& piece : pieces) {
    if (piece.kind == Piece::Kind::frame)
      name += fmt::format("{:0{}d}", frame, piece.digits + (frame < 0 && piece.digits > 0));
    else
      name += piece.kind == Piece::Kind::camera ? camera : piece.text;
  }
  return name;
}

std::string FramePattern::before_number() const {
  std::string text;
  for (const Piece& piece : pieces) {
    if (piece.kind == Piece::Kind::frame) break;
    text += piece.text;
  }
  return text;
}

std::string FramePattern::after_number() const {
  std::string text;
  bool behind = false;
  for (const Piece& piece : pieces) {
    if (behind) text += piece.text;
    behind |= piece.kind == Piece::Kind::frame;
  }
  return text;
}

std::optional<int64_t> FramePattern::frame_of(const fs::path& file) const {
  if (!numbered || by_camera) return {};
  // A sign that no name has stands for the number, so that both names are made plain in the same way.
  const std::string plain = fs::path(before_number() + '\x01' + after_number()).lexically_normal().string();
  const std::string name = file.lexically_normal().string();
  const size_t at = plain.find('\x01'), behind = plain.size() - at - 1;
  if (at == std::string::npos || name.size() <= at + behind || name.compare(0, at, plain, 0, at) != 0 ||
      name.compare(name.size() - behind, behind, plain, at + 1, behind) != 0)
    return {};
  int64_t frame = 0;
  const char *from = name.data() + at, *to = name.data() + name.size() - behind;
  if (const auto read = std::from_chars(from, to, frame); read.ec != std::errc{} || read.ptr != to) return {};
  return fs::path(this->name(frame)).lexically_normal() == name ? std::optional(frame) : std::nullopt;
}

bool may_share_names(const FramePattern& a, const FramePattern& b) {
  const auto plain = [](const FramePattern& p) {
    const std::string name = fs::path(p.before_number() + '\x01' + p.after_number()).lexically_normal().string();
    return std::pair(name.substr(0, name.find('\x01')), name.substr(name.find('\x01') + 1));
  };
  const auto [before_a, after_a] = plain(a);
  const auto [before_b, after_b] = plain(b);
  return (before_a.starts_with(before_b) || before_b.starts_with(before_a)) &&
         (after_a.ends_with(after_b) || after_b.ends_with(after_a));
}

namespace {

using Piece = FramePattern::Piece;

// A piece and the length of its text.
struct Read {
  Piece piece;
  size_t length = 0;
};

// Digits at the beginning of a text, at most 20; absent where they say too much. `zero`: they begin with 0, for %4d
// would fill with spaces in C.
std::optional<Read> width_at(std::string_view text, bool zero) {
  Read read{{Piece::Kind::frame, "", 0}};
  const auto end = std::from_chars(text.data(), text.data() + text.size(), read.piece.digits).ptr;
  read.length = size_t(end - text.data());
  if (read.length > 0 && (read.piece.digits > 20 || read.piece.digits < 0 || (zero && text.front() != '0')))
    return std::nullopt;
  return read;
}

// Between `open` and `close`, with `colon` before a width.
std::optional<Read> enclosed_number(std::string_view text, std::string_view open, std::string_view colon, char close) {
  if (!text.starts_with(open)) return std::nullopt;
  std::string_view rest = text.substr(open.size());
  const bool wide = !colon.empty() && rest.starts_with(colon);
  if (wide) rest.remove_prefix(colon.size());
  auto read = width_at(rest, true);
  if (!read || (!colon.empty() && wide != (read->length > 0))) return std::nullopt;
  if (!rest.substr(read->length).starts_with(close)) return std::nullopt;
  read->length += text.size() - rest.size() + 1;
  return read;
}

// What a text begins with; absent where it begins like a place for a number and is none. in_folder: before the last
// "/", where a single "#" is a sign as others are.
std::optional<Read> piece_at(std::string_view text, bool in_folder) {
  const auto sign = [&](size_t length) { return Read{{Piece::Kind::text, std::string(1, text.front())}, length}; };
  for (const char* twice : {"%%", "{{", "}}"})
    if (text.starts_with(twice)) return sign(2);
  if (text.starts_with("{#}")) return Read{{Piece::Kind::text, "#"}, 3};
  if (text.starts_with("{camera}")) return Read{{Piece::Kind::camera}, 8};
  if (text.starts_with('#')) {
    const size_t end = std::min(text.find_first_not_of('#'), text.size());
    if (in_folder && end == 1) return sign(1);
    return Read{{Piece::Kind::frame, "", int(end)}, end};
  }
  if (text.starts_with('%')) return enclosed_number(text, "%", "", 'd');
  if (text.starts_with('{')) return enclosed_number(text, "{frame", ":", '}');
  if (text.starts_with('}')) return std::nullopt;
  if (text.starts_with("$F")) {
    auto read = width_at(text.substr(2), false);
    if (!read) return std::nullopt;
    read->length += 2;
    const bool word = read->length < text.size() && std::isalpha(static_cast<unsigned char>(text[read->length]));
    return word ? sign(1) : *read;
  }
  return sign(1);
}

}  // namespace

Expected<FramePattern> parse_pattern(const std::string& text) {
  FramePattern pattern{.given = text};
  for (size_t i = 0; i < text.size();) {
    const size_t folders = text.rfind('/');
    const auto read = piece_at(std::string_view(text).substr(i), folders != text.npos && i < folders);
    if (!read)
      return fail(ErrorKind::usage, "-o",
                  "the {0} in '{1}' is no frame number; write %04d, ####, {{frame:04}} or $F4, {{camera}} for the "
                  "camera, {{#}} for a #, and {0}{0} for the sign itself",
                  text[i], text);
    if (read->piece.kind == Piece::Kind::frame && std::exchange(pattern.numbered, true))
      return fail(ErrorKind::usage, "-o", "'{}' has more than one place for the frame number", text);
    pattern.by_camera |= read->piece.kind == Piece::Kind::camera;
    pattern.pieces.push_back(read->piece);
    i += read->length;
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
  const auto probe = PreparedFile::create(path);
  return probe ? Expected<void>{} : std::unexpected(probe.error());
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

FrameList shard_of(const FrameList& frames, Shard shard) {
  return frames.every(size_t(shard.count), size_t(shard.index - 1));
}

}  // namespace candela
