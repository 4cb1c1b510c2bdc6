#include "render/dump.h"

#include <bit>
#include <cmath>
#include <cstring>

#include "base/check.h"
#include "graph/formats.h"
#include "image/io.h"
#include "render/metadata.h"

namespace candela {
namespace {

enum class Numbers { unorm, snorm, uint, sint, sfloat, ufloat, srgb };

struct Component {
  char letter;
  uint32_t bits, shift;  // from the texel's lowest bit
};

// How a format lays out a texel, as its name says: "R16G16_SFLOAT" in the order of memory; what is packed into 32 bits
// from the highest bit down.
struct Texel {
  std::vector<Component> components;
  Numbers numbers = Numbers::unorm;
  uint32_t bytes = 0;
  bool shared_exponent = false;
};

Numbers numbers_of(std::string_view name) {
  constexpr std::pair<std::string_view, Numbers> endings[] = {
      {"UNORM", Numbers::unorm},   {"SNORM", Numbers::snorm},   {"UINT", Numbers::uint}, {"SINT", Numbers::sint},
      {"SFLOAT", Numbers::sfloat}, {"UFLOAT", Numbers::ufloat}, {"SRGB", Numbers::srgb}};
  const std::string_view ending = name.substr(name.rfind('_') + 1);
  for (const auto& [text, numbers] : endings)
    if (text == ending) return numbers;
  CHECK_MSG(false, std::string(name));
}

Texel texel_of(VkFormat format) {
  Texel texel;
  std::string name(format_name(format));
  if (has_stencil(format)) name = "D32_SFLOAT";  // copies move the depth alone
  texel.numbers = numbers_of(name);
  texel.bytes = copied_bytes(format);
  for (size_t at = 0; name[at] != '_';) {
    Component component{name[at++], 0, 0};
    while (name[at] >= '0' && name[at] <= '9') component.bits = component.bits * 10 + uint32_t(name[at++] - '0');
    texel.components.push_back(component);
  }
  texel.shared_exponent = texel.components.front().letter == 'E';
  const bool packed = texel.shared_exponent || texel.components.front().bits != texel.components.back().bits;
  uint32_t low = 0;
  for (Component& component : texel.components) {
    component.shift = packed ? 32 - low - component.bits : low;
    low += component.bits;
  }
  return texel;
}

// Five bits of exponent, and so many of mantissa; without a sign.
float small_float(uint32_t bits, uint32_t mantissa_bits) {
  const uint32_t mantissa = bits & ((1u << mantissa_bits) - 1), exponent = bits >> mantissa_bits;
  if (exponent == 31)
    return mantissa ? std::numeric_limits<float>::quiet_NaN() : std::numeric_limits<float>::infinity();
  if (exponent == 0) return std::ldexp(float(mantissa), -14 - int(mantissa_bits));
  return std::ldexp(float(mantissa | 1u << mantissa_bits), int(exponent) - 15 - int(mantissa_bits));
}

float value_of(Numbers numbers, uint32_t raw, uint32_t bits, char letter) {
  const double most = double((uint64_t(1) << bits) - 1), most_signed = double((uint64_t(1) << (bits - 1)) - 1);
  const int32_t signed_raw = int32_t(raw << (32 - bits)) >> (32 - bits);
  switch (numbers) {
    case Numbers::unorm:
      return float(raw / most);
    case Numbers::srgb: {
      const double code = raw / most;
      if (letter == 'A') return float(code);
      return float(code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4));
    }
    case Numbers::snorm:
      return float(std::max(signed_raw / most_signed, -1.0));
    case Numbers::sint:
      return float(signed_raw);
    case Numbers::ufloat:
      return small_float(raw, bits - 5);
    case Numbers::sfloat:
      if (bits == 32) return std::bit_cast<float>(raw);
      return std::copysign(small_float(raw & 0x7fff, 10), raw >> 15 ? -1.0f : 1.0f);
    case Numbers::uint:
      break;
  }
  return float(raw);
}

uint32_t raw_of(const std::byte* texel, const Texel& layout, const Component& component) {
  uint64_t word = 0;
  const uint32_t first = component.shift / 8, last = (component.shift + component.bits - 1) / 8;
  std::memcpy(&word, texel + first, last - first + 1);
  CHECK(last < layout.bytes);
  return uint32_t(word >> (component.shift % 8) & ((uint64_t(1) << component.bits) - 1));
}

std::string channel_name(const Texel& texel, char letter) {
  if (letter == 'D') return "Z";
  return texel.components.size() == 1 ? "Y" : std::string(1, letter);
}

void add_channel(FloatImage& image, const Texel& texel, const Component& component, const std::byte* texels) {
  Channel& channel = image.channels.emplace_back();
  channel.name = channel_name(texel, component.letter);
  const size_t count = size_t(image.width) * size_t(image.height);
  if (texel.numbers == Numbers::uint) {
    channel.type = ChannelType::uint32;
    for (size_t i = 0; i < count; ++i) channel.u.push_back(raw_of(texels + i * texel.bytes, texel, component));
    return;
  }
  if (texel.numbers == Numbers::sfloat && component.bits == 16) channel.type = ChannelType::half;
  for (size_t i = 0; i < count; ++i) {
    const std::byte* at = texels + i * texel.bytes;
    const uint32_t raw = raw_of(at, texel, component);
    if (texel.shared_exponent)
      channel.f.push_back(std::ldexp(float(raw), int(raw_of(at, texel, texel.components.front())) - 15 - 9));
    else
      channel.f.push_back(value_of(texel.numbers, raw, component.bits, component.letter));
  }
}

// The first sample of each pixel: words that follow one another, as hash_samples.comp writes them.
std::vector<std::byte> first_samples(const ImageDesc& image, std::span<const std::byte> bytes, Texel& texel) {
  const size_t sample = format_channels(image.format) * sizeof(uint32_t),
               pixels = bytes.size() / (sample * image.samples);
  std::vector<std::byte> first(pixels * sample);
  for (size_t i = 0; i < pixels; ++i)
    std::memcpy(first.data() + i * sample, bytes.data() + i * sample * image.samples, sample);
  texel.bytes = uint32_t(sample);
  for (size_t c = 0; c < texel.components.size(); ++c) {
    // Shaders see components in the order R G B A, whatever that of memory.
    const size_t place = texel.components.size() == 1 ? 0 : std::string_view("RGBA").find(texel.components[c].letter);
    texel.components[c].bits = 32;
    texel.components[c].shift = uint32_t(place) * 32;
  }
  if (texel.numbers != Numbers::uint) texel.numbers = Numbers::sfloat;
  return first;
}

}  // namespace

FloatImage dump_image(const FrameDump& dump, std::span<const std::byte> bytes) {
  const ImageDesc& desc = dump.image;
  FloatImage image;
  image.width = int(mip_size(desc.width_px, dump.request.mip));
  image.height = int(mip_size(desc.height_px, dump.request.mip));
  Texel texel = texel_of(desc.format);
  std::vector<std::byte> samples;
  bool half = false;
  if (desc.samples > 1) {
    half = texel.components.front().bits == 16 && texel.numbers == Numbers::sfloat;
    samples = first_samples(desc, bytes, texel);
    bytes = samples;
  }
  const size_t slice = size_t(image.width) * size_t(image.height) * texel.bytes;
  const size_t begin = desc.kind == ImageKind::d3 ? slice * dump.request.layer : 0;
  CHECK_MSG(bytes.size() >= begin + slice, dump.request.text());
  for (const char letter : std::string_view("RGBAD"))
    for (const Component& component : texel.components)
      if (component.letter == letter) add_channel(image, texel, component, bytes.data() + begin);
  if (half)
    for (Channel& channel : image.channels) channel.type = ChannelType::half;
  auto& metadata = image.metadata;
  metadata.push_back(text_entry("candela:dump", dump.request.text()));
  metadata.push_back(text_entry("candela:pass", dump.pass));
  metadata.push_back(text_entry("candela:format", std::string(format_name(desc.format))));
  if (desc.samples > 1) metadata.push_back(text_entry("candela:sample", fmt::format("first of {}", desc.samples)));
  return image;
}

Expected<void> write_dumps(const FrameResult& frame, const Job& job, const Session& session,
                           const std::vector<std::filesystem::path>& paths) {
  CHECK(paths.size() <= frame.dumps.size());
  for (size_t i = 0; i < paths.size(); ++i) {
    const FrameDump& dump = frame.dumps[i];
    FloatImage image = dump_image(dump, frame.readbacks.at(dump.resource)->bytes());
    auto& metadata = image.metadata;
    metadata.push_back(number_entry("candela:pre_exposure", MetadataEntry::Kind::number, frame.pre_exposure));
    metadata.push_back(number_entry("candela:time", MetadataEntry::Kind::number, frame.time_s));
    metadata.push_back(text_entry("candela:job", job_json(without_folders(job))));
    metadata.push_back(text_entry("candela:plan", frame.plan_hash.hex()));
    metadata.push_back(text_entry("candela:device", session.device().info().name));
    metadata.push_back(text_entry("candela:driver", session.device().info().driver));
    metadata.push_back(text_entry("candela:version", CANDELA_VERSION));
    if (auto written = write_exr(paths[i], image); !written) return written;
  }
  return {};
}

}  // namespace candela
