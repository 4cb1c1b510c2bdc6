#pragma once
#include <random>

#include "graph/builder.h"
#include "graph/queues.h"

// Graphs from a seed: every kind of resource and access, chains, rewrites, readers that nobody needs.
namespace candela::test {

class RandomGraph {
 public:
  // queues: 2 marks about half of the passes for the compute queue.
  explicit RandomGraph(uint32_t seed, int queues = 1) : random_(seed), queues_(queues) {
    for (int i = 0; i < 2; ++i)
      buffers_.push_back({builder_.import_buffer({.name = fmt::format("import{}", i), .size_bytes = 64}), true, false});
    for (int i = below(3); i > 0; --i) {
      ImageDesc desc{.name = fmt::format("kept{}", i),
                     .format = below(2) ? VK_FORMAT_R16G16B16A16_SFLOAT : VK_FORMAT_D32_SFLOAT,
                     .width_px = 16,
                     .height_px = 16};
      choose_shape(desc);
      filled_.push_back({builder_.import_image(desc), is_depth_format(desc.format), 1, desc});
      filled_.back().holds.assign(filled_.back().holds.size(), true);
    }
    const int passes = 3 + below(14);
    for (int i = 0; i < passes; ++i) add_pass(i);
    for (const Image& image : images_)
      if (image.handle.version > 0 && below(5) == 0) builder_.sink(image.handle);
    for (const Buffer& buffer : buffers_)
      if (buffer.handle.version > 0 && (buffer.readback || below(4) == 0)) builder_.sink(buffer.handle);
  }
  const GraphBuilder& builder() const { return builder_; }
  CompiledGraph compiled() const { return compile_graph(builder_, kept_); }  // images are filled for later frames

 private:
  struct Image {
    ImageHandle handle;
    bool depth;
    uint32_t samples;
    ImageDesc desc{};
    std::vector<bool> holds = std::vector<bool>(size_t(desc.mips) * desc.layers, false);
    bool has(const ImageRange& range) const { return count(range) == size_t(range.mip_count) * range.layer_count; }
    bool has_any(const ImageRange& range) const { return count(range) > 0; }

   private:
    size_t count(const ImageRange& range) const {
      size_t result = 0;
      for_subresources(range, desc.layers, [&](size_t i) { result += holds[i]; });
      return result;
    }
  };
  struct Buffer {
    BufferHandle handle;
    bool imported, readback;
    bool zeroed = false;
  };

  int below(int limit) { return int(random_() % uint32_t(limit)); }
  // What the queue of the open pass cannot do becomes what it can.
  Access on_queue(Access access, Access otherwise) const {
    return compute_ && (access_info(access).stages & stages_of(Queue::compute)) == 0 ? otherwise : access;
  }
  Access pick(std::initializer_list<Access> accesses) { return accesses.begin()[below(int(accesses.size()))]; }

  void create(int pass) {
    if (below(8) == 0) {
      fill_kept(pass);
    } else if (below(2)) {
      const bool depth = below(3) == 0;
      const uint32_t samples = below(3) ? 1 : 4;
      ImageDesc desc{.name = fmt::format("image{}.{}", pass, images_.size()),
                     .format = depth      ? VK_FORMAT_D32_SFLOAT
                               : below(2) ? VK_FORMAT_R16G16B16A16_SFLOAT
                                          : VK_FORMAT_R8_UNORM,
                     .width_px = 16u << below(3),
                     .height_px = 16,
                     .samples = samples};
      if (samples == 1) choose_shape(desc);
      const ImageHandle handle = builder_.create(desc);
      images_.push_back({handle, depth, samples, desc});
      write(images_.back());
    } else {
      const bool zeroed = below(3) == 0, readback = below(4) == 0;
      buffers_.push_back(
          {builder_.create(BufferDesc{.name = fmt::format("buffer{}.{}", pass, buffers_.size()),
                                      .size_bytes = below(2) ? 256u : 1u << (16 + below(4)),
                                      .memory = readback ? BufferMemory::host_read : BufferMemory::device,
                                      .zeroed = zeroed}),
           false, readback, zeroed});
      if (!zeroed || below(2)) write(buffers_.back());
    }
  }
  // Whole, in one pass or in steps; what comes later reads it.
  void fill_kept(int pass) {
    const bool depth = !compute_ && below(2);
    ImageDesc desc{.name = fmt::format("kept{}.{}", pass, filled_.size()),
                   .format = depth ? VK_FORMAT_D32_SFLOAT : VK_FORMAT_R16G16B16A16_SFLOAT,
                   .width_px = 16,
                   .height_px = 16};
    choose_shape(desc);
    ImageHandle handle = builder_.create(desc);
    const bool drawn = !compute_ && desc.kind != ImageKind::d3 && below(2);
    Access access = depth ? Access::depth_attachment : drawn ? Access::color_attachment : Access::storage_image_write;
    for (uint32_t mip = 0; mip < desc.mips; ++mip) {
      if (depth || drawn || below(2))
        for (uint32_t layer = 0; layer < desc.layers; ++layer)
          handle = builder_.write(handle, access, ImageRange::layer(layer, mip));
      else
        handle = builder_.write(handle, access, ImageRange::mip(mip));
    }
    used_.push_back({handle.resource, {0, desc.mips, 0, desc.layers}});
    to_keep_.push_back(handle);
    filled_.push_back({handle, depth, 1, desc});
    filled_.back().holds.assign(filled_.back().holds.size(), true);
  }
  void choose_shape(ImageDesc& desc) {
    if (below(2)) desc.mips = 1 + uint32_t(below(4));
    const int shape = below(8);
    if (shape == 0) desc.kind = ImageKind::d2_array, desc.layers = 1 + uint32_t(below(3));
    if (shape == 1) desc.kind = ImageKind::cube, desc.layers = 6, desc.width_px = 16;
    if (shape == 2 && !is_depth_format(desc.format)) desc.kind = ImageKind::d3, desc.depth_px = 4;
  }
  uint32_t some(uint32_t end) { return uint32_t(below(int(end))); }
  ImageRange range_of(const Image& image, bool one_mip) {
    const ImageDesc& d = image.desc;
    ImageRange range{0, d.mips, 0, d.layers};
    if (one_mip || below(2)) range.first_mip = some(d.mips), range.mip_count = 1;
    if (!one_mip && below(2)) range.mip_count = 1 + some(d.mips - range.first_mip);
    if (below(2)) range.first_layer = some(d.layers), range.layer_count = 1 + some(d.layers - range.first_layer);
    return range;
  }
  void write(Image& image) {
    Access access = image.depth
                        ? pick({Access::depth_attachment, Access::depth_attachment, Access::transfer_destination})
                        : pick({Access::color_attachment, Access::storage_image_write, Access::transfer_destination,
                                Access::resolve_attachment, Access::storage_image_read_write});
    if (compute_ && image.depth) return;
    access = on_queue(access, Access::storage_image_write);
    const ImageRange range = range_of(image, access != Access::transfer_destination);
    const bool volume = image.desc.kind == ImageKind::d3;
    if (access == Access::resolve_attachment && image.samples != 1) access = Access::color_attachment;
    if (access == Access::storage_image_read_write && !image.has(range)) access = Access::storage_image_write;
    const bool drawn = access == Access::color_attachment || access == Access::depth_attachment ||
                       access == Access::resolve_attachment;
    if (drawn && (volume || (image.has_any(range) && !image.has(range)))) access = Access::transfer_destination;
    if (taken(image, range)) return;
    image.handle = builder_.write(image.handle, access, range);
    for_subresources(range, image.desc.layers, [&](size_t i) { image.holds[i] = true; });
    used_.push_back({image.handle.resource, range});
  }
  // Used in this step already: another use may want another layout or order.
  bool taken(const Image& image, const ImageRange& range) const {
    return std::any_of(used_.begin(), used_.end(), [&](const auto& used) {
      return used.first == image.handle.resource && used.second.overlaps(range);
    });
  }
  void write(Buffer& buffer) {
    const Access access = pick({Access::compute_write, Access::fragment_write, Access::transfer_destination});
    buffer.handle = builder_.write(buffer.handle, on_queue(access, Access::compute_write));
  }
  void read(const Image& image) {
    const bool sampled = below(2) == 0;
    const ImageRange range = range_of(image, image.depth && !sampled);
    if (!image.has(range) || taken(image, range)) return;
    used_.push_back({image.handle.resource, range});
    if (!image.depth) {
      Access access = pick(
          {Access::sampled_fragment, Access::sampled_compute, Access::transfer_source, Access::storage_image_read});
      if (access == Access::storage_image_read && range.mip_count != 1) access = Access::sampled_compute;
      builder_.read(image.handle, on_queue(access, Access::sampled_compute), "image", range);
      return;
    }
    if (compute_) {
      builder_.read(image.handle, Access::sampled_compute, "depth", range);
      return;
    }
    builder_.read(image.handle, sampled ? Access::sampled_fragment : Access::depth_test, "depth", range);
    if (below(2) && range.mip_count == 1)
      builder_.read(image.handle, sampled ? Access::depth_test : Access::sampled_compute, "depth", range);
  }
  void read(const Buffer& buffer) {
    const Access access = pick({Access::vertex_read, Access::fragment_read, Access::graphics_read, Access::compute_read,
                                Access::index_read, Access::indirect_read, Access::transfer_source});
    builder_.read(buffer.handle, on_queue(access, Access::compute_read), "buffer");
  }
  // Steps go over all images again, so they read and write what the steps before made.
  void add_pass(int index) {
    compute_ = queues_ > 1 && below(2) == 0;
    builder_.begin_pass(fmt::format("pass{}", index), compute_ ? Queue::compute : Queue::main);
    used_.clear();
    const size_t old_buffers = buffers_.size();
    const int steps = below(4) == 0 ? 1 + below(4) : 0;
    for (int step = 0; step < std::max(steps, 1); ++step) {
      if (steps > 0) builder_.begin_step();
      used_.clear();
      for (size_t i = images_.size(); i-- > 0;) {
        const int what = below(5);
        if (what == 0) read(images_[i]);
        if (what == 1 && below(2)) write(images_[i]);
        if (what == 2 && below(4) == 0) read(images_[i]), write(images_[i]);
      }
      for (const Image& image : filled_)
        if (below(4) == 0) read(image);
      for (size_t i = 0; i < old_buffers; ++i) {
        const int what = below(6);
        Buffer& buffer = buffers_[i];
        if (what < 2 && (buffer.imported || buffer.zeroed || buffer.handle.version > 0)) read(buffer);
        if (what > 0 && what < 3 && !buffer.imported) write(buffer);  // 1: read and written
      }
      if (step + 1 == std::max(steps, 1))
        for (int i = below(3); i >= 0; --i) create(index);
    }
    builder_.end_pass({});
    for (const ImageHandle image : to_keep_) {
      const Hash128 key{uint64_t(image.resource), 0};
      builder_.keep(image, key, "kept");
      kept_.seen.insert(key);
    }
    to_keep_.clear();
  }

  std::mt19937 random_;
  int queues_ = 1;
  bool compute_ = false;  // the open pass is of the compute queue
  GraphBuilder builder_;
  std::vector<Image> images_;
  std::vector<Image> filled_;         // imported, or to be
  std::vector<ImageHandle> to_keep_;  // of the open pass
  KeptKeys kept_;
  std::vector<Buffer> buffers_;
  std::vector<std::pair<int, ImageRange>> used_;  // by the step that is being declared
};

}  // namespace candela::test
