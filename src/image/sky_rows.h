#pragma once
#include <functional>
#include <string>
#include <vector>

#include "base/files.h"
#include "image/io.h"

// Skies by rows: what a file of any size takes is a strip of its rows and the image that is made of them.
namespace candela {

// Skies are made into images of at most this width and half this height: a texel is 0.044 degrees, a pixel of a picture
// of 1,080 lines that is 47 degrees high.
inline constexpr int most_sky_width = 8192;

// Red, green, blue and 1 of a row of the strip at hand; called by several threads.
using SkyRow = std::function<void(int row, float* texels)>;
class SkyRowSink {
 public:
  virtual ~SkyRowSink() = default;
  virtual Expected<void> begin(const ImageInfo& info) = 0;
  virtual void add(int first, int count, const SkyRow& row) = 0;  // rows counted from the top
};
Expected<void> read_exr_rows(const FileReader& file, const std::string& place, SkyRowSink& sink);
Expected<void> read_hdr_rows(const FileReader& file, const std::string& place, SkyRowSink& sink);

// Rows as an image: themselves, or of larger ones means weighed by solid angle over the least whole number of texels
// that makes them small enough, so that the light of the sky stays what it is. Where sides are no multiples of that
// number, texels count by how much of them is covered. Values are made usable first (usable_texel).
class SkyMeans : public SkyRowSink {
 public:
  SkyMeans(std::string place, uint64_t before_bytes) : place_(std::move(place)), before_bytes_(before_bytes) {}
  Expected<void> begin(const ImageInfo& info) override;
  void add(int first, int count, const SkyRow& row) override;
  DecodedImage finish(std::vector<std::string>& warnings);

 private:
  struct Counts {
    size_t nonfinite = 0, negative = 0;
  };
  void add_to(int target, int first, int count, const SkyRow& row);
  double solid_angle(double top, double bottom) const;  // between rows, of the whole circle

  std::string place_;
  uint64_t before_bytes_;
  ImageInfo info_;
  int times_ = 1;  // texels each way that one is made of
  DecodedImage image_;
  std::vector<Counts> counts_;  // of the rows of the image
};

// One infinite or NaN texel would spread over the whole frame by filtering; light cannot be negative.
struct TexelFaults {
  bool nonfinite = false, negative = false;
};
TexelFaults usable_texel(float* texel);
void warn_of_faults(size_t nonfinite, size_t negative, const std::string& place, std::vector<std::string>& warnings);

// What a sky of this size takes decoded: skies wider than 4096 as floats and as half floats, others with their levels.
uint64_t sky_bytes(int width, int height);

}  // namespace candela
