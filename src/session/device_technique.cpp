#include "session/device_technique.h"

#include "gpu/device.h"
#include "gpu/device_select.h"

namespace candela {

Expected<ChosenTechnique> device_technique(const std::string& which) {
  const auto devices = gpu::list_devices();
  if (!devices) return std::unexpected(devices.error());
  const auto index = gpu::choose_device(*devices, which);
  if (!index) return std::unexpected(index.error());
  const gpu::DeviceInfo& info = (*devices)[size_t(*index)];
  return quickest_technique(info.is_cpu, info.int64_atomics);
}

}  // namespace candela
