#pragma once
#include <utility>
#include <vector>

namespace candela::cli {

// How this program was built. Written by CMake (cmake/build_info.cmake).
struct BuildInfo {
  const char *type, *compiler, *processor;
  const char* libraries_linked;  // shared, or static: all but the C library and the Vulkan loader are inside
  bool sanitizers, deliberate_faults;
  std::vector<std::pair<const char*, const char*>> libraries;  // name, version of the headers
};
extern const BuildInfo build_info;

// `git describe`: v1.2.3-14-gabcdef, or gabcdef where there is no tag; empty where nothing is known.
extern const char* const source_version;

}  // namespace candela::cli
