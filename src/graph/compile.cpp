#include <bit>

#include "base/check.h"
#include "graph/builder.h"
#include "graph/queues.h"

namespace candela {
namespace {

// Versions can only be made in the order of declaration, so a cycle would show here as a read of a version that comes
// later.
void validate(const GraphBuilder& builder) {
  if (builder.is_open()) throw GraphError(fmt::format("pass '{}' was not ended", builder.passes().back().name));
  std::vector<int> made(builder.resources().size(), 0);
  for (const GraphBuilder::Pass& pass : builder.passes()) {
    for (const PlanUse& use : pass.uses) {
      const int expected = use.writes ? use.version - 1 : use.version;
      if (made[use.resource] != expected)
        throw GraphError(fmt::format("pass '{}' uses version {} of '{}', but version {} is the newest there", pass.name,
                                     expected, builder.resources()[use.resource].name(), made[use.resource]));
      if (use.writes) made[use.resource] = use.version;
    }
  }
}

// Declaration order is topological, and stable: the frame runs as it reads.
void order(const GraphBuilder& builder, const std::vector<bool>& kept, CompiledGraph& graph) {
  std::vector<int> merged(builder.pipelines().size(), -1);
  for (size_t i = 0; i < kept.size(); ++i) {
    if (!kept[i]) continue;
    const GraphBuilder::Pass& pass = builder.passes()[i];
    PlanPass planned{
        .name = pass.name, .queue = pass.queue, .declared = int(i), .uses = pass.uses, .knobs = pass.knobs};
    planned.step_barriers.resize(size_t(std::max(pass.steps, 1)) - 1);
    for (const int pipeline : pass.pipelines) {
      if (merged[pipeline] < 0) {
        merged[pipeline] = int(graph.plan.pipelines.size());
        graph.plan.pipelines.push_back(builder.pipelines()[pipeline]);
      }
      planned.pipelines.push_back(merged[pipeline]);
    }
    graph.plan.passes.push_back(std::move(planned));
    graph.record.push_back(pass.record);
  }
}

uint64_t size_bytes(const ImageDesc& image) {
  uint64_t texels = 0;
  for (uint32_t mip = 0; mip < image.mips; ++mip)
    texels += uint64_t(mip_size(image.width_px, mip)) * mip_size(image.height_px, mip) * mip_size(image.depth_px, mip);
  return texels * image.layers * image.samples * format_bytes(image.format);
}
uint64_t size_bytes(const BufferDesc& buffer) { return buffer.size_bytes; }

constexpr uint64_t page_bytes = 64 << 10;

uint64_t pages_of(const ImageDesc& image, const PixelRect& part) {
  const int bits = std::bit_width(page_bytes / (uint64_t(image.samples) * format_bytes(image.format))) - 1;
  const int width = 1 << (bits + 1) / 2, height = 1 << bits / 2;  // Vulkan's standard shapes of pages
  const auto count = [](int first, int end, int side) { return uint64_t((end + side - 1) / side - first / side); };
  return count(part.x, part.end_x(), width) * count(part.y, part.end_y(), height) * page_bytes;
}
uint64_t pages_of(const BufferDesc& buffer, const PixelRect& part) {
  return (uint64_t(part.height) * buffer.row_bytes + page_bytes - 1) / page_bytes * page_bytes;
}
bool is_of_picture(const ImageDesc& image, const PictureParts& parts) {
  return image.width_px == uint32_t(parts.width_px) && image.height_px == uint32_t(parts.height_px) &&
         image.kind == ImageKind::d2 && image.mips == 1 && image.layers == 1;
}
bool is_of_picture(const BufferDesc& buffer, const PictureParts&) { return buffer.row_bytes > 0; }

// Where pages save at least half of it.
void find_resident(const PictureParts& parts, PlanResource& resource) {
  if (resource.lifetime != Lifetime::frame) return;
  std::visit(
      [&](const auto& desc) {
        if (!is_of_picture(desc, parts)) return;
        const uint64_t bytes = pages_of(desc, parts.seen);
        if (2 * bytes > resource.bytes) return;
        resource.bytes = bytes;
        resource.resident = parts.seen;
      },
      resource.desc);
}

Lifetime lifetime_of(const PlanResource& resource) {
  if (resource.imported) return Lifetime::scene;
  const auto* buffer = std::get_if<BufferDesc>(&resource.desc);
  return buffer && buffer->memory == BufferMemory::host_read ? Lifetime::readback : Lifetime::frame;
}

// Who writes first, of the passes that are kept: their attachments clear.
void mark_first_writes(FramePlan& plan) {
  std::vector<std::vector<bool>> written(plan.resources.size());
  for (PlanPass& pass : plan.passes)
    for (PlanUse& use : pass.uses) {
      if (!use.writes) continue;
      const auto* image = std::get_if<ImageDesc>(&plan.resources[use.resource].desc);
      std::vector<bool>& own = written[use.resource];
      own.resize(image ? size_t(image->mips) * image->layers : 1, false);
      use.first = true;
      for_subresources(use.range, image ? image->layers : 1, [&](size_t i) {
        if (own[i]) use.first = false;
        own[i] = true;
      });
    }
}

void make_physical(const GraphBuilder& builder, const KeptKeys& kept, FramePlan& plan) {
  for (const GraphBuilder::Resource& resource : builder.resources()) {
    PlanResource planned{.desc = resource.desc,
                         .imported = resource.imported,
                         .to_fill = resource.to_fill,
                         .keyed = resource.key.has_value()};
    if (resource.key) {
      planned.to_fill = kept.seen.contains(*resource.key);
      planned.imported = planned.to_fill || kept.filled.contains(*resource.key);
    }
    if (resource.pooled && kept.pool) {
      auto& image = std::get<ImageDesc>(planned.desc);
      image.width_px = image.height_px = kept.pool->size_px;
      image.layers = kept.pool->layers;
      planned.imported = planned.pooled = true;
      planned.to_fill = !kept.pool->filled;
    }
    planned.lifetime = lifetime_of(planned);
    plan.resources.push_back(std::move(planned));
  }
  for (size_t pass = 0; pass < plan.passes.size(); ++pass) {
    for (PlanUse& use : plan.passes[pass].uses) {
      PlanResource& resource = plan.resources[use.resource];
      if (resource.pooled) {
        if (use.range.layer_count != std::get<ImageDesc>(builder.resources()[size_t(use.resource)].desc).layers)
          throw GraphError(fmt::format("pass '{}' uses some layers of '{}', which is pooled", plan.passes[pass].name,
                                       resource.name()));
        use.range.layer_count = kept.pool->layers;
      }
      const AccessInfo& info = access_info(use.access);
      if (resource.is_image())
        resource.image_usage |= info.image_usage;
      else
        resource.buffer_usage |= info.buffer_usage;
      if (resource.first_pass < 0) resource.first_pass = int(pass);
      resource.last_pass = int(pass);
    }
  }
  // What the frame is for outlives its last pass.
  for (const int sink : builder.sinks())
    if (plan.resources[sink].first_pass >= 0) plan.resources[sink].last_pass = int(plan.passes.size()) - 1;
  for (PlanResource& resource : plan.resources) {
    if (resource.first_pass < 0) continue;
    resource.bytes = whole_bytes(resource);
    if (plan.parts) find_resident(*plan.parts, resource);
    const auto* buffer = std::get_if<BufferDesc>(&resource.desc);
    if (buffer && buffer->zeroed && !resource.imported) resource.buffer_usage |= VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  }
}

}  // namespace

uint64_t whole_bytes(const PlanResource& resource) {
  return std::visit([](const auto& desc) { return size_bytes(desc); }, resource.desc);
}

CompiledGraph compile_graph(const GraphBuilder& builder, const KeptKeys& keys) {
  validate(builder);
  CompiledGraph graph;
  graph.plan.left_out = builder.left_out();
  graph.plan.parts = builder.picture_parts();
  const std::vector<bool> kept = prune(builder, graph.plan.left_out, keys);
  order(builder, kept, graph);
  make_physical(builder, keys, graph.plan);
  mark_first_writes(graph.plan);
  place_batches(graph.plan);
  alias_memory(graph.plan);
  place_barriers(graph.plan);
  for (size_t r = 0; r < builder.resources().size(); ++r)
    if (const auto& key = builder.resources()[r].key) graph.keys.emplace_back(int(r), *key);
  graph.hash = plan_hash(graph.plan);
  return graph;
}

}  // namespace candela
