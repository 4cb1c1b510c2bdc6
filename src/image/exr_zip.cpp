#include "image/exr_zip.h"

#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <libdeflate.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <memory>
#include <new>

#include "base/check.h"
#include "image/file_threads.h"

namespace candela {
namespace {

static_assert(std::endian::native == std::endian::little, "EXR files are");

// By speed and size of renders: bench/README.md.
constexpr int level = 4;

class StringOutput : public Imf::OStream {
 public:
  explicit StringOutput(std::string& bytes) : Imf::OStream("memory"), bytes_(bytes) {}
  void write(const char data[], int count) override {
    CHECK(at_ == bytes_.size());
    bytes_.append(data, size_t(count));
    at_ += size_t(count);
  }
  uint64_t tellp() override { return at_; }
  void seekp(uint64_t) override { CHECK(false); }

 private:
  std::string& bytes_;
  size_t at_ = bytes_.size();
};

bool has_long_names(const Imf::Header& header, const PictureView& image) {
  constexpr size_t most = 31;
  for (auto entry = header.begin(); entry != header.end(); ++entry)
    if (std::strlen(entry.name()) > most || std::strlen(entry.attribute().typeName()) > most) return true;
  return std::ranges::any_of(image.planes, [](const PlaneView& plane) { return plane.name.size() > most; });
}

template <class T>
void append(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

size_t sample_bytes(const PlaneView& plane) { return plane.type == ChannelType::half ? 2 : 4; }

// One thread's memory.
class Block {
 public:
  Block() : compressor_(libdeflate_alloc_compressor(level), libdeflate_free_compressor) {
    if (!compressor_) throw std::bad_alloc();
  }
  // The lines of every plane in turn, compressed; as they are where that is no shorter.
  std::string compress(const PictureView& image, const std::vector<const PlaneView*>& planes, int first, int last) {
    raw_.clear();
    for (int y = first; y < last; ++y)
      for (const PlaneView* plane : planes) {
        const auto* row = reinterpret_cast<const char*>(plane->data) + size_t(y) * plane->row_bytes;
        raw_.append(row, sample_bytes(*plane) * size_t(image.width));
      }
    apart_.resize(raw_.size());
    const size_t low = (raw_.size() + 1) / 2, pairs = raw_.size() / 2;
    for (size_t i = 0; i < pairs; ++i) apart_[i] = raw_[2 * i], apart_[low + i] = raw_[2 * i + 1];
    if (pairs < low) apart_[pairs] = raw_.back();
    // Differences from byte to byte, around 128.
    differences_.resize(apart_.size());
    differences_[0] = apart_[0];
    for (size_t i = 1; i < apart_.size(); ++i) differences_[i] = char(apart_[i] - apart_[i - 1] + 128);
    std::string out(raw_.size(), '\0');
    const size_t size =
        libdeflate_zlib_compress(compressor_.get(), differences_.data(), differences_.size(), out.data(), out.size());
    if (size == 0 || size >= raw_.size()) return raw_;
    out.resize(size);
    return out;
  }

 private:
  std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> compressor_;
  std::string raw_, apart_, differences_;
};

}  // namespace

std::string encode_exr_zip(const Imf::Header& header, const PictureView& image, int lines_a_block) {
  std::vector<const PlaneView*> planes;
  for (const PlaneView& plane : image.planes) planes.push_back(&plane);
  std::ranges::sort(planes, {}, [](const PlaneView* plane) { return plane->name; });
  const size_t blocks = size_t((image.height + lines_a_block - 1) / lines_a_block);
  std::vector<std::string> compressed(blocks);
  tbb::enumerable_thread_specific<Block> memory;
  const auto make = [&](size_t i) {
    const int first = int(i) * lines_a_block;
    compressed[i] = memory.local().compress(image, planes, first, std::min(first + lines_a_block, image.height));
  };
  if (file_threads())
    tbb::parallel_for(size_t(0), blocks, make);
  else
    for (size_t i = 0; i < blocks; ++i) make(i);

  std::string bytes;
  append(bytes, uint32_t(20000630));
  append(bytes, uint32_t(2 | (has_long_names(header, image) ? 0x400 : 0)));
  {
    StringOutput output(bytes);
    header.writeTo(output);
  }
  size_t size = bytes.size() + blocks * 8;
  for (const std::string& block : compressed) {
    append(bytes, uint64_t(size));
    size += 8 + block.size();
  }
  bytes.reserve(size);
  for (size_t i = 0; i < blocks; ++i) {
    append(bytes, int32_t(image.origin_y + int(i) * lines_a_block));
    append(bytes, int32_t(compressed[i].size()));
    bytes += compressed[i];
  }
  return bytes;
}

}  // namespace candela
