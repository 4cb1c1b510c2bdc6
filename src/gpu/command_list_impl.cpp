#include "gpu/command_list_impl.h"

#include <algorithm>

#include "base/check.h"
#include "gpu/image_copy.h"
#include "graph/access.h"
#include "graph/formats.h"

namespace candela::gpu {

void record_barriers(const FrameContext& frame, const PassBarriers& barriers, VkCommandBuffer commands) {
  if (barriers.empty()) return;
  VkMemoryBarrier2 memory{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
  memory.srcStageMask = barriers.source_stages;
  memory.srcAccessMask = barriers.source_access;
  memory.dstStageMask = barriers.destination_stages;
  memory.dstAccessMask = barriers.destination_access;
  std::vector<VkImageMemoryBarrier2>& images = frame.barriers;
  images.clear();
  for (const ImageBarrier& b : barriers.images) {
    VkImageMemoryBarrier2 image{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2};
    // The first use in a frame waits for the frame before alone.
    image.srcStageMask = b.source_stages || !frame.after_another ? b.source_stages : b.destination_stages;
    image.srcAccessMask = b.source_access;
    image.dstStageMask = b.destination_stages;
    image.dstAccessMask = b.destination_access;
    image.oldLayout = b.old_layout;
    image.newLayout = b.new_layout;
    image.srcQueueFamilyIndex = image.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    image.image = frame.image(b.resource).image;
    image.subresourceRange = subresources(frame.image(b.resource), b.range);
    images.push_back(image);
  }
  VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  info.memoryBarrierCount = barriers.source_stages || barriers.destination_stages ? 1 : 0;
  info.pMemoryBarriers = &memory;
  info.imageMemoryBarrierCount = uint32_t(images.size());
  info.pImageMemoryBarriers = images.data();
  vkCmdPipelineBarrier2(commands, &info);
}

void record_steps(const FrameContext& frame, size_t pass, const RecordFunction& record, VkCommandBuffer commands) {
  const PlanPass& planned = frame.plan.passes[pass];
  for (uint32_t step = 0; step < planned.steps(); ++step) {
    record_barriers(frame, planned.barriers_before(step), commands);
    CommandListImpl list(frame, pass, step, commands);
    record(list);
    CHECK_MSG(!list.rendering(), fmt::format("pass '{}' does not end its rendering", planned.name));
  }
}

CommandListImpl::CommandListImpl(const FrameContext& frame, size_t pass, uint32_t step, VkCommandBuffer commands)
    : frame_(frame),
      pass_(frame.plan.passes[pass]),
      step_(step),
      images_(frame.physical.step_images(frame.slot, pass, step)),
      commands_(commands) {
  bind_sets(VK_PIPELINE_BIND_POINT_COMPUTE);
  if (pass_.queue == Queue::main) bind_sets(VK_PIPELINE_BIND_POINT_GRAPHICS);
}

const PlanUse& CommandListImpl::use_of(const Wanted& wanted, std::initializer_list<Access> accesses) const {
  const bool known = wanted.resource >= 0 && size_t(wanted.resource) < frame_.plan.resources.size();
  const PlanResource* resource = known ? &frame_.plan.resources[size_t(wanted.resource)] : nullptr;
  ImageRange range = wanted.range;
  if (const auto* image = resource ? std::get_if<ImageDesc>(&resource->desc) : nullptr; image && !range.is_default())
    range = resolved(range, *image);
  // A pass that writes a resource part by part holds the handle of the last version, so any version it knows will do.
  bool version_known = false;
  const PlanUse* found = nullptr;
  bool several = false;
  for (const PlanUse& use : pass_.uses) {
    if (use.resource != wanted.resource) continue;
    version_known |= use.version == wanted.version;
    if (!use.in_step(step_) || std::find(accesses.begin(), accesses.end(), use.access) == accesses.end()) continue;
    if (!range.is_default() && range != use.range) continue;
    if (wanted.view && *wanted.view != use.view) continue;
    several |= found && (found->range != use.range || found->view != use.view);
    if (!found) found = &use;
  }
  const auto name = [&] { return resource ? resource->name() : "an empty handle"; };
  CHECK_MSG(!found || !several,
            fmt::format("pass '{}' declared several parts of '{}'; give range and view", pass_.name, name()));
  if (found && version_known) return *found;
  std::string as;
  for (const Access access : accesses) as += (as.empty() ? "" : " or ") + std::string(access_info(access).name);
  const auto* image = resource ? std::get_if<ImageDesc>(&resource->desc) : nullptr;
  CHECK_MSG(false, fmt::format("pass '{}' uses version {} of '{}{}' without having declared it as {}{}", pass_.name,
                               wanted.version, name(), image && !range.is_default() ? range_text(range, *image) : "",
                               as, pass_.steps() > 1 ? fmt::format(" in step {}", step_) : ""));
  return pass_.uses.front();
}

const ImageDesc& CommandListImpl::desc_of(int resource) const {
  return std::get<ImageDesc>(frame_.plan.resources[size_t(resource)].desc);
}

const Buffer& CommandListImpl::buffer(int resource) const {
  const Buffer* buffer = frame_.buffers[size_t(resource)];
  CHECK_MSG(buffer && *buffer, frame_.plan.resources[size_t(resource)].name());
  return *buffer;
}

uint32_t CommandListImpl::sampled(ImageHandle image, ImageRange range, View view) {
  return images_.sampled.at(view_key(
      use_of(image, {Access::sampled_fragment, Access::sampled_compute, Access::sampled_graphics}, range, view)));
}

uint32_t CommandListImpl::storage(ImageHandle image, ImageRange range, View view) {
  return images_.storage.at(view_key(
      use_of(image, {Access::storage_image_write, Access::storage_image_read_write, Access::storage_image_read}, range,
             view)));
}

uint64_t CommandListImpl::address(BufferHandle handle) {
  use_of(handle, {Access::vertex_read, Access::fragment_read, Access::graphics_read, Access::compute_read,
                  Access::compute_write, Access::fragment_write, Access::rays_read, Access::rays_write});
  const uint64_t address = buffer(handle.resource).address();
  CHECK_MSG(address != 0, frame_.plan.resources[size_t(handle.resource)].name());
  return address;
}

glm::uvec2 CommandListImpl::size(ImageHandle image, uint32_t mip) { return size_3d(image, mip); }

glm::uvec3 CommandListImpl::size_3d(ImageHandle image, uint32_t mip) {
  const bool used = std::any_of(pass_.uses.begin(), pass_.uses.end(),
                                [&](const PlanUse& use) { return use.resource == image.resource; });
  CHECK_MSG(used, fmt::format("pass '{}' asks for the size of an image that it did not declare", pass_.name));
  const VkExtent3D extent = mip_extent(desc_of(image.resource), mip);
  CHECK_MSG(mip < desc_of(image.resource).mips, pass_.name);
  return {extent.width, extent.height, extent.depth};
}

void CommandListImpl::bind(PipelineHandle pipeline) {
  CHECK_MSG(pipeline && size_t(pipeline.index) < pass_.pipelines.size(),
            fmt::format("pass '{}' binds a pipeline that it did not declare", pass_.name));
  bound_ = frame_.pipelines[size_t(pass_.pipelines[size_t(pipeline.index)])];
  vkCmdBindPipeline(commands_, bound_->bind_point, bound_->handle);
  if (bound_->table) bind_sets(bound_->bind_point);
}

void CommandListImpl::bind_sets(VkPipelineBindPoint point) {
  const VkDescriptorSet sets[] = {frame_.bindless.set(), images_.set};
  vkCmdBindDescriptorSets(commands_, point, frame_.bindless.layout(), 0, 2, sets, 0, nullptr);
}

void CommandListImpl::push_bytes(const void* data, uint32_t bytes) {
  CHECK_MSG(bytes % 4 == 0 && bytes > 0 && bytes <= 128, pass_.name);
  vkCmdPushConstants(commands_, frame_.bindless.layout(), VK_SHADER_STAGE_ALL, 0, bytes, data);
}

void CommandListImpl::dispatch(uint32_t threads_x, uint32_t threads_y, uint32_t threads_z) {
  CHECK_MSG(bound_ && bound_->bind_point == VK_PIPELINE_BIND_POINT_COMPUTE && !rendering_, pass_.name);
  if (threads_x == 0 || threads_y == 0 || threads_z == 0) return;
  const auto groups = [](uint32_t threads, uint32_t size) { return threads / size + (threads % size != 0); };
  const auto& size = bound_->workgroup;
  const std::array<uint32_t, 3> count{groups(threads_x, size[0]), groups(threads_y, size[1]),
                                      groups(threads_z, size[2])};
  for (size_t i = 0; i < 3; ++i)
    CHECK_MSG(count[i] <= frame_.max_groups[i], fmt::format("pass '{}' dispatches {} groups, the device takes {}",
                                                            pass_.name, count[i], frame_.max_groups[i]));
  vkCmdDispatch(commands_, count[0], count[1], count[2]);
}

void CommandListImpl::dispatch_picture(uint32_t threads_x, uint32_t threads_y, PicturePart part, uint32_t texel_px) {
  if (!frame_.plan.parts) return dispatch(threads_x, threads_y, 1);
  CHECK_MSG(bound_ && bound_->bind_point == VK_PIPELINE_BIND_POINT_COMPUTE && !rendering_, pass_.name);
  const PixelRect& rect = frame_.plan.parts->of(part);
  const auto range = [&](int first_px, int end_px, uint32_t threads, uint32_t size) {
    const uint32_t first = uint32_t(first_px) / texel_px / size;
    const uint32_t end = std::min((uint32_t(end_px) + texel_px - 1) / texel_px, threads);
    return std::pair(first, (end + size - 1) / size - first);
  };
  const auto [x, across] = range(rect.x, rect.end_x(), threads_x, bound_->workgroup[0]);
  const auto [y, down] = range(rect.y, rect.end_y(), threads_y, bound_->workgroup[1]);
  CHECK_MSG(x + across <= frame_.max_groups[0] && y + down <= frame_.max_groups[1], pass_.name);
  vkCmdDispatchBase(commands_, x, y, 0, across, down, 1);
}

glm::uvec2 CommandListImpl::first_group(PicturePart part) const {
  if (!frame_.plan.parts) return glm::uvec2(0);
  const PixelRect& rect = frame_.plan.parts->of(part);
  return {uint32_t(rect.x) / bound_->workgroup[0], uint32_t(rect.y) / bound_->workgroup[1]};
}

void CommandListImpl::dispatch_indirect(BufferHandle groups, uint64_t offset) {
  CHECK_MSG(bound_ && bound_->bind_point == VK_PIPELINE_BIND_POINT_COMPUTE && !rendering_, pass_.name);
  use_of(groups, {Access::indirect_read});
  vkCmdDispatchIndirect(commands_, buffer(groups.resource).handle(), offset);
}

void CommandListImpl::trace_rays(uint32_t width, uint32_t height) {
  CHECK_MSG(bound_ && bound_->table && !rendering_, pass_.name);
  const VkStridedDeviceAddressRegionKHR callable{};
  frame_.device.function<PFN_vkCmdTraceRaysKHR>("vkCmdTraceRaysKHR")(
      commands_, &bound_->table->raygen, &bound_->table->miss, &bound_->table->hit, &callable, width, height, 1);
}

VkRenderingAttachmentInfo CommandListImpl::attachment(const PlanUse& use) const {
  const ImageDesc& desc = desc_of(use.resource);
  VkRenderingAttachmentInfo info{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
  info.imageView = frame_.view(view_key(use));
  info.imageLayout = image_layout(use.access, desc.format);
  const bool first = use.writes && use.first && (use.step != PlanUse::every_step || step_ == 0);
  info.loadOp = !first                           ? VK_ATTACHMENT_LOAD_OP_LOAD
                : desc.covered && !frame_.hashed ? VK_ATTACHMENT_LOAD_OP_DONT_CARE
                                                 : VK_ATTACHMENT_LOAD_OP_CLEAR;
  info.storeOp = use.writes ? VK_ATTACHMENT_STORE_OP_STORE : VK_ATTACHMENT_STORE_OP_NONE;
  if (is_depth_format(desc.format)) {
    info.clearValue.depthStencil = {desc.clear[0], uint32_t(desc.clear[1])};
  } else {
    for (size_t i = 0; i < 4; ++i) {
      if (is_integer_format(desc.format))
        info.clearValue.color.uint32[i] = uint32_t(int64_t(desc.clear[i]));
      else
        info.clearValue.color.float32[i] = desc.clear[i];
    }
  }
  return info;
}

void CommandListImpl::begin_rendering(std::span<const Attachment> colors, ImageHandle depth, ImageRange depth_range) {
  begin_in(colors, depth, depth_range, nullptr);
}

void CommandListImpl::begin_picture(std::span<const Attachment> colors, ImageHandle depth, PicturePart part) {
  begin_in(colors, depth, {}, frame_.plan.parts ? &frame_.plan.parts->of(part) : nullptr);
}

void CommandListImpl::begin_in(std::span<const Attachment> colors, ImageHandle depth, ImageRange depth_range,
                               const PixelRect* part) {
  CHECK_MSG(!rendering_ && (!colors.empty() || depth), pass_.name);
  const PlanUse* shape = nullptr;
  const auto drawn = [&](const PlanUse& use) -> const PlanUse& {
    if (!shape) shape = &use;
    CHECK_MSG(shape->range.layer_count == use.range.layer_count,
              fmt::format("pass '{}' draws to {} layers and to {}", pass_.name, shape->range.layer_count,
                          use.range.layer_count));
    return use;
  };
  constexpr size_t most_colors = 8;
  CHECK_MSG(colors.size() <= most_colors, pass_.name);
  std::array<VkRenderingAttachmentInfo, most_colors> color_infos;
  uint32_t color_count = 0;
  for (const Attachment& color : colors) {
    VkRenderingAttachmentInfo info = attachment(drawn(use_of(color.image, {Access::color_attachment}, color.range)));
    if (color.resolve) {
      const PlanUse& resolve = use_of(color.resolve, {Access::resolve_attachment});
      const VkFormat format = desc_of(resolve.resource).format;
      info.resolveMode = is_integer_format(format) ? VK_RESOLVE_MODE_SAMPLE_ZERO_BIT : VK_RESOLVE_MODE_AVERAGE_BIT;
      info.resolveImageView = frame_.view(view_key(resolve));
      info.resolveImageLayout = image_layout(resolve.access, format);
    }
    color_infos[color_count++] = info;
  }
  VkRenderingAttachmentInfo depth_info{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
  if (depth) depth_info = attachment(drawn(use_of(depth, {Access::depth_attachment, Access::depth_test}, depth_range)));

  const VkExtent3D extent = mip_extent(desc_of(shape->resource), shape->range.first_mip);
  const VkRect2D whole{{0, 0}, {extent.width, extent.height}};
  VkRect2D area = whole;
  if (part) {
    CHECK_MSG(part->end_x() <= int(extent.width) && part->end_y() <= int(extent.height), pass_.name);
    area = {{part->x, part->y}, {uint32_t(part->width), uint32_t(part->height)}};
  }
  VkRenderingInfo info{VK_STRUCTURE_TYPE_RENDERING_INFO};
  // Tiles and pyramids look up depths beyond the region.
  const bool clears_beyond =
      depth && depth_info.loadOp == VK_ATTACHMENT_LOAD_OP_CLEAR && !(part && frame_.physical.has_pages(depth.resource));
  info.renderArea = clears_beyond ? whole : area;
  info.layerCount = shape->range.layer_count;
  info.colorAttachmentCount = color_count;
  info.pColorAttachments = color_infos.data();
  info.pDepthAttachment = depth ? &depth_info : nullptr;
  if (depth && has_stencil(desc_of(depth.resource).format)) info.pStencilAttachment = &depth_info;
  vkCmdBeginRendering(commands_, &info);
  rendering_ = true, rendered_ = whole.extent;
  const VkViewport viewport{0, 0, float(extent.width), float(extent.height), 0, 1};
  vkCmdSetViewport(commands_, 0, 1, &viewport);
  vkCmdSetScissor(commands_, 0, 1, &area);
  set_cull(false, false);
  set_stencil_reference(0);
}

void CommandListImpl::end_rendering() {
  CHECK_MSG(rendering_, pass_.name);
  vkCmdEndRendering(commands_);
  rendering_ = false;
}

void CommandListImpl::set_cull(bool cull_back, bool mirrored) {
  vkCmdSetCullMode(commands_, cull_back ? VK_CULL_MODE_BACK_BIT : VK_CULL_MODE_NONE);
  vkCmdSetFrontFace(commands_, mirrored ? VK_FRONT_FACE_CLOCKWISE : VK_FRONT_FACE_COUNTER_CLOCKWISE);
}

void CommandListImpl::clear_depth_layer(uint32_t layer, float depth) {
  CHECK_MSG(rendering_, pass_.name);
  VkClearAttachment clear{VK_IMAGE_ASPECT_DEPTH_BIT, 0, {}};
  clear.clearValue.depthStencil = {depth, 0};
  const VkClearRect rect{{{0, 0}, rendered_}, layer, 1};
  vkCmdClearAttachments(commands_, 1, &clear, 1, &rect);
}

void CommandListImpl::set_stencil_reference(uint8_t reference) {
  vkCmdSetStencilReference(commands_, VK_STENCIL_FACE_FRONT_AND_BACK, reference);
}

void CommandListImpl::set_viewport(glm::vec2 corner_px, glm::vec2 size_px) {
  CHECK_MSG(rendering_, pass_.name);
  const VkViewport viewport{corner_px.x, corner_px.y, size_px.x, size_px.y, 0, 1};
  vkCmdSetViewport(commands_, 0, 1, &viewport);
}

void CommandListImpl::set_scissor(glm::uvec2 corner_px, glm::uvec2 size_px) {
  CHECK_MSG(rendering_, pass_.name);
  const VkRect2D area{{int32_t(corner_px.x), int32_t(corner_px.y)}, {size_px.x, size_px.y}};
  vkCmdSetScissor(commands_, 0, 1, &area);
}

void CommandListImpl::check_drawing() const {
  CHECK_MSG(rendering_ && bound_ && bound_->bind_point == VK_PIPELINE_BIND_POINT_GRAPHICS, pass_.name);
}

void CommandListImpl::draw(uint32_t vertices, uint32_t instances) {
  check_drawing();
  vkCmdDraw(commands_, vertices, instances, 0, 0);
}

void CommandListImpl::draw_indirect(BufferHandle commands, uint64_t offset, uint32_t draws) {
  check_drawing();
  use_of(commands, {Access::indirect_read});
  vkCmdDrawIndirect(commands_, buffer(commands.resource).handle(), offset, draws, sizeof(VkDrawIndirectCommand));
}

void CommandListImpl::draw_indirect_count(BufferHandle commands, uint64_t commands_offset, BufferHandle counts,
                                          uint64_t counts_offset, uint32_t max_draws) {
  check_drawing();
  use_of(commands, {Access::indirect_read});
  use_of(counts, {Access::indirect_read});
  vkCmdDrawIndirectCount(commands_, buffer(commands.resource).handle(), commands_offset,
                         buffer(counts.resource).handle(), counts_offset, max_draws, sizeof(VkDrawIndirectCommand));
}

void CommandListImpl::draw_indexed(uint32_t indices, uint32_t instances, uint32_t first_index, int32_t vertex_offset) {
  check_drawing();
  vkCmdDrawIndexed(commands_, indices, instances, first_index, vertex_offset, 0);
}

void CommandListImpl::draw_indexed_indirect(BufferHandle commands, uint64_t offset, uint32_t draws) {
  check_drawing();
  use_of(commands, {Access::indirect_read});
  vkCmdDrawIndexedIndirect(commands_, buffer(commands.resource).handle(), offset, draws,
                           sizeof(VkDrawIndexedIndirectCommand));
}

void CommandListImpl::bind_index_buffer(BufferHandle indices) {
  use_of(indices, {Access::index_read});
  vkCmdBindIndexBuffer(commands_, buffer(indices.resource).handle(), 0, VK_INDEX_TYPE_UINT32);
}

void CommandListImpl::draw_indexed_indirect_count(BufferHandle commands, uint64_t commands_offset, BufferHandle counts,
                                                  uint64_t counts_offset, uint32_t max_draws) {
  check_drawing();
  use_of(commands, {Access::indirect_read});
  use_of(counts, {Access::indirect_read});
  vkCmdDrawIndexedIndirectCount(commands_, buffer(commands.resource).handle(), commands_offset,
                                buffer(counts.resource).handle(), counts_offset, max_draws,
                                sizeof(VkDrawIndexedIndirectCommand));
}

}  // namespace candela::gpu
