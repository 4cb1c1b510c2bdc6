#include "graph/builder.h"

#include <bit>

#include "base/check.h"
#include "graph/queues.h"

namespace candela {
namespace {

template <class Handle>
constexpr bool is_image_handle = std::is_same_v<Handle, ImageHandle>;

bool is_attachment(Access access) {
  return access == Access::color_attachment || access == Access::depth_attachment || access == Access::depth_test ||
         access == Access::resolve_attachment;
}

// flat: storage images and attachments, which see faces as layers.
ImageKind natural_view(const ImageDesc& desc, const ImageRange& range, bool flat) {
  if (desc.kind == ImageKind::d3) return ImageKind::d3;
  if (range.layer_count == desc.layers && !flat) return desc.kind;
  return range.layer_count == 1 ? ImageKind::d2 : ImageKind::d2_array;
}

const char* wrong_view(const ImageDesc& desc, const PlanUse& use, bool flat) {
  const bool of_cubes = desc.kind == ImageKind::cube || desc.kind == ImageKind::cube_array;
  if ((use.view == ImageKind::d3) != (desc.kind == ImageKind::d3)) return "only a 3D image is, and it is nothing else";
  if (use.view == ImageKind::d2 && use.range.layer_count != 1) return "the range has several layers";
  if (use.view != ImageKind::cube && use.view != ImageKind::cube_array) return nullptr;
  if (flat) return "storage images and attachments see faces as layers";
  if (!of_cubes) return "the image has no faces";
  if (use.view == ImageKind::cube && use.range.layer_count != 6) return "a cube has 6 layers";
  return use.range.layer_count % 6 ? "each cube has 6 layers" : nullptr;
}

// Why there can be no such image, or nothing.
const char* wrong_shape(const ImageDesc& desc) {
  if (desc.width_px == 0 || desc.height_px == 0 || desc.samples == 0 || desc.depth_px == 0 || desc.mips == 0 ||
      desc.layers == 0)
    return "an image without a texel";
  const bool cube = desc.kind == ImageKind::cube || desc.kind == ImageKind::cube_array;
  if (cube && desc.width_px != desc.height_px) return "a cube whose faces are not square";
  if (desc.kind == ImageKind::cube && desc.layers != 6) return "a cube has 6 layers";
  if (desc.kind == ImageKind::cube_array && desc.layers % 6 != 0) return "a cube array has 6 layers for each cube";
  if ((desc.kind == ImageKind::d2 || desc.kind == ImageKind::d3) && desc.layers != 1)
    return "layers in an image that is neither an array nor a cube";
  if (desc.kind != ImageKind::d3 && desc.depth_px != 1) return "a depth in an image that is not 3D";
  const uint32_t largest = std::max({desc.width_px, desc.height_px, desc.depth_px});
  if (desc.mips > uint32_t(std::bit_width(largest))) return "more mips than it halves";
  if (desc.samples > 1 && (desc.kind != ImageKind::d2 || desc.mips > 1)) return "a multisampled image has one mip, 2D";
  return nullptr;
}

}  // namespace

void GraphBuilder::refuse(std::string_view resource, std::string_view problem) const {
  const std::string place = open_ ? fmt::format("pass '{}'", passes_.back().name) : std::string("outside a pass");
  throw GraphError(fmt::format("{}, '{}': {}", place, resource, problem));
}

void GraphBuilder::require_open(std::string_view call) const {
  if (!open_) throw GraphError(fmt::format("{} outside a pass", call));
}

BufferHandle GraphBuilder::import_buffer(BufferDesc desc, Import import) {
  resources_.push_back({.desc = std::move(desc), .imported = true, .to_fill = import == Import::to_fill});
  return {int(resources_.size()) - 1, 0};
}

ImageHandle GraphBuilder::import_image(ImageDesc desc) {
  if (const char* wrong = wrong_shape(desc)) refuse(desc.name, wrong);
  resources_.push_back({.desc = std::move(desc), .imported = true});
  return {int(resources_.size()) - 1, 0};
}

void GraphBuilder::keep(ImageHandle image, const Hash128& key, std::string why) {
  Resource& resource = resource_of(image);
  if (resource.imported) refuse(resource.name(), "an imported image is to be kept");
  const ImageDesc& desc = std::get<ImageDesc>(resource.desc);
  std::vector<bool> holds(size_t(desc.mips) * desc.layers, false);
  for (const ImageRange& range : resource.written)
    for_subresources(range, desc.layers, [&](size_t i) { holds[i] = true; });
  if (std::ranges::find(holds, false) != holds.end())
    refuse(resource.name(), "an image is to be kept before all of it is written");
  for (const Pass& pass : passes_)
    for (const PlanUse& use : pass.uses)
      if (use.resource == image.resource && !use.writes)
        refuse(resource.name(), "an image is to be kept after it was read");
  resource.key = key, resource.kept_reason = std::move(why);
}

void GraphBuilder::pool(ImageHandle image) {
  Resource& resource = resource_of(image);
  if (resource.imported || resource.key) refuse(resource.name(), "an image that is imported or kept is to be pooled");
  if (std::ranges::any_of(resources_, [](const Resource& r) { return r.pooled; }))
    refuse(resource.name(), "a second image is to be pooled");
  resource.pooled = true;
}

void GraphBuilder::begin_pass(std::string name, Queue queue) {
  if (open_) throw GraphError(fmt::format("pass '{}' begins inside pass '{}'", name, passes_.back().name));
  for (const Pass& pass : passes_)
    if (pass.name == name)
      throw GraphError(fmt::format("a second pass '{}': each instance needs a name of its own", name));
  passes_.push_back({.name = std::move(name), .queue = queue});
  open_ = true;
  missing_.clear();
}

template <class Desc>
int GraphBuilder::create_any(Desc desc) {
  if (!open_) throw GraphError(fmt::format("create of '{}' outside a pass", desc.name));
  resources_.push_back({.desc = std::move(desc), .creator = int(passes_.size()) - 1});
  return int(resources_.size()) - 1;
}

ImageHandle GraphBuilder::create(ImageDesc desc) {
  if (const char* wrong = wrong_shape(desc); wrong && missing_.empty()) refuse(desc.name, wrong);
  return {create_any(std::move(desc)), 0};
}
BufferHandle GraphBuilder::create(BufferDesc desc) {
  if (desc.size_bytes == 0 && missing_.empty()) refuse(desc.name, "a buffer without a byte");
  return {create_any(std::move(desc)), 0};
}

template <class Handle>
GraphBuilder::Resource& GraphBuilder::resource_of(Handle handle) {
  if (handle.resource < 0 || size_t(handle.resource) >= resources_.size())
    refuse(fmt::format("resource {}", handle.resource), "a handle of another graph");
  Resource& resource = resources_[handle.resource];
  if (std::holds_alternative<ImageDesc>(resource.desc) != is_image_handle<Handle>)
    refuse(resource.name(), "a handle of another graph: an image and a buffer are taken for each other");
  if (resource.left_out >= 0)
    refuse(resource.name(), fmt::format("a handle that pass '{}' should not have given away: it was left out",
                                        left_out_[resource.left_out].pass));
  if (handle.version != resource.version)
    refuse(resource.name(),
           fmt::format("a stale handle: version {}, and {} is the newest", handle.version, resource.version));
  return resource;
}

void GraphBuilder::check_fits(const Resource& resource, Access access) const {
  const AccessInfo& info = access_info(access);
  if (access == Access::host_read) refuse(resource.name(), "host_read is no access of a pass; call sink");
  const auto* image = std::get_if<ImageDesc>(&resource.desc);
  if (passes_.back().queue == Queue::compute) {
    if ((info.stages & stages_of(Queue::compute)) == 0)
      refuse(resource.name(), fmt::format("{} in a pass of the compute queue, which does not draw", info.name));
    if (image && is_depth_format(image->format) && (info.stages & VK_PIPELINE_STAGE_2_TRANSFER_BIT))
      refuse(resource.name(), "the compute queue copies no depth images");
  }
  if (!image) {
    if (info.buffer_usage == 0) refuse(resource.name(), fmt::format("{} does not fit a buffer", info.name));
    return;
  }
  if (info.image_usage == 0) refuse(resource.name(), fmt::format("{} does not fit an image", info.name));
  const bool of_depth = (info.image_usage & VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT) != 0;
  const bool of_color = (info.image_usage & (VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_STORAGE_BIT)) != 0;
  if (is_depth_format(image->format) ? of_color : of_depth)
    refuse(resource.name(), fmt::format("{} does not fit the image's format", info.name));
  if (access == Access::resolve_attachment && image->samples != 1)
    refuse(resource.name(), "resolve_attachment into a multisampled image");
}

// The use with its step and, of an image, its range and view in full.
PlanUse GraphBuilder::use_of(const Resource& resource, PlanUse use, const Part& part) const {
  use.step = passes_.back().steps - 1;  // none opened: every step
  const auto* image = std::get_if<ImageDesc>(&resource.desc);
  if (!image || !missing_.empty()) return use;  // what a pass makes that will be left out may have any size
  const AccessInfo& info = access_info(use.access);
  use.range = resolved(part.range, *image);
  if (!fits(use.range, *image))
    refuse(resource.name(), fmt::format("a range outside its {} mips and {} layers", image->mips, image->layers));
  const bool drawn = is_attachment(use.access), stored = info.image_usage & VK_IMAGE_USAGE_STORAGE_BIT;
  if ((drawn || stored) && use.range.mip_count != 1)
    refuse(resource.name(), fmt::format("{} of {} mips; give the range of one", info.name, use.range.mip_count));
  if (drawn && image->kind == ImageKind::d3) refuse(resource.name(), fmt::format("{} of a 3D image", info.name));
  use.view = part.view.value_or(natural_view(*image, use.range, drawn || stored));
  if (const char* wrong = wrong_view(*image, use, drawn || stored))
    refuse(resource.name(), fmt::format("seen as {}: {}", image_kind_name(use.view), wrong));
  return use;
}

// Of an image that later frames find filled: all of it is written, and only then read.
// Of a read: every subresource holds something. Of a drawing: all do or none does, for it clears or keeps them all.
void GraphBuilder::check_written(const Resource& resource, const PlanUse& use) const {
  const auto* image = std::get_if<ImageDesc>(&resource.desc);
  const auto* buffer = std::get_if<BufferDesc>(&resource.desc);
  const bool filled = resource.imported && !resource.to_fill;
  if (filled || (buffer && buffer->zeroed) || !missing_.empty()) return;
  bool all = resource.version > 0, any = all;
  if (image) {
    std::vector<bool> holds(size_t(image->mips) * image->layers, false);
    for (const ImageRange& range : resource.written)
      for_subresources(range, image->layers, [&](size_t i) { holds[i] = true; });
    all = true, any = false;
    for_subresources(use.range, image->layers, [&](size_t i) { holds[i] ? any = true : all = false; });
  }
  const std::string part = image ? range_text(use.range, *image) : "";
  if (!use.writes && !all) refuse(resource.name() + part, "read before anything was written");
  if (use.access == Access::storage_image_read_write && !all)
    refuse(resource.name() + part, "read before anything was written (storage_image_read_write)");
  if (use.writes && is_attachment(use.access) && any && !all)
    refuse(resource.name() + part, "drawn to where only a part was written before: write the rest first");
}

// One step, one subresource, several uses: nothing can be ordered inside a step, and an image has one layout there.
void GraphBuilder::check_together(const Resource& resource, const PlanUse& use) const {
  const auto* image = std::get_if<ImageDesc>(&resource.desc);
  for (const PlanUse& other : passes_.back().uses) {
    if (other.resource != use.resource) continue;
    if (other.step != use.step && other.step != PlanUse::every_step && use.step != PlanUse::every_step) continue;
    if (image && !other.range.overlaps(use.range)) continue;
    const std::string_view a = access_info(other.access).name, b = access_info(use.access).name;
    if (other.writes && use.writes) refuse(resource.name(), fmt::format("written twice in one pass, {} and {}", a, b));
    if (other.writes)
      refuse(resource.name(), fmt::format("written ({}) and then read ({}) in one pass: split the pass", a, b));
    if (image && image_layout(other.access, image->format) != image_layout(use.access, image->format))
      refuse(resource.name(), fmt::format("{} and {} in one pass want different layouts", a, b));
  }
}

template <class Handle>
void GraphBuilder::read_any(Handle handle, Access access, std::string_view what, const Part& part) {
  require_open(fmt::format("read of '{}'", what));
  if (!handle) {
    if (missing_.empty()) missing_ = missing_reason(what, handle.absence);
    return;
  }
  const Resource& resource = resource_of(handle);
  check_fits(resource, access);
  if (access_info(access).writes)
    refuse(resource.name(), fmt::format("read as {}, which writes", access_info(access).name));
  const PlanUse use = use_of(resource, {handle.resource, access, handle.version, false}, part);
  check_written(resource, use);
  std::vector<PlanUse>& uses = passes_.back().uses;
  if (std::find(uses.begin(), uses.end(), use) != uses.end()) return;
  check_together(resource, use);
  uses.push_back(use);
}

void GraphBuilder::read(ImageHandle image, Access access, std::string_view what, ImageRange range,
                        std::optional<ImageKind> view) {
  read_any(image, access, what, {range, view});
}
void GraphBuilder::read(BufferHandle buffer, Access access, std::string_view what) { read_any(buffer, access, what); }

bool GraphBuilder::read_optional(ImageHandle image, Access access, ImageRange range, std::optional<ImageKind> view) {
  require_open("read_optional");
  if (image) read_any(image, access, {}, {range, view});
  return bool(image);
}
bool GraphBuilder::read_optional(BufferHandle buffer, Access access) {
  require_open("read_optional");
  if (buffer) read_any(buffer, access, {});
  return bool(buffer);
}

template <class Handle>
Handle GraphBuilder::write_any(Handle handle, Access access, const Part& part) {
  require_open("write");
  if (!handle) {
    if (missing_.empty())
      missing_ =
          missing_reason(is_image_handle<Handle> ? "an image to write to" : "a buffer to write to", handle.absence);
    return handle;
  }
  Resource& resource = resource_of(handle);
  check_fits(resource, access);
  if (!access_info(access).writes)
    refuse(resource.name(), fmt::format("written as {}, which only reads", access_info(access).name));
  if (resource.imported && !resource.to_fill) refuse(resource.name(), "an imported resource is written");
  if (resource.key) refuse(resource.name(), "an image that is kept is written");
  const PlanUse use = use_of(resource, {handle.resource, access, handle.version + 1, true}, part);
  check_written(resource, use);
  check_together(resource, use);
  passes_.back().uses.push_back(use);
  resource.version = use.version;
  resource.written.push_back(use.range);
  return {handle.resource, use.version};
}

ImageHandle GraphBuilder::write(ImageHandle image, Access access, ImageRange range, std::optional<ImageKind> view) {
  return write_any(image, access, {range, view});
}
BufferHandle GraphBuilder::write(BufferHandle buffer, Access access) { return write_any(buffer, access); }

void GraphBuilder::clear_first(ImageHandle image) { std::get<ImageDesc>(resource_of(image).desc).covered = false; }

void GraphBuilder::begin_step() {
  require_open("begin_step");
  ++passes_.back().steps;
}

template <class Desc>
PipelineHandle GraphBuilder::pipeline_any(Desc desc) {
  require_open("pipeline");
  if constexpr (std::is_same_v<Desc, GraphicsPipelineDesc>)
    if (passes_.back().queue == Queue::compute)
      refuse(desc.vertex_shader, "a graphics pipeline in a pass of the compute queue");
  const PipelineDesc wanted(std::move(desc));
  auto place = std::find(pipelines_.begin(), pipelines_.end(), wanted);
  if (place == pipelines_.end()) place = pipelines_.insert(place, wanted);
  std::vector<int>& own = passes_.back().pipelines;
  own.push_back(int(place - pipelines_.begin()));
  return {int(own.size()) - 1};
}

PipelineHandle GraphBuilder::pipeline(ComputePipelineDesc desc) { return pipeline_any(std::move(desc)); }
PipelineHandle GraphBuilder::pipeline(GraphicsPipelineDesc desc) { return pipeline_any(std::move(desc)); }
PipelineHandle GraphBuilder::pipeline(RayPipelineDesc desc) { return pipeline_any(std::move(desc)); }

std::string GraphBuilder::missing_reason(std::string_view what, int absence) const {
  const std::string reason = fmt::format("needs {}, which no kept pass makes", what);
  return absence < 0 ? reason : fmt::format("{}; {}", reason, absences_[size_t(absence)]);
}

int GraphBuilder::absent(std::string reason) {
  absences_.push_back(std::move(reason));
  return last_absence();
}

void GraphBuilder::knob(std::string name, std::string value) {
  require_open(fmt::format("knob {}", name));
  passes_.back().knobs.push_back({std::move(name), std::move(value)});
}

void GraphBuilder::publish(std::string layer, ImageHandle image) {
  if (image) published_.emplace_back(std::move(layer), image);
}

// The versions it made never were, so what it read stays usable under the old handles.
void GraphBuilder::discard_pass() {
  const Pass& pass = passes_.back();
  for (const PlanUse& use : pass.uses) {
    Resource& resource = resources_[use.resource];
    if (!use.writes || resource.version < use.version) continue;
    resource.version = use.version - 1;
    resource.written.resize(size_t(resource.version));
  }
  leave_out(pass.name, missing_);
  for (Resource& resource : resources_)
    if (resource.creator == int(passes_.size()) - 1) {
      resource.creator = -1;
      resource.left_out = int(left_out_.size()) - 1;
    }
  std::erase_if(published_, [&](const auto& p) { return resources_[size_t(p.second.resource)].left_out >= 0; });
  std::erase_if(sinks_, [&](int sink) { return resources_[sink].left_out >= 0 || resources_[sink].version == 0; });
  passes_.pop_back();
}

bool GraphBuilder::end_pass(RecordFunction record) {
  require_open("end_pass");
  open_ = false;
  if (!missing_.empty()) {
    discard_pass();
    return false;
  }
  passes_.back().record = std::move(record);
  return true;
}

int GraphBuilder::leave_out(std::string pass, std::string reason) {
  if (open_) throw GraphError(fmt::format("'{}' is left out inside pass '{}'", pass, passes_.back().name));
  left_out_.push_back({pass, reason});
  return absent(fmt::format("{} was left out: {}", pass, reason));
}

void GraphBuilder::sink(BufferHandle buffer) {
  if (!buffer) return;
  const Resource& resource = resource_of(buffer);
  if (buffer.version == 0) refuse(resource.name(), "a sink that nothing writes");
  sinks_.push_back(buffer.resource);
}
void GraphBuilder::sink(ImageHandle image) {
  if (!image) return;
  const Resource& resource = resource_of(image);
  if (image.version == 0) refuse(resource.name(), "a sink that nothing writes");
  sinks_.push_back(image.resource);
}

}  // namespace candela
