#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfRationalAttribute.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfThreading.h>

#include <cstring>
#include <mutex>
#include <stdexcept>

#include "base/input.h"
#include "image/exr.h"
#include "image/sky_rows.h"

namespace candela {
namespace {

class MemoryInput : public Imf::IStream {
 public:
  explicit MemoryInput(std::span<const std::byte> bytes) : Imf::IStream("memory"), bytes_(bytes) {}
  bool read(char target[], int count) override {
    if (count < 0 || position_ > bytes_.size() || uint64_t(count) > bytes_.size() - position_)
      throw std::runtime_error("the file ends early");
    std::memcpy(target, bytes_.data() + position_, size_t(count));
    position_ += uint64_t(count);
    farthest_ = std::max(farthest_, position_);
    return position_ < bytes_.size();
  }
  uint64_t tellg() override { return position_; }
  void seekg(uint64_t position) override { position_ = position; }
  uint64_t farthest() const { return farthest_; }  // end of the bytes that were read

 private:
  std::span<const std::byte> bytes_;
  uint64_t position_ = 0, farthest_ = 0;
};

// Parts of a file as they are asked for.
class FileInput : public Imf::IStream {
 public:
  explicit FileInput(const FileReader& file) : Imf::IStream("file"), file_(file) {}
  bool read(char target[], int count) override {
    if (count < 0 ||
        file_.read_at(position_, std::as_writable_bytes(std::span(target, size_t(count)))) != size_t(count))
      throw std::runtime_error("the file ends early");
    position_ += uint64_t(count);
    return position_ < file_.size();
  }
  uint64_t tellg() override { return position_; }
  void seekg(uint64_t position) override { position_ = position; }

 private:
  const FileReader& file_;
  uint64_t position_ = 0;
};

// Lines per block, and how many bytes of pixels one byte of the file can hold at most: deflate gives 1032 (pxr24 stores
// 3 of 4 bytes first), run lengths 64, PIZ's Huffman runs about 430, B44A 32 bytes in 3, DWA one coefficient of 64 and
// then deflate.
struct Density {
  int lines;
  uint64_t bytes_per_byte;
};
Density density_of(Imf::Compression compression) {
  switch (compression) {
    case Imf::NO_COMPRESSION:
      return {1, 1};
    case Imf::RLE_COMPRESSION:
      return {1, 64};
    case Imf::ZIPS_COMPRESSION:
      return {1, 1032};
    case Imf::ZIP_COMPRESSION:
      return {16, 1032};
    case Imf::PIZ_COMPRESSION:
      return {32, 1032};
    case Imf::PXR24_COMPRESSION:
      return {16, 1400};
    case Imf::B44_COMPRESSION:
    case Imf::B44A_COMPRESSION:
      return {32, 1032};  // channels that are not half are stored flat
    case Imf::DWAA_COMPRESSION:
      return {32, 65536};
    default:
      return {256, 65536};
  }
}

// Before any pixel memory: sides, and that a file of this length can hold so many pixels. Each block of lines (or tile)
// needs an 8-byte offset and a head of at least 8 bytes besides its data.
void check_size(const Imf::Header& header, uint64_t file_length) {
  const Imath::Box2i window = header.dataWindow();
  const int64_t width = int64_t(window.max.x) - window.min.x + 1, height = int64_t(window.max.y) - window.min.y + 1;
  if (width <= 0 || height <= 0) throw std::runtime_error("the data window is empty");
  if (width > max_exr_side || height > max_exr_side)
    throw std::runtime_error(fmt::format("{}x{} pixels are more than {} on a side", width, height, max_exr_side));
  uint64_t bytes_per_pixel = 0;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
    if (c.channel().xSampling != 1 || c.channel().ySampling != 1)
      throw std::runtime_error(fmt::format("channel {} is subsampled, which is not supported", c.name()));
    bytes_per_pixel += c.channel().type == Imf::HALF ? 2 : 4;
  }
  if (bytes_per_pixel == 0) throw std::runtime_error("there are no channels");
  const Density density = density_of(header.compression());
  uint64_t blocks = uint64_t((height + density.lines - 1) / density.lines);
  if (header.hasTileDescription()) {
    const Imf::TileDescription& tile = header.tileDescription();
    if (tile.xSize == 0 || tile.ySize == 0) throw std::runtime_error("the tile size is zero");
    blocks = ((uint64_t(width) + tile.xSize - 1) / tile.xSize) * ((uint64_t(height) + tile.ySize - 1) / tile.ySize);
  }
  const uint64_t pixel_bytes = uint64_t(width) * uint64_t(height) * bytes_per_pixel;
  if (blocks * 16 > file_length || pixel_bytes / density.bytes_per_byte > file_length)
    throw std::runtime_error(fmt::format("{}x{} pixels cannot be held by {} bytes", width, height, file_length));
}

// OpenEXR sizes its tables by the header before we can look at it; these limits are for the whole process.
void limit_sizes() {
  static std::once_flag once;
  std::call_once(once, [] {
    Imf::Header::setMaxImageSize(max_exr_side, max_exr_side);
    Imf::Header::setMaxTileSize(max_exr_side, max_exr_side);
  });
}

int channel_count(const Imf::Header& header) {
  int count = 0;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c) ++count;
  return count;
}

void read_metadata(const Imf::Header& header, FloatImage& image) {
  for (auto a = header.begin(); a != header.end(); ++a) {
    MetadataEntry entry{.name = a.name()};
    using Kind = MetadataEntry::Kind;
    const Imf::Attribute& attribute = a.attribute();
    if (entry.name == "name" || entry.name == "type" || entry.name == "chunkCount" ||
        entry.name == "pixelAspectRatio" || entry.name == "screenWindowWidth")
      continue;
    const auto set_number = [&](Kind kind, double value) { entry.kind = kind, entry.number = value; };
    const auto set_matrix = [&](const auto& matrix) {
      entry.kind = Kind::matrix44;
      for (int i = 0; i < 16; ++i) entry.matrix.push_back(float(matrix[i / 4][i % 4]));
    };
    if (auto* text = dynamic_cast<const Imf::StringAttribute*>(&attribute))
      entry.text = text->value();
    else if (auto* f = dynamic_cast<const Imf::FloatAttribute*>(&attribute))
      set_number(Kind::number, f->value());
    else if (auto* d = dynamic_cast<const Imf::DoubleAttribute*>(&attribute))
      set_number(Kind::number, d->value());
    else if (auto* i = dynamic_cast<const Imf::IntAttribute*>(&attribute))
      set_number(Kind::integer, i->value());
    else if (auto* r = dynamic_cast<const Imf::RationalAttribute*>(&attribute))
      set_number(Kind::number, double(r->value()));
    else if (auto* mf = dynamic_cast<const Imf::M44fAttribute*>(&attribute))
      set_matrix(mf->value());
    else if (auto* md = dynamic_cast<const Imf::M44dAttribute*>(&attribute))
      set_matrix(md->value());
    else
      continue;
    image.metadata.push_back(std::move(entry));
  }
}

void read_part(Imf::MultiPartInputFile& file, int part_index, FloatImage& image) {
  const Imf::Header& header = file.header(part_index);
  const std::string layer = part_index > 0 && header.hasName() ? header.name() + "." : "";
  const size_t first = image.channels.size(), count = size_t(image.width) * size_t(image.height);
  const Imath::Box2i window = header.dataWindow();
  std::vector<std::string> names;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
    const std::string name = c.name();
    Channel& channel = image.channels.emplace_back();
    channel.name = name.starts_with(layer) ? name : layer + name;
    channel.type = c.channel().type == Imf::HALF   ? ChannelType::half
                   : c.channel().type == Imf::UINT ? ChannelType::uint32
                                                   : ChannelType::float32;
    if (channel.type == ChannelType::uint32)
      channel.u.resize(count);
    else
      channel.f.resize(count);
    names.push_back(name);
  }
  Imf::FrameBuffer frame;
  for (size_t i = first; i < image.channels.size(); ++i) {
    Channel& channel = image.channels[i];
    const bool is_integer = channel.type == ChannelType::uint32;
    const void* target = is_integer ? static_cast<const void*>(channel.u.data()) : channel.f.data();
    frame.insert(names[i - first], Imf::Slice::Make(is_integer ? Imf::UINT : Imf::FLOAT, target, window));
  }
  Imf::InputPart part(file, part_index);
  part.setFrameBuffer(frame);
  part.readPixels(window.min.y, window.max.y);
}

}  // namespace

bool is_exr(std::span<const std::byte> bytes) {
  static constexpr uint8_t magic[] = {0x76, 0x2f, 0x31, 0x01};
  return bytes.size() >= 4 && std::memcmp(bytes.data(), magic, 4) == 0;
}

Expected<ImageInfo> probe_exr(std::span<const std::byte> bytes, const std::string& place) try {
  limit_sizes();
  MemoryInput input(bytes);
  Imf::MultiPartInputFile file(input, 0);
  for (int p = 0; p < file.parts(); ++p) {
    const Imf::Header& header = file.header(p);
    if (header.hasType() && !Imf::isImage(header.type())) continue;
    check_size(header, bytes.size());
    const Imath::Box2i window = header.dataWindow();
    return ImageInfo{window.max.x - window.min.x + 1, window.max.y - window.min.y + 1, channel_count(header), 32};
  }
  return fail(ErrorKind::input, place, "holds deep data only, which is not supported");
} catch (const std::bad_alloc&) {
  return fail(ErrorKind::out_of_memory, place, "not enough memory to read the image");
} catch (const std::exception& e) {
  return fail(ErrorKind::input, place, "is not a readable EXR image: {}", e.what());
}

namespace {
// Its colours, in order, and how many there are; nothing: it has none.
std::optional<std::pair<std::array<std::string, 3>, int>> colours_of(const Imf::Header& header) {
  const auto has = [&](const char* name) {
    const Imf::Channel* channel = header.channels().findChannel(name);
    return channel && channel->type != Imf::UINT;
  };
  if (has("R") && has("G") && has("B")) return {{{"R", "G", "B"}, 3}};
  if (!header.channels().findChannel("R") && has("Y")) return {{{"Y", "Y", "Y"}, 1}};
  return {};
}
}  // namespace

Expected<void> read_exr_rows(const FileReader& reader, const std::string& place, SkyRowSink& sink) try {
  limit_sizes();
  start_exr_threads();
  FileInput input(reader);
  Imf::MultiPartInputFile file(input, Imf::globalThreadCount());
  int p = 0;
  while (p < file.parts() && file.header(p).hasType() && !Imf::isImage(file.header(p).type())) ++p;
  if (p == file.parts()) return fail(ErrorKind::input, place, "holds deep data only, which is not supported");
  const Imf::Header& header = file.header(p);
  check_size(header, reader.size());
  // Only what it becomes is charged: time is bounded as probe_image() bounds it.
  const Imath::Box2i window = header.dataWindow();
  const int width = window.max.x - window.min.x + 1, height = window.max.y - window.min.y + 1;
  if (const uint64_t pixels = uint64_t(width) * uint64_t(height);
      pixels > uint64_t(1) << 27 && pixels / 64 > reader.size())
    return fail(ErrorKind::input, place, "{}x{} pixels are out of proportion to {} bytes", width, height,
                reader.size());
  // Channels of later parts have the part's name before theirs.
  const auto colours = p == 0 ? colours_of(header) : std::nullopt;
  if (!colours) return fail(ErrorKind::input, place, "an environment needs the channels R, G and B, or Y");
  if (auto fits = sink.begin({width, height, colours->second, 32}); !fits) return fits;
  // As many lines as the largest block has.
  const int strip = std::min(256, height), planes = colours->second;
  std::vector<float> values(size_t(strip) * size_t(width) * size_t(planes));
  const size_t plane_size = size_t(strip) * size_t(width);
  Imf::InputPart part(file, p);
  for (int first = 0; first < height; first += strip) {
    const int count = std::min(strip, height - first);
    const Imath::Box2i lines({window.min.x, window.min.y + first}, {window.max.x, window.min.y + first + count - 1});
    Imf::FrameBuffer frame;
    for (int c = 0; c < planes; ++c)
      frame.insert(colours->first[size_t(c)],
                   Imf::Slice::Make(Imf::FLOAT, values.data() + size_t(c) * plane_size, lines));
    part.setFrameBuffer(frame);
    part.readPixels(lines.min.y, lines.max.y);
    sink.add(first, count, [&](int row, float* texels) {
      const float* from = values.data() + size_t(row - first) * size_t(width);
      for (int x = 0; x < width; ++x) {
        for (int c = 0; c < 3; ++c) texels[4 * x + c] = from[size_t(planes == 3 ? c : 0) * plane_size + size_t(x)];
        texels[4 * x + 3] = 1;
      }
    });
  }
  return {};
} catch (const std::bad_alloc&) {
  return fail(ErrorKind::out_of_memory, place, "not enough memory to read the image");
} catch (const std::exception& e) {
  return fail(ErrorKind::input, place, "is not a readable EXR image: {}", e.what());
}

Expected<FloatImage> decode_exr(std::span<const std::byte> bytes, const std::string& place, bool whole) try {
  limit_sizes();
  MemoryInput input(bytes);
  Imf::MultiPartInputFile file(input, 0);
  FloatImage image;
  std::optional<Imath::Box2i> first;
  uint64_t decoded = 0;
  for (int p = 0; p < file.parts(); ++p) {
    const Imf::Header& header = file.header(p);
    if (header.hasType() && !Imf::isImage(header.type())) continue;
    const Imath::Box2i data = header.dataWindow(), display = header.displayWindow();
    check_size(header, bytes.size());
    const int width = data.max.x - data.min.x + 1, height = data.max.y - data.min.y + 1;
    if (!first) {
      first = data;
      image.width = width, image.height = height;
      image.origin_x = data.min.x - display.min.x, image.origin_y = data.min.y - display.min.y;
      if (data != display) {
        image.display_width = display.max.x - display.min.x + 1;
        image.display_height = display.max.y - display.min.y + 1;
      }
      read_metadata(header, image);
    } else if (data != *first) {
      continue;
    }
    const uint64_t bytes_of_part = uint64_t(width) * uint64_t(height) * uint64_t(channel_count(header)) * 4;
    if (auto fits = charge_decoded(decoded, bytes_of_part, place); !fits) return std::unexpected(fits.error());
    read_part(file, p, image);
  }
  if (!first) return fail(ErrorKind::input, place, "holds deep data only, which is not supported");
  if (whole && input.farthest() != bytes.size())
    return fail(ErrorKind::input, place, "{} bytes follow the end of the image", bytes.size() - input.farthest());
  return image;
} catch (const std::bad_alloc&) {
  return fail(ErrorKind::out_of_memory, place, "not enough memory to read the image");
} catch (const std::exception& e) {
  return fail(ErrorKind::input, place, "is not a readable EXR image: {}", e.what());
}

}  // namespace candela
