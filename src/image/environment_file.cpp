#include "image/environment_file.h"

#include "base/files.h"
#include "base/log.h"
#include "image/cube_faces.h"
#include "image/exr.h"
#include "image/hdr.h"
#include "image/sky_rows.h"

namespace candela {

Expected<DecodedImage> read_environment(const std::filesystem::path& path) {
  std::vector<std::string> warnings;
  auto image = read_environment(path, warnings);
  for (const std::string& warning : warnings) log::warning("{}", warning);
  return image;
}

Expected<DecodedImage> read_environment(const std::filesystem::path& path, std::vector<std::string>& warnings,
                                        uint64_t before_bytes) {
  if (names_cube_faces(path)) {
    auto cube = read_cube_faces(path, before_bytes);
    size_t nonfinite = 0, negative = 0;
    auto* texels = cube ? reinterpret_cast<float*>(cube->pixels.data()) : nullptr;
    for (size_t i = 0; cube && i < cube->pixels.size() / 16; ++i) {
      const TexelFaults faults = usable_texel(texels + 4 * i);
      nonfinite += faults.nonfinite, negative += faults.negative;
    }
    warn_of_faults(nonfinite, negative, path.string(), warnings);
    return cube;
  }
  const auto file = FileReader::open(path);
  if (!file) return std::unexpected(file.error());
  std::vector<std::byte> start(16);
  start.resize(file->read_at(0, start));
  if (!is_exr(start) && !is_hdr(start))
    return fail(ErrorKind::input, path.string(),
                "an environment must be Radiance HDR (.hdr) or OpenEXR (.exr), or a folder of six faces");
  SkyMeans means(path.string(), before_bytes);
  const auto read =
      is_exr(start) ? read_exr_rows(*file, path.string(), means) : read_hdr_rows(*file, path.string(), means);
  if (!read) return std::unexpected(read.error());
  return means.finish(warnings);
}

}  // namespace candela
