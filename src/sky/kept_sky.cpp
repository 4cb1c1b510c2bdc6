#include <cstring>

#include "base/files.h"
#include "sky/prefilter_sky.h"

// Filtered skies on disk: filtered_sky() of prefilter_sky.h.
namespace candela {
namespace {

constexpr uint32_t file_version = 3;

template <class T>
void put(std::vector<std::byte>& out, const std::vector<T>& values) {
  const uint64_t count = values.size();
  const auto head = std::as_bytes(std::span(&count, 1)), body = std::as_bytes(std::span(values));
  out.insert(out.end(), head.begin(), head.end());
  out.insert(out.end(), body.begin(), body.end());
}
template <class T>
bool get(std::span<const std::byte>& in, std::vector<T>& values) {
  uint64_t count = 0;
  if (in.size() < sizeof count) return false;
  std::memcpy(&count, in.data(), sizeof count);
  in = in.subspan(sizeof count);
  if (count > in.size() / sizeof(T)) return false;
  values.resize(count);
  if (count > 0) std::memcpy(values.data(), in.data(), count * sizeof(T));
  in = in.subspan(count * sizeof(T));
  return true;
}

std::vector<std::byte> encode(const FilteredSky& sky) {
  std::vector<std::byte> bytes;
  put(bytes, std::vector<uint32_t>{sky.width, sky.height, sky.irradiance_px});
  put(bytes, sky.texels), put(bytes, sky.slices), put(bytes, sky.lights), put(bytes, sky.irradiance);
  put(bytes, sky.lobes);
  const Hash128 hash = hash128(bytes);
  put(bytes, std::vector<uint64_t>{hash.lo, hash.hi});
  return bytes;
}
// Whether the bytes are whole.
bool decode(std::span<const std::byte> bytes, FilteredSky& sky) {
  constexpr size_t tail = 3 * sizeof(uint64_t);
  if (bytes.size() < tail) return false;
  const Hash128 hash = hash128(bytes.first(bytes.size() - tail));
  std::vector<uint32_t> sizes;
  std::vector<uint64_t> written;
  if (!get(bytes, sizes) || !get(bytes, sky.texels) || !get(bytes, sky.slices) || !get(bytes, sky.lights) ||
      !get(bytes, sky.irradiance) || !get(bytes, sky.lobes) || !get(bytes, written) || sizes.size() != 3)
    return false;
  sky.width = sizes[0], sky.height = sizes[1], sky.irradiance_px = sizes[2];
  return written == std::vector<uint64_t>{hash.lo, hash.hi};
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
  if (const auto bytes = read_file(file); bytes && decode(*bytes, sky)) return sky;
  sky = prefilter_sky(image, knobs);
  // Whoever cannot keep it filters it again.
  (void)replace_file_atomically(file, encode(sky));
  return sky;
}

}  // namespace candela
