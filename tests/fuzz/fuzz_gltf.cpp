#include <cstdint>
#include <cstring>

#include "exercise.h"
#include "mutator.h"

// libFuzzer's entry points; CMakeLists.txt says how to build and run it.
extern "C" size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t most);

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  candela::fuzz::exercise(std::as_bytes(std::span(data, size)));
  return 0;
}

// Half of the time libFuzzer's own mutations, half of the time those that keep the file well-formed.
extern "C" size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t most, unsigned seed) {
  if (seed % 2 == 0) return LLVMFuzzerMutate(data, size, most);
  candela::fuzz::Bytes bytes(reinterpret_cast<const char*>(data), size);
  candela::fuzz::Mutator mutator(
      {bytes}, {"POSITION", "NORMAL", "TEXCOORD_0", "JOINTS_0", "WEIGHTS_0", "sparse", "targets", "mode"}, seed);
  if (!mutator.structured(bytes) || bytes.size() > most) return LLVMFuzzerMutate(data, size, most);
  std::memcpy(data, bytes.data(), bytes.size());
  return bytes.size();
}
