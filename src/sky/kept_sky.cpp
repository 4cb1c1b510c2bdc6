#include "base/files.h"
#include "sky/prefilter_sky.h"

// Filtered skies on disk: filtered_sky() of prefilter_sky.h.
namespace candela {
namespace {

constexpr uint32_t file_version = 5;

// A count before each part; at the end the hash of all parts in turn.
class Writer {
 public:
  template <class T>
  void part(const std::vector<T>& values) {
    const uint64_t count = values.size();
    const auto head = std::as_bytes(std::span(&count, 1)), body = std::as_bytes(std::span(values));
    bytes_.insert(bytes_.end(), head.begin(), head.end());
    bytes_.insert(bytes_.end(), body.begin(), body.end());
    hash_ = hash128(body, hash_.lo);
  }
  std::vector<std::byte> finished() {
    const auto tail = std::as_bytes(std::span(&hash_, 1));
    bytes_.insert(bytes_.end(), tail.begin(), tail.end());
    return std::move(bytes_);
  }

 private:
  std::vector<std::byte> bytes_;
  Hash128 hash_;
};

// Reads into the parts themselves: a sky is as large as the frame's other memory together.
class Reader {
 public:
  explicit Reader(const FileReader& file) : file_(file) {}
  template <class T>
  bool part(std::vector<T>& values) {
    uint64_t count = 0;
    if (!read(std::as_writable_bytes(std::span(&count, 1))) || count > (file_.size() - at_) / sizeof(T)) return false;
    values.resize(count);
    const auto body = std::as_writable_bytes(std::span(values));
    if (!read(body)) return false;
    hash_ = hash128(body, hash_.lo);
    return true;
  }
  bool is_whole() {
    Hash128 written;
    return read(std::as_writable_bytes(std::span(&written, 1))) && written == hash_ && at_ == file_.size();
  }

 private:
  bool read(std::span<std::byte> bytes) {
    const size_t done = file_.read_at(at_, bytes);
    at_ += done;
    return done == bytes.size();
  }
  const FileReader& file_;
  uint64_t at_ = 0;
  Hash128 hash_;
};

std::vector<std::byte> encode(const FilteredSky& sky) {
  Writer out;
  out.part(std::vector<uint32_t>{sky.width, sky.height, sky.irradiance_px});
  out.part(sky.texels), out.part(sky.slices), out.part(sky.lights), out.part(sky.irradiance), out.part(sky.lobes);
  return out.finished();
}
// Whether the file is whole.
bool decode(const FileReader& file, FilteredSky& sky) {
  Reader in(file);
  std::vector<uint32_t> sizes;
  if (!in.part(sizes) || !in.part(sky.texels) || !in.part(sky.slices) || !in.part(sky.lights) ||
      !in.part(sky.irradiance) || !in.part(sky.lobes) || sizes.size() != 3)
    return false;
  sky.width = sizes[0], sky.height = sizes[1], sky.irradiance_px = sizes[2];
  return in.is_whole();
}

}  // namespace

FilteredSky filtered_sky(const DecodedImage& image, const IblKnobs& knobs, const std::filesystem::path& cache) {
  if (cache.empty()) return prefilter_sky(image, knobs);
  std::error_code failed;
  std::filesystem::create_directories(cache / "skies", failed);
  const std::string key =
      fmt::format("{} {} {}x{} {} {} {} {} {} {}", file_version, CANDELA_VERSION, image.width, image.height,
                  hash128(image.pixels).hex(), IblMethod(knobs.method) == IblMethod::lobe, knobs.lights, knobs.size_px,
                  knobs.filter_samples, knobs.irradiance_px);
  const std::filesystem::path file = cache / "skies" / (hash128(key).hex() + ".sky");
  FilteredSky sky;
  if (const auto kept = FileReader::open(file); kept && decode(*kept, sky)) return sky;
  sky = prefilter_sky(image, knobs);
  // Whoever cannot keep it filters it again.
  (void)replace_file_atomically(file, encode(sky));
  return sky;
}

}  // namespace candela
