#include "gpu/driver_files.h"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>

#include "base/text.h"

namespace candela::gpu {
namespace {

// Files that say where drivers are, as the loader looks for them.
std::vector<std::string> driver_files() {
  namespace fs = std::filesystem;
  std::vector<std::string> found;
  std::error_code failed;
  for (const char* name : {"VK_DRIVER_FILES", "VK_ICD_FILENAMES"})
    if (const char* files = std::getenv(name); files && *files) {
      for (const std::string& file : split(files, ':'))
        if (fs::is_regular_file(file, failed)) found.push_back(file);
      return found;
    }
  const std::string system = "/usr";
  std::string folders = "/etc:" + system + "/local/etc";
  const auto add = [&](const char* name, std::string otherwise) {
    const char* value = std::getenv(name);
    folders += ":" + (value && *value ? std::string(value) : std::move(otherwise));
  };
  const char* home = std::getenv("HOME");
  if (home) add("XDG_DATA_HOME", fmt::format("{}/.local/share", home));
  add("XDG_DATA_DIRS", fmt::format("{0}/local/share:{0}/share", system));
  for (const std::string& folder : split(folders, ':'))
    for (fs::directory_iterator entry(fs::path(folder) / "vulkan/icd.d", failed), end; !failed && entry != end;
         entry.increment(failed))
      if (entry->path().extension() == ".json") found.push_back(entry->path().string());
  return found;
}

}  // namespace

std::string no_driver() {
  const std::vector<std::string> files = driver_files();
  if (files.empty()) return "no Vulkan driver found; install mesa-vulkan-drivers from bookworm-backports";
  return fmt::format(
      "no Vulkan driver starts, though {} {} there; the loader's own log says why: VK_LOADER_DEBUG=error in the "
      "environment",
      joined(files), files.size() == 1 ? "is" : "are");
}

std::string drivers_without_device(const std::filesystem::path& devices) {
  std::error_code failed;
  if (std::filesystem::exists(devices, failed) || failed) return {};
  std::string files = "radeon_icd*,intel_icd*,intel_hasvk_icd*,nouveau_icd*";
  // These two have other ways, for tests, which their own variables ask for.
  if (!std::getenv("VN_DEBUG")) files += ",virtio_icd*";
  if (!std::getenv("VIRTGPU_KUMQUAT")) files += ",gfxstream_vk_icd*";
  return files;
}

void leave_out_drivers() {
  constexpr const char* disable = "VK_LOADER_DRIVERS_DISABLE";
  for (const char* name : {disable, "VK_LOADER_DRIVERS_SELECT", "VK_DRIVER_FILES", "VK_ICD_FILENAMES"})
    if (std::getenv(name)) return;
  if (const std::string files = drivers_without_device("/dev/dri"); !files.empty()) setenv(disable, files.c_str(), 0);
}

}  // namespace candela::gpu
