#include "job/content_hash.h"

#include "base/files.h"
#include "image/cube_faces.h"

namespace candela {

Expected<Hash128> hash_files(const std::vector<std::string>& files, const std::vector<std::string>& skies,
                             const std::string& look) {
  std::string digests;
  const auto add = [&](const std::string& file) -> Expected<void> {
    const auto bytes = read_file(file);
    if (!bytes) return std::unexpected(bytes.error());
    digests += hash128(*bytes).hex();
    return {};
  };
  for (const std::string& file : files)
    if (auto done = add(file); !done) return std::unexpected(done.error());
  for (const std::string& sky : skies) {
    std::vector<std::string> images = {sky};
    if (names_cube_faces(sky)) {
      const auto faces = cube_face_files(sky);
      if (!faces) return std::unexpected(faces.error());
      images.assign(faces->begin(), faces->end());
    }
    for (const std::string& image : images)
      if (auto done = add(image); !done) return std::unexpected(done.error());
  }
  if (!look.empty())
    if (auto done = add(look); !done) return std::unexpected(done.error());
  return hash128(digests);
}

}  // namespace candela
