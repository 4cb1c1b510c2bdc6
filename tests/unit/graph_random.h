#pragma once
#include <random>

#include "graph/builder.h"

// Graphs from a seed: every kind of resource and access, chains, rewrites, readers that nobody needs.
namespace candela::test {

class RandomGraph {
 public:
  explicit RandomGraph(uint32_t seed) : random_(seed) {
    for (int i = 0; i < 2; ++i)
      buffers_.push_back({builder_.import_buffer({.name = fmt::format("import{}", i), .size_bytes = 64}), true, false});
    const int passes = 3 + below(14);
    for (int i = 0; i < passes; ++i) add_pass(i);
    for (const Image& image : images_)
      if (image.handle.version > 0 && below(5) == 0) builder_.sink(image.handle);
    for (const Buffer& buffer : buffers_)
      if (buffer.handle.version > 0 && (buffer.readback || below(4) == 0)) builder_.sink(buffer.handle);
  }
  const GraphBuilder& builder() const { return builder_; }

 private:
  struct Image {
    ImageHandle handle;
    bool depth;
    uint32_t samples;
  };
  struct Buffer {
    BufferHandle handle;
    bool imported, readback;
    bool zeroed = false;
  };

  int below(int limit) { return int(random_() % uint32_t(limit)); }
  Access pick(std::initializer_list<Access> accesses) { return accesses.begin()[below(int(accesses.size()))]; }

  void create(int pass) {
    if (below(2)) {
      const bool depth = below(3) == 0;
      const uint32_t samples = below(3) ? 1 : 4;
      const VkFormat format = depth      ? VK_FORMAT_D32_SFLOAT
                              : below(2) ? VK_FORMAT_R16G16B16A16_SFLOAT
                                         : VK_FORMAT_R8_UNORM;
      images_.push_back({builder_.create(ImageDesc{.name = fmt::format("image{}.{}", pass, images_.size()),
                                                   .format = format,
                                                   .width_px = 16u << below(3),
                                                   .height_px = 16,
                                                   .samples = samples}),
                         depth, samples});
      write(images_.back());
    } else {
      const bool zeroed = below(3) == 0, readback = below(4) == 0;
      buffers_.push_back(
          {builder_.create(BufferDesc{.name = fmt::format("buffer{}.{}", pass, buffers_.size()),
                                      .size_bytes = 256,
                                      .memory = readback ? BufferMemory::host_read : BufferMemory::device,
                                      .zeroed = zeroed}),
           false, readback, zeroed});
      if (!zeroed || below(2)) write(buffers_.back());
    }
  }
  void write(Image& image) {
    Access access = image.depth
                        ? pick({Access::depth_attachment, Access::depth_attachment, Access::transfer_destination})
                        : pick({Access::color_attachment, Access::storage_image_write, Access::transfer_destination,
                                Access::resolve_attachment, Access::storage_image_read_write});
    if (access == Access::resolve_attachment && image.samples != 1) access = Access::color_attachment;
    if (access == Access::storage_image_read_write && image.handle.version == 0) access = Access::storage_image_write;
    image.handle = builder_.write(image.handle, access);
  }
  void write(Buffer& buffer) {
    buffer.handle = builder_.write(buffer.handle,
                                   pick({Access::compute_write, Access::fragment_write, Access::transfer_destination}));
  }
  void read(const Image& image) {
    const bool sampled = below(2) == 0;
    if (!image.depth) {
      builder_.read(image.handle, pick({Access::sampled_fragment, Access::sampled_compute, Access::transfer_source}),
                    "image");
      return;
    }
    builder_.read(image.handle, sampled ? Access::sampled_fragment : Access::depth_test, "depth");
    if (below(2)) builder_.read(image.handle, sampled ? Access::depth_test : Access::sampled_compute, "depth");
  }
  void read(const Buffer& buffer) {
    builder_.read(buffer.handle,
                  pick({Access::vertex_read, Access::fragment_read, Access::graphics_read, Access::compute_read,
                        Access::index_read, Access::indirect_read, Access::transfer_source}),
                  "buffer");
  }
  void add_pass(int index) {
    builder_.begin_pass(fmt::format("pass{}", index));
    const size_t old_images = images_.size(), old_buffers = buffers_.size();
    for (size_t i = 0; i < old_images; ++i) {
      const int what = below(5);
      if (what == 0 && images_[i].handle.version > 0) read(images_[i]);
      if (what == 1 && below(2)) write(images_[i]);
    }
    for (size_t i = 0; i < old_buffers; ++i) {
      const int what = below(6);
      Buffer& buffer = buffers_[i];
      if (what < 2 && (buffer.imported || buffer.zeroed || buffer.handle.version > 0)) read(buffer);
      if (what > 0 && what < 3 && !buffer.imported) write(buffer);  // 1: read and written
    }
    for (int i = below(3); i >= 0; --i) create(index);
    builder_.end_pass({});
  }

  std::mt19937 random_;
  GraphBuilder builder_;
  std::vector<Image> images_;
  std::vector<Buffer> buffers_;
};

}  // namespace candela::test
