#pragma once
#include <glm/glm.hpp>

#include "image/io.h"
#include "scene/scene.h"

namespace candela::reference {

// A decoded image as the sampler of a glTF texture sees it, in double.
//
// Level 0 alone is read, with the magnification filter of the sampler, and the mean over a pixel is left to its
// samples: the reference is the integral that mip maps and anisotropic filters approximate, so their error is seen as
// such. Nearest filters show steps, as they should.
class Texture {
 public:
  Texture(DecodedImage image, bool srgb) : image_(std::move(image)), srgb_(srgb) {}

  glm::dvec4 sample(glm::dvec2 uv, const Sampler& sampler) const;
  // The mean over a parallelogram about uv: of four points a texel each way, of at most 512. premultiplied: colours
  // weigh as their alpha.
  glm::dvec4 mean(glm::dvec2 uv, const glm::dvec2 sides[2], const Sampler& sampler, bool premultiplied) const;
  glm::dvec4 texel(int x, int y) const;  // linear; the coordinates lie inside
  int width() const { return image_.width; }
  int height() const { return image_.height; }

 private:
  DecodedImage image_;
  bool srgb_;
};

// KHR_texture_transform: T(offset) R(rotation) S(scale) uv, rotation counter-clockwise where v points down.
glm::dvec2 transformed_uv(const TextureSlot& slot, glm::dvec2 uv);

}  // namespace candela::reference
