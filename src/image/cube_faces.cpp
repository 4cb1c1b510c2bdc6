#include "image/cube_faces.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/glm.hpp>
#include <numbers>
#include <span>

#include "base/input.h"
#include "base/text.h"
#include "image/sky_rows.h"

namespace candela {
namespace {

namespace fs = std::filesystem;
using Names = std::array<const char*, 6>;

constexpr Names conventions[] = {{"px", "nx", "py", "ny", "pz", "nz"},
                                 {"posx", "negx", "posy", "negy", "posz", "negz"},
                                 {"right", "left", "top", "bottom", "front", "back"},
                                 {"right", "left", "up", "down", "front", "back"},
                                 {"rt", "lf", "up", "dn", "ft", "bk"}};

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return text;
}

// "sky_px" ends in "px"; "expx" does not: a letter before it makes it another word.
bool is_face(const fs::path& file, const std::string& name) {
  const std::string stem = lower(file.stem().string());
  if (!stem.ends_with(name)) return false;
  return stem.size() == name.size() || !std::isalpha(static_cast<unsigned char>(stem[stem.size() - name.size() - 1]));
}

std::array<fs::path, 6> faces_by(const Names& names, const fs::path& sky, const std::vector<fs::path>& in_folder) {
  std::array<fs::path, 6> found;
  const std::string pattern = sky.filename().string();
  const size_t star = pattern.find('*');
  for (size_t i = 0; i < 6; ++i) {
    if (star != std::string::npos) {
      const fs::path file = sky.parent_path() / (pattern.substr(0, star) + names[i] + pattern.substr(star + 1));
      std::error_code failed;
      if (fs::exists(file, failed)) found[i] = file;
      continue;
    }
    for (const fs::path& file : in_folder)
      if (is_face(file, names[i])) {
        found[i] = file;
        break;
      }
  }
  return found;
}

struct Face {
  int side = 0;
  std::vector<glm::vec3> texels;
  glm::dvec3 at(double u, double v) const {
    const double x = std::clamp(u * side - 0.5, 0.0, side - 1.0), y = std::clamp(v * side - 0.5, 0.0, side - 1.0);
    const int x0 = int(x), y0 = int(y), x1 = std::min(x0 + 1, side - 1), y1 = std::min(y0 + 1, side - 1);
    const auto texel = [&](int i, int j) { return glm::dvec3(texels[size_t(j) * size_t(side) + size_t(i)]); };
    return glm::mix(glm::mix(texel(x0, y0), texel(x1, y0), x - x0), glm::mix(texel(x0, y1), texel(x1, y1), x - x0),
                    y - y0);
  }
};

// In place: what is read is never before what is written.
void halve(Face& face) {
  const size_t side = size_t(face.side) / 2, row = size_t(face.side);
  for (size_t y = 0; y < side; ++y)
    for (size_t x = 0; x < side; ++x) {
      const glm::vec3* at = face.texels.data() + 2 * y * row + 2 * x;
      face.texels[y * side + x] = 0.25f * (at[0] + at[1] + at[row] + at[row + 1]);
    }
  face.side = int(side);
  face.texels.resize(side * side);
  face.texels.shrink_to_fit();
}

float linear_of(float code) {
  return code <= 0.04045f ? code / 12.92f : float(std::pow((double(code) + 0.055) / 1.055, 2.4));
}

Expected<Face> read_face(const fs::path& file) {
  auto image = read_image(file);
  if (!image) return std::unexpected(image.error());
  if (image->width != image->height)
    return fail(ErrorKind::input, file.string(), "is {}x{}; a face of a sky is square", image->width, image->height);
  const std::string ending = lower(file.extension().string());
  const bool coded = ending != ".hdr" && ending != ".exr" && ending != ".pfm";
  const Channel* grey = image->find("Y");
  std::array<const Channel*, 3> colour = {image->find("R"), image->find("G"), image->find("B")};
  if (!colour[0] && grey) colour = {grey, grey, grey};
  for (const Channel* channel : colour)
    if (!channel || channel->type == ChannelType::uint32)
      return fail(ErrorKind::input, file.string(), "a face of a sky needs the channels R, G and B, or Y");
  Face face{image->width, {}};
  face.texels.resize(size_t(face.side) * size_t(face.side));
  for (size_t i = 0; i < face.texels.size(); ++i)
    for (size_t c = 0; c < 3; ++c) {
      const float value = colour[c]->f[i];
      face.texels[i][int(c)] = coded ? linear_of(value) : value;
    }
  return face;
}

// Vulkan, "Cube Map Face Selection".
glm::dvec3 look_up(const std::array<Face, 6>& faces, glm::dvec3 d) {
  const glm::dvec3 size = glm::abs(d);
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const bool negative = d[axis] < 0;
  const glm::dvec2 across = axis == 0   ? glm::dvec2(negative ? d.z : -d.z, -d.y)
                            : axis == 1 ? glm::dvec2(d.x, negative ? -d.z : d.z)
                                        : glm::dvec2(negative ? -d.x : d.x, -d.y);
  const glm::dvec2 uv = (across / size[axis] + 1.0) * 0.5;
  return faces[size_t(2 * axis + negative)].at(uv.x, uv.y);
}

}  // namespace

bool names_cube_faces(const fs::path& sky) {
  std::error_code failed;
  return sky.filename().string().find('*') != std::string::npos || fs::is_directory(sky, failed);
}

Expected<std::array<fs::path, 6>> cube_face_files(const fs::path& sky) {
  std::vector<fs::path> in_folder;
  std::error_code failed;
  if (fs::is_directory(sky, failed))
    for (const auto& entry : fs::directory_iterator(sky, failed)) in_folder.push_back(entry.path());
  std::sort(in_folder.begin(), in_folder.end());
  std::array<fs::path, 6> best;
  const Names* names = &conventions[0];
  const auto count = [](const std::array<fs::path, 6>& faces) {
    return std::count_if(faces.begin(), faces.end(), [](const fs::path& f) { return !f.empty(); });
  };
  for (const Names& convention : conventions) {
    std::array<fs::path, 6> faces = faces_by(convention, sky, in_folder);
    if (count(faces) > count(best)) best = std::move(faces), names = &convention;
  }
  std::vector<std::string> missing;
  for (size_t i = 0; i < 6; ++i)
    if (best[i].empty()) missing.emplace_back((*names)[i]);
  if (missing.size() == 6)
    return fail(ErrorKind::input, sky.string(),
                "holds no face of a sky: names end in px nx py ny pz nz, or right left top bottom front back");
  if (!missing.empty())
    return fail(ErrorKind::input, sky.string(), "lacks of the six faces of a sky: {}", joined(missing));
  return best;
}

Expected<DecodedImage> read_cube_faces(const fs::path& sky, uint64_t before_bytes) {
  const auto files = cube_face_files(sky);
  if (!files) return std::unexpected(files.error());
  std::array<Face, 6> faces;
  int side = 0;  // of the files'
  for (size_t i = 0; i < 6; ++i) {
    auto face = read_face((*files)[i]);
    if (!face) return std::unexpected(face.error());
    if (i == 0) side = face->side;
    if (face->side != side)
      return fail(ErrorKind::input, (*files)[i].string(), "is {} pixels wide, and {} {}; the faces of a sky are alike",
                  face->side, (*files)[0].filename().string(), side);
    while (4 * face->side > most_sky_width && face->side % 2 == 0) halve(*face);
    faces[i] = std::move(*face);
  }
  DecodedImage out{std::min(4 * faces[0].side, most_sky_width), 0, DecodedImage::Format::rgba32f, 3, {}};
  out.height = std::max(out.width / 2, 1);
  const uint64_t bytes = uint64_t(out.width) * uint64_t(out.height) * 16;
  if (auto fits = charge_decoded(before_bytes, sky_bytes(out.width, out.height), sky.string()); !fits)
    return std::unexpected(fits.error());
  out.pixels.resize(bytes);
  auto* texel = reinterpret_cast<float*>(out.pixels.data());
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x, texel += 4) {
      glm::dvec3 sum(0);
      for (int k = 0; k < 4; ++k) {
        const double longitude = 2 * std::numbers::pi * ((x + 0.25 + 0.5 * (k & 1)) / out.width - 0.5),
                     polar = std::numbers::pi * (y + 0.25 + 0.5 * (k >> 1)) / out.height;
        sum += look_up(faces,
                       {std::sin(polar) * std::cos(longitude), std::cos(polar), std::sin(polar) * std::sin(longitude)});
      }
      for (int c = 0; c < 3; ++c) texel[c] = float(sum[c] / 4);
      texel[3] = 1;
    }
  return out;
}

}  // namespace candela
