#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfChromaticitiesAttribute.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfFramesPerSecond.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfRationalAttribute.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfThreading.h>
#include <OpenEXR/ImfTimeCodeAttribute.h>

#include <algorithm>
#include <cstring>
#include <deque>
#include <mutex>
#include <set>
#include <thread>

#include "base/check.h"
#include "base/files.h"
#include "image/exr.h"
#include "image/exr_zip.h"
#include "image/file_threads.h"
#include "image/prepare.h"
#include "image/seal.h"

namespace candela {
namespace {

constexpr std::array<std::pair<std::string_view, Imf::Compression>, 10> compressions = {{
    {"none", Imf::NO_COMPRESSION},
    {"rle", Imf::RLE_COMPRESSION},
    {"zips", Imf::ZIPS_COMPRESSION},
    {"zip", Imf::ZIP_COMPRESSION},
    {"piz", Imf::PIZ_COMPRESSION},
    {"pxr24", Imf::PXR24_COMPRESSION},
    {"b44", Imf::B44_COMPRESSION},
    {"b44a", Imf::B44A_COMPRESSION},
    {"dwaa", Imf::DWAA_COMPRESSION},
    {"dwab", Imf::DWAB_COMPRESSION},
}};

// OpenEXR ignores write errors while it closes a file (the table of line offsets is written by a destructor). Memory
// cannot fail so; the disk is written afterwards by code that checks.
class MemoryOutput : public Imf::OStream {
 public:
  MemoryOutput() : Imf::OStream("memory") {}
  void write(const char data[], int count) override {
    const size_t end = position_ + size_t(count);
    if (bytes.size() < end) bytes.resize(end);
    std::memcpy(bytes.data() + position_, data, size_t(count));
    position_ = end;
  }
  uint64_t tellp() override { return position_; }
  void seekp(uint64_t position) override { position_ = position; }
  std::string bytes;

 private:
  size_t position_ = 0;
};

// The names that say how the pixels are stored: metadata may not replace them.
bool is_structural(std::string_view name) {
  static const std::set<std::string_view> names = {
      "channels",          "chromaticities", "chunkCount", "compression",      "dataWindow",
      "displayWindow",     "lineOrder",      "name",       "pixelAspectRatio", "screenWindowCenter",
      "screenWindowWidth", "tiles",          "type",       "version"};
  return names.contains(name);
}

Expected<void> add_metadata(Imf::Header& header, const MetadataEntry& entry, const std::string& place) {
  if (entry.name.empty() || entry.name.size() > 255 || is_structural(entry.name))
    return fail(ErrorKind::output, place,
                "metadata \"{}\" cannot be written: the name is empty, too long or reserved by OpenEXR", entry.name);
  const char* name = entry.name.c_str();
  switch (entry.kind) {
    case MetadataEntry::Kind::text:
      if (int h = 0, m = 0, s = 0, f = 0;
          entry.name == "timeCode" && std::sscanf(entry.text.c_str(), "%d:%d:%d:%d", &h, &m, &s, &f) == 4)
        header.insert(name, Imf::TimeCodeAttribute(Imf::TimeCode(h, m, s, f)));
      else
        header.insert(name, Imf::StringAttribute(entry.text));
      break;
    case MetadataEntry::Kind::number:
      // The standard's own type for this name is a ratio; compositors look for nothing else.
      if (entry.name == "framesPerSecond" || entry.name == "captureRate")
        header.insert(name, Imf::RationalAttribute(Imf::guessExactFps(entry.number)));
      else
        header.insert(name, Imf::DoubleAttribute(entry.number));
      break;
    case MetadataEntry::Kind::integer:
      header.insert(name, Imf::IntAttribute(int(entry.number)));
      break;
    case MetadataEntry::Kind::matrix44: {
      CHECK(entry.matrix.size() == 16);
      Imath::M44f matrix;
      std::memcpy(matrix.getValue(), entry.matrix.data(), sizeof(float) * 16);
      header.insert(name, Imf::M44fAttribute(matrix));
      break;
    }
  }
  return {};
}

// A finite value beyond half's range is stored as half's largest: infinity would say that the renderer produced one.
std::vector<uint16_t> to_half(const std::vector<float>& values) {
  std::vector<uint16_t> halves(values.size());
  for (size_t i = 0; i < values.size(); ++i) {
    const float v = values[i];
    halves[i] = Imath::half(std::isfinite(v) ? std::clamp(v, -65504.0f, 65504.0f) : v).bits();
  }
  return halves;
}

Imf::Header header_of(const PictureView& image, ExrCompression compression) {
  const Imath::Box2i data(Imath::V2i(image.origin_x, image.origin_y),
                          Imath::V2i(image.origin_x + image.width - 1, image.origin_y + image.height - 1));
  const bool own_display = image.display_width > 0 && image.display_height > 0;
  const Imath::Box2i display =
      own_display ? Imath::Box2i(Imath::V2i(0, 0), Imath::V2i(image.display_width - 1, image.display_height - 1))
                  : data;
  Imf::Header header(display, data);
  header.compression() = compressions[size_t(compression)].second;
  Imf::addChromaticities(header, Imf::Chromaticities());  // the default is Rec.709 with the D65 white point
  return header;
}

Imf::PixelType pixel_type(ChannelType type) {
  return type == ChannelType::half ? Imf::HALF : type == ChannelType::uint32 ? Imf::UINT : Imf::FLOAT;
}

}  // namespace

// Threads compress blocks of lines; the blocks are written in order, so the bytes do not depend on how many there are.
void set_exr_threads(bool own) {
  const int most = int(std::min(8u, std::max(1u, std::thread::hardware_concurrency())));
  Imf::setGlobalThreadCount(own ? most : 0);
}
void start_exr_threads() {
  static std::once_flag once;
  std::call_once(once, [] { set_exr_threads(file_threads()); });
}

Expected<ExrCompression> exr_compression_from_name(std::string_view name) {
  std::string known;
  for (size_t i = 0; i < compressions.size(); ++i) {
    if (compressions[i].first == name) return ExrCompression(i);
    known += (known.empty() ? "" : ", ") + std::string(compressions[i].first);
  }
  return fail(ErrorKind::usage, {}, "unknown EXR compression \"{}\"; use one of {}", name, known);
}

Expected<std::string> encode_exr(const FloatImage& image, ExrCompression compression, const std::string& place) try {
  PictureView view{image.width,          image.height, image.origin_x, image.origin_y, image.display_width,
                   image.display_height, {},           image.metadata};
  const size_t width = size_t(image.width), count = width * size_t(image.height);
  std::deque<std::vector<uint16_t>> halves;
  for (const Channel& channel : image.channels) {
    CHECK_MSG((channel.type == ChannelType::uint32 ? channel.u.size() : channel.f.size()) == count, channel.name);
    PlaneView& plane = view.planes.emplace_back(PlaneView{channel.name, channel.type, nullptr, width * 4});
    if (channel.type == ChannelType::half) {
      plane.data = reinterpret_cast<const std::byte*>(halves.emplace_back(to_half(channel.f)).data());
      plane.row_bytes = width * 2;
    } else if (channel.type == ChannelType::uint32) {
      plane.data = reinterpret_cast<const std::byte*>(channel.u.data());
    } else {
      plane.data = reinterpret_cast<const std::byte*>(channel.f.data());
    }
  }
  return encode_exr(view, compression, place);
} catch (const std::bad_alloc&) {
  return fail(ErrorKind::out_of_memory, place, "not enough memory to encode the image");
}

Expected<std::string> encode_exr(const PictureView& image, ExrCompression compression, const std::string& place) try {
  CHECK(image.width > 0 && image.height > 0 && !image.planes.empty());
  Imf::Header header = header_of(image, compression);
  for (const MetadataEntry& entry : image.metadata)
    if (auto added = add_metadata(header, entry, place); !added) return std::unexpected(added.error());

  for (const PlaneView& plane : image.planes) {
    CHECK_MSG(!header.channels().findChannel(plane.name.c_str()), "two channels have the same name: " + plane.name);
    header.channels().insert(plane.name.c_str(), Imf::Channel(pixel_type(plane.type)));
  }
  if (compression == ExrCompression::zip || compression == ExrCompression::zips) {
    header.sanityCheck();
    return encode_exr_zip(header, image, compression == ExrCompression::zip ? 16 : 1);
  }
  start_exr_threads();
  Imf::FrameBuffer frame;
  const Imath::V2i corner(image.origin_x, image.origin_y);
  for (const PlaneView& plane : image.planes) {
    const Imf::PixelType type = pixel_type(plane.type);
    frame.insert(plane.name.c_str(),
                 Imf::Slice::Make(type, plane.data, corner, int64_t(image.width), int64_t(image.height),
                                  size_t(type == Imf::HALF ? 2 : 4), plane.row_bytes));
  }
  MemoryOutput output;
  {
    Imf::OutputFile file(output, header);
    file.setFrameBuffer(frame);
    file.writePixels(image.height);
  }
  return std::move(output.bytes);
} catch (const std::bad_alloc&) {
  return fail(ErrorKind::out_of_memory, place, "not enough memory to encode the image");
} catch (const std::system_error&) {
  throw;  // threads are refused: nothing that this image can help
} catch (const std::exception& e) {
  return fail(ErrorKind::output, place, "OpenEXR cannot encode the image: {}", e.what());
}

namespace {
Expected<PreparedFile> prepare_sealed(const std::filesystem::path& path, Expected<std::string> bytes,
                                      std::span<const MetadataEntry> metadata) {
  if (!bytes) return std::unexpected(bytes.error());
  const auto file = std::as_writable_bytes(std::span(bytes->data(), bytes->size()));
  if (std::ranges::any_of(metadata, [](const MetadataEntry& entry) { return entry.name == seal_name; }))
    seal_file(file);
  return prepare_file(path, file);
}
}  // namespace

Expected<PreparedFile> prepare_exr(const std::filesystem::path& path, const FloatImage& image,
                                   ExrCompression compression) {
  return prepare_sealed(path, encode_exr(image, compression, path.string()), image.metadata);
}

Expected<PreparedFile> prepare_exr(const std::filesystem::path& path, const PictureView& image,
                                   ExrCompression compression) {
  return prepare_sealed(path, encode_exr(image, compression, path.string()), image.metadata);
}

Expected<void> write_exr(const std::filesystem::path& path, const FloatImage& image, ExrCompression compression) {
  auto prepared = prepare_exr(path, image, compression);
  if (!prepared) return std::unexpected(prepared.error());
  return prepared->put_in_place();
}

}  // namespace candela
