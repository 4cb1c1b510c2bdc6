#include <cstdint>

#include "exercise.h"

// libFuzzer's entry point; CMakeLists.txt says how to build and run it.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  candela::fuzz::exercise(std::as_bytes(std::span(data, size)));
  return 0;
}
