#include "stability/scene_files.h"

#include <cstring>

#include "base/files.h"
#include "image/io.h"

namespace candela {
namespace fs = std::filesystem;

Expected<void> write_scene_files(const StabilityScene& scene, const fs::path& folder) {
  std::error_code ignored;
  fs::create_directories(folder, ignored);
  const auto write = [&](const char* name, const std::vector<std::byte>& bytes) -> Expected<void> {
    return bytes.empty() ? Expected<void>() : write_file_atomically(folder / name, std::span<const std::byte>(bytes));
  };
  if (auto done = write("scene.glb", scene.file); !done) return done;
  if (auto done = write("plain.glb", scene.plain); !done) return done;
  if (scene.sky)
    if (auto done = write_exr((folder / "sky.exr"), *scene.sky, ExrCompression::zip); !done) return done;
  if (scene.plain_sky)
    if (auto done = write_exr((folder / "plain-sky.exr"), *scene.plain_sky, ExrCompression::zip); !done) return done;
  if (scene.second_sky)
    if (auto done = write_exr((folder / "second.exr"), *scene.second_sky, ExrCompression::zip); !done) return done;
  if (!scene.sky_look.empty())
    if (auto done = write_file_atomically((folder / "look.json"), std::as_bytes(std::span(scene.sky_look))); !done)
      return done;
  for (const auto& [name, text] : scene.texts)
    if (auto done = write_file_atomically((folder / name), std::as_bytes(std::span(text))); !done) return done;
  return {};
}

DisplayImage eight_bits(const DisplayImage& image) {
  if (image.bits == 8) return image;
  DisplayImage small{image.width, image.height, image.channels, 8, {}};
  for (size_t i = 0; i + 1 < image.pixels.size(); i += 2) {
    uint16_t value = 0;
    std::memcpy(&value, &image.pixels[i], sizeof value);
    small.pixels.push_back(std::byte(value >> 8));
  }
  return small;
}

}  // namespace candela
