#include "session/subframe_sums.h"

#include <algorithm>

#include "techniques/technique.h"

namespace candela {

std::shared_ptr<gpu::Buffer> SubframeSums::buffer_of(uint64_t bytes) {
  for (const auto& spare : spare_)
    if (spare->size() == bytes && spare.use_count() == 1) return spare;
  std::erase_if(spare_, [](const auto& spare) { return spare.use_count() == 1; });
  spare_.push_back(std::make_shared<gpu::Buffer>(
      device_, bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT,
      gpu::Buffer::Memory::device, gpu::Device::Purpose::frame, "sum"));
  return spare_.back();
}

SubframeSums::Sum& SubframeSums::sum_of(std::string_view name) {
  const auto found = std::ranges::find(sums_, name, &Sum::name);
  return found != sums_.end() ? *found : sums_.emplace_back(std::string(name));
}

void SubframeSums::import(const FramePlan& plan, gpu::Imports& imports,
                          std::vector<std::shared_ptr<const void>>& keep) {
  // What the frame before left is what this one takes.
  for (Sum& sum : sums_)
    if (sum.after) sum.before = std::move(sum.after), sum.after.reset();
  for (size_t r = 0; r < plan.resources.size(); ++r) {
    const PlanResource& resource = plan.resources[r];
    const bool is_before = resource.name().starts_with(sum_before);
    if (resource.is_image() || (!is_before && !resource.name().starts_with(sum_after))) continue;
    Sum& sum = sum_of(std::string_view(resource.name()).substr((is_before ? sum_before : sum_after).size()));
    std::shared_ptr<gpu::Buffer>& buffer = is_before ? sum.before : sum.after;
    if (!buffer) buffer = buffer_of(std::get<BufferDesc>(resource.desc).size_bytes);
    imports[int(r)] = buffer.get();
    keep.push_back(buffer);
  }
}

}  // namespace candela
