#pragma once
#include <filesystem>
#include <string>

namespace candela::gpu {

// Why there is no driver, and what to do. Loaders report a driver that fails as one that is not there, so it is looked
// whether files name one.
std::string no_driver();

// For the loader, the drivers of Mesa that reach a GPU through the kernel's folder `devices` alone, by their files;
// empty where that folder is there.
std::string drivers_without_device(const std::filesystem::path& devices);
// Has the loader leave them out, unless the environment says which drivers it takes. They would be loaded to find
// nothing: 5 ms and 7 MB of a process. It changes the environment: before the first thread starts.
void leave_out_drivers();

}  // namespace candela::gpu
