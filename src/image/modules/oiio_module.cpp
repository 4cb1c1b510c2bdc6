// The module candela_oiio.so: the only file that sees OpenImageIO, which pulls in some 250 shared libraries and is
// therefore opened at first use only (docs/decisions.md).
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cstring>
#include <exception>
#include <string>
#include <vector>

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

int encode_png(int width, int height, int channels, int bits, const void* pixels,
               void (*sink)(void*, const void*, uint64_t), void* context, char* message, uint64_t message_size) try {
  const OIIO::TypeDesc type = bits == 16 ? OIIO::TypeDesc::UINT16 : OIIO::TypeDesc::UINT8;
  OIIO::ImageSpec spec(width, height, channels, type);
  // The pixels are straight alpha already; without the mark OpenImageIO would divide by alpha.
  spec.attribute("oiio:ColorSpace", "sRGB");
  spec.attribute("oiio:UnassociatedAlpha", 1);
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput stream(bytes);
  auto output = OIIO::ImageOutput::create("png", &stream);
  if (!output) return refuse("OpenImageIO cannot write PNG: " + OIIO::geterror(), message, message_size);
  if (!output->supports("ioproxy")) return refuse("this OpenImageIO writes PNG to files only", message, message_size);
  output->set_ioproxy(&stream);
  if (!output->open("image.png", spec) || !output->write_image(type, pixels) || !output->close())
    return refuse(output->geterror(), message, message_size);
  sink(context, bytes.data(), bytes.size());
  return 0;
} catch (const std::exception& e) {
  return refuse(e.what(), message, message_size);
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
  return 0;
} catch (const std::exception& e) {
  return refuse(e.what(), message, message_size);
}

}  // namespace

extern "C" __attribute__((visibility("default")))
const candela::oiio::Table candela_oiio_table = {candela::oiio::abi_version, encode_png, read};
