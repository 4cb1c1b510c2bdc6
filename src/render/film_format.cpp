#include "render/film_format.h"

#include <algorithm>
#include <array>

#include "base/text.h"

namespace candela {
namespace {

const std::array<FilmCodec, 7>& codecs() {
  static const std::array<FilmCodec, 7> table = {{
      {"h264", "H.264", {".mp4", ".mov", ".mkv"}, true, false, false, false, "aac"},
      {"h265", "H.265", {".mp4", ".mov", ".mkv"}, true, true, true, false, "aac"},
      {"prores", "ProRes 422", {".mov", ".mkv"}, false, true, true, false, "pcm_s24le"},
      {"prores4444", "ProRes 4444", {".mov", ".mkv"}, false, true, true, true, "pcm_s24le"},
      {"ffv1", "FFV1", {".mkv", ".mov"}, false, true, false, true, "pcm_s24le"},
      {"png", "PNG", {".mov", ".mkv"}, false, true, false, true, "pcm_s24le"},
      {"vp9", "VP9", {".webm", ".mkv"}, false, false, false, true, "libopus"},
  }};
  return table;
}

std::vector<std::string> endings(std::string_view codec) {
  std::vector<std::string> all;
  for (const FilmCodec& c : codecs())
    if (codec.empty() || c.name == codec)
      for (const std::string_view ending : c.endings)
        if (std::ranges::find(all, ending) == all.end()) all.emplace_back(ending);
  return all;
}

std::string lower(std::string text) {
  for (char& c : text) c = char(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

bool is_rgb(std::string_view codec) { return codec == "ffv1" || codec == "png"; }

std::vector<std::string> encoder_of(std::string_view codec, int bits, bool alpha) {
  const auto of_bits = [&](const char* eight, const char* eight_alpha, const char* sixteen, const char* sixteen_alpha) {
    return bits == 8 ? (alpha ? eight_alpha : eight) : (alpha ? sixteen_alpha : sixteen);
  };
  if (codec == "h265")  // hvc1: players of Apple take no other tag
    return {"libx265",         "-preset", "medium", "-crf",     "18",         "-x265-params",
            "log-level=error", "-tag:v",  "hvc1",   "-pix_fmt", "yuv420p10le"};
  if (codec == "prores") return {"prores_ks", "-profile:v", "hq", "-vendor", "apl0", "-pix_fmt", "yuv422p10le"};
  if (codec == "prores4444")
    return {"prores_ks", "-profile:v", "4444", "-vendor", "apl0", "-pix_fmt", alpha ? "yuva444p10le" : "yuv444p10le"};
  if (codec == "ffv1")
    return {"ffv1", "-level", "3", "-slicecrc", "1", "-pix_fmt", of_bits("bgr0", "bgra", "gbrp16le", "gbrap16le")};
  if (codec == "png") return {"png", "-pix_fmt", of_bits("rgb24", "rgba", "rgb48be", "rgba64be")};
  if (codec == "vp9")  // frames that are not shown (alt-ref) cannot have alpha
    return {"libvpx-vp9",
            "-crf",
            "18",
            "-b:v",
            "0",
            "-row-mt",
            "1",
            "-cpu-used",
            "2",
            "-auto-alt-ref",
            "0",
            "-pix_fmt",
            alpha ? "yuva420p" : "yuv420p"};
  return {"libx264", "-preset", "medium", "-crf", "18", "-pix_fmt", "yuv420p"};
}

std::string muxer_of(const std::filesystem::path& film) {
  const std::string ending = lower(film.extension().string());
  return ending == ".mkv" ? "matroska" : ending.substr(1);
}

}  // namespace

std::vector<std::string> film_codec_names() {
  std::vector<std::string> names = {"auto"};
  for (const FilmCodec& codec : codecs()) names.emplace_back(codec.name);
  return names;
}

Expected<const FilmCodec*> film_codec(const FilmFile& film) {
  const std::string ending = lower(film.path.extension().string());
  const std::vector<std::string> known = endings("");
  if (std::ranges::find(known, ending) == known.end())
    return fail(ErrorKind::usage, "--video", "'{}' ends in none of {}", film.path.string(), joined(known));
  const std::string name = film.codec != "auto" ? film.codec : ending == ".webm" ? "vp9" : "h264";
  const auto codec = std::ranges::find(codecs(), name, &FilmCodec::name);
  if (codec == codecs().end())
    return fail(ErrorKind::usage, "--video-codec", "{}", unknown_name("codec", name, film_codec_names()));
  if (std::ranges::find(codec->endings, ending) == codec->endings.end())
    return fail(ErrorKind::usage, "--video-codec", "{} goes into files that end in {}, not into '{}'", codec->title,
                joined(endings(codec->name), " or "), film.path.string());
  return &*codec;
}

Expected<void> check_film_size(const FilmFile& film, int width_px, int height_px) {
  const auto codec = film_codec(film);
  if (!codec) return std::unexpected(codec.error());
  if (film.pad || !(*codec)->even_sides || (width_px % 2 == 0 && height_px % 2 == 0)) return {};
  const int less_x = std::max(2, width_px - width_px % 2), less_y = std::max(2, height_px - height_px % 2);
  return fail(ErrorKind::usage, "--video",
              "{} takes even sides, and the film is {}x{}; take {}x{} or {}x{}, --video-pad, which adds a black row or "
              "column, or a --video-codec that takes any size (prores, prores4444, ffv1, png, vp9)",
              (*codec)->title, width_px, height_px, less_x, less_y, width_px + width_px % 2, height_px + height_px % 2);
}

std::vector<std::string> encoder_arguments(const FilmCodec& codec, const FilmFile& film, int bits, bool alpha) {
  std::vector<std::string> a;
  std::string filters = codec.even_sides && film.pad ? "pad=ceil(iw/2)*2:ceil(ih/2)*2" : "";
  if (!is_rgb(codec.name))
    filters += std::string(filters.empty() ? "" : ",") + "scale=out_color_matrix=bt709:out_range=tv";
  if (!filters.empty()) a = {"-vf", filters};
  a.emplace_back("-c:v");
  const std::vector<std::string> encoder = encoder_of(codec.name, bits, alpha);
  a.insert(a.end(), encoder.begin(), encoder.end());
  // Rec.709 is said in the stream, because players guess it from the height otherwise.
  if (!is_rgb(codec.name)) a.insert(a.end(), {"-colorspace", "bt709"});
  a.insert(a.end(),
           {"-color_primaries", "bt709", "-color_trc", "iec61966-2-1", "-movflags", "+faststart", "-map_metadata", "-1",
            "-fflags", "+bitexact", "-flags:v", "+bitexact", "-f", muxer_of(film.path)});
  return a;
}

}  // namespace candela
