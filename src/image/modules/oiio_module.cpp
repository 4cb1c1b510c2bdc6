// The module candela_oiio.so: the only file that sees OpenImageIO, which pulls in some 250 shared libraries and is
// therefore opened at first use only (docs/building/decisions.md).
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>
#include <string>

#include "image/modules/oiio_abi.h"

namespace {

int refuse(const std::string& reason, char* message, uint64_t message_size) {
  if (message_size > 0) {
    const size_t length = std::min<size_t>(reason.size(), message_size - 1);
    std::memcpy(message, reason.data(), length);
    message[length] = 0;
  }
  return 1;
}

int read(const char* path, float* (*begin)(void*, int, int, int, const char*), void* context, char* message,
         uint64_t message_size) try {
  OIIO::ImageSpec config;
  config.attribute("oiio:UnassociatedAlpha", 1);
  auto input = OIIO::ImageInput::open(path, &config);
  if (!input) return refuse(OIIO::geterror(), message, message_size);
  const OIIO::ImageSpec& spec = input->spec();
  if (spec.depth > 1 || spec.deep) return refuse("volumes and deep images are not read", message, message_size);
  std::string names;
  for (int c = 0; c < spec.nchannels; ++c) {
    if (c > 0) names += '\n';
    names += std::string(spec.channel_name(c));
  }
  float* target = begin(context, spec.width, spec.height, spec.nchannels, names.c_str());
  if (!target) return refuse("the image is too large", message, message_size);
  if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, target))
    return refuse(input->geterror(), message, message_size);
  // OpenImageIO multiplies codes by a rounded 1/255; a division gives what every other reader here makes of the same
  // code.
  const float largest = spec.format == OIIO::TypeDesc::UINT8    ? 255.0f
                        : spec.format == OIIO::TypeDesc::UINT16 ? 65535.0f
                                                                : 0.0f;
  if (largest > 0)
    for (float *v = target, *end = target + spec.image_pixels() * uint64_t(spec.nchannels); v != end; ++v)
      *v = std::round(*v * largest) / largest;
  return 0;
} catch (const std::exception& e) {
  return refuse(e.what(), message, message_size);
}

}  // namespace

extern "C" __attribute__((visibility("default")))
const candela::oiio::Table candela_oiio_table = {candela::oiio::abi_version, read};
