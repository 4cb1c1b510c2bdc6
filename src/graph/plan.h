#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/hash.h"
#include "graph/access.h"
#include "graph/handle.h"
#include "graph/image_range.h"
#include "graph/picture_parts.h"
#include "graph/pipeline_desc.h"

namespace candela {

struct ImageDesc {
  std::string name;
  VkFormat format = VK_FORMAT_UNDEFINED;
  uint32_t width_px = 0, height_px = 0, samples = 1;
  std::array<float, 4> clear{0, 0, 0, 0};  // colour, or depth in [0]; integers as floats
  // The passes that write it cover every texel between them before anything reads it: the first finds what was there,
  // and does not clear. While outputs are hashed it does, for a hash may not see what the next pass covers.
  bool covered = false;
  ImageKind kind = ImageKind::d2;
  uint32_t mips = 1, layers = 1;  // a cube has 6 layers, a cube array a multiple of 6
  uint32_t depth_px = 1;          // of a 3D image; halves from mip to mip like width and height
};
enum class BufferMemory : uint8_t { device, host_read };
struct BufferDesc {
  std::string name;
  uint64_t size_bytes = 0;
  BufferMemory memory = BufferMemory::device;
  bool zeroed = false;     // filled with zeros before the frame's first use (counters)
  bool unordered = false;  // scratch whose order depends on how threads arrive; what is made of it does not. Not hashed
  uint64_t row_bytes = 0;  // of each row of the picture's pixels, one after the other; 0: it holds something else
};

struct PlanUse {
  static constexpr int every_step = -1;
  int resource = -1;
  Access access{};
  int version = 0;  // version read, or version made by a write
  bool writes = false;
  ImageRange range{0, 1, 0, 1};    // images: which subresources, in numbers
  ImageKind view = ImageKind::d2;  // images: what the shader or the attachment sees them as
  int step = every_step;           // of the pass: the one that does it
  bool first = false;              // writes: no kept pass wrote any of the range before
  bool in_step(uint32_t s) const { return step == every_step || step == int(s); }
  bool operator==(const PlanUse&) const = default;
};

struct ImageBarrier {
  int resource = -1;
  VkPipelineStageFlags2 source_stages = 0, destination_stages = 0;
  VkAccessFlags2 source_access = 0, destination_access = 0;
  VkImageLayout old_layout = VK_IMAGE_LAYOUT_UNDEFINED, new_layout = VK_IMAGE_LAYOUT_UNDEFINED;
  ImageRange range{0, 1, 0, 1};  // in numbers
};
// At most one vkCmdPipelineBarrier2 a pass, or a step of it: one memory barrier for all buffers and same-layout images,
// and image barriers where a layout changes or aliased memory is taken over.
struct PassBarriers {
  VkPipelineStageFlags2 source_stages = 0, destination_stages = 0;
  VkAccessFlags2 source_access = 0, destination_access = 0;
  std::vector<ImageBarrier> images;
  bool empty() const { return source_stages == 0 && images.empty(); }
};

// A knob's value that a pass works with: "bloom.levels", "5".
struct PlanKnob {
  std::string name, value;
  bool operator==(const PlanKnob&) const = default;
};

enum class Queue : uint8_t { main, compute };
struct PlanPass {
  // Of the instance: the pass's name, and after a point the instance's.
  std::string name;
  std::string_view pass() const { return std::string_view(name).substr(0, name.find('.')); }
  Queue queue = Queue::main;
  int declared = -1;  // index in declaration order: finds the recording closure
  std::vector<PlanUse> uses;
  std::vector<int> pipelines;               // into FramePlan::pipelines
  std::vector<PlanKnob> knobs;              // in the order of their tables
  PassBarriers barriers;                    // before the pass, and so before its first step
  std::vector<PassBarriers> step_barriers;  // before each further step; empty for a pass without steps
  uint32_t steps() const { return 1 + uint32_t(step_barriers.size()); }
  const PassBarriers& barriers_before(uint32_t step) const { return step ? step_barriers[step - 1] : barriers; }
};

// Passes that run on one queue without waiting for the other in between.
struct QueueBatch {
  Queue queue = Queue::main;
  std::vector<int> passes;  // positions in FramePlan::passes, in order
  std::vector<int> waits;   // batches of the other queue that must have ended; they stand before this one
};

enum class Lifetime : uint8_t { scene, frame, readback };  // imported, transient, read by the host
struct PlanResource {
  std::variant<ImageDesc, BufferDesc> desc;
  bool imported = false, to_fill = false;  // to_fill: imported, and this frame makes what is in it
  bool pooled = false;                     // imported; this frame changes parts of it
  bool keyed = false;                      // other frames may find the image, or this one found it
  Lifetime lifetime = Lifetime::frame;
  VkImageUsageFlags image_usage = 0;  // unions over kept passes: pruning narrows usage too
  VkBufferUsageFlags buffer_usage = 0;
  int first_pass = -1, last_pass = -1;  // positions in FramePlan::passes; -1: unused, owns nothing
  int block = -1;                       // what is transient shares memory blocks where lifetimes are disjoint
  uint64_t bytes = 0;                   // estimate: size without padding
  // Where a region alone of the picture is worked on, of an image or buffer of its pixels: those that need memory,
  // where the device can leave the others without (gpu/pages.h). `bytes` is theirs.
  std::optional<PixelRect> resident;
  bool both_queues = false;  // passes of both queues use it
  const std::string& name() const {
    return std::visit([](const auto& d) -> const std::string& { return d.name; }, desc);
  }
  bool is_image() const { return desc.index() == 0; }
};

struct LeftOut {
  std::string pass, reason;
};

using PipelineDesc = std::variant<ComputePipelineDesc, GraphicsPipelineDesc, RayPipelineDesc>;

// What will run, as a value: prints, hashes, and holds no pointer to anything. The recording closures lie beside it.
struct FramePlan {
  std::vector<PlanPass> passes;         // in order
  std::vector<PlanResource> resources;  // by handle.resource; unused ones keep their place
  std::vector<PipelineDesc> pipelines;  // without duplicates, only of kept passes
  std::vector<LeftOut> left_out;
  std::vector<uint64_t> block_bytes;  // estimate for each memory block
  PassBarriers final_barriers;        // after the last pass: host reads
  std::optional<PictureParts> parts;  // what passes work on of the picture; absent: all of it
  std::vector<QueueBatch> batches;    // empty: one queue, all passes in order
};

std::vector<PlanKnob> plan_knobs(const FramePlan& plan);  // of all kept passes, each once, by first use
uint64_t transient_bytes(const FramePlan& plan);          // with aliasing
uint64_t transient_bytes_unaliased(const FramePlan& plan);
// With aliasing, on a device that cannot leave parts of images without memory.
uint64_t transient_bytes_whole(const FramePlan& plan);
uint64_t whole_bytes(const PlanResource& resource);
Hash128 plan_hash(const FramePlan& plan);      // of passes, uses, pipelines, sizes, knobs: what timings depend on
std::string plan_text(const FramePlan& plan);  // what runs, what was left out and why, each image's memory
std::string plan_json(const FramePlan& plan);
std::string plan_dot(const FramePlan& plan);          // Graphviz; left-out passes dimmed
std::string image_size_text(const ImageDesc& image);  // "64x64", "64x64 cube, 7 mips"
uint32_t format_bytes(VkFormat format);               // of one texel; CHECKs on a format the project does not use

}  // namespace candela
