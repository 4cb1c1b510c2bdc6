#include <fmt/format.h>
#include <malloc.h>

#include <atomic>
#include <cstdlib>
#include <fstream>
#include <new>

#include "exercise.h"
#include "mutator.h"

// Feeds a reader damaged files: every truncation of every seed, then seeded mutations, so that two runs see the same
// bytes. A crash fails the test; so does memory beyond a bound in proportion to the input. Usage: mutate_gltf or
// mutate_image SEED_FOLDER DICTIONARY ITERATIONS [SEED]

namespace {
std::atomic<size_t> live_bytes = 0, peak_bytes = 0;

void* counted(void* memory) {
  if (!memory) throw std::bad_alloc();
  const size_t live = live_bytes += malloc_usable_size(memory);
  for (size_t peak = peak_bytes; live > peak && !peak_bytes.compare_exchange_weak(peak, live);) {
  }
  return memory;
}
void uncount(void* memory) {
  live_bytes -= malloc_usable_size(memory);
  std::free(memory);
}
}  // namespace

void* operator new(size_t size) { return counted(std::malloc(size ? size : 1)); }
void* operator new(size_t size, std::align_val_t alignment) {
  return counted(
      std::aligned_alloc(size_t(alignment), (size + size_t(alignment) - 1) / size_t(alignment) * size_t(alignment)));
}
void operator delete(void* memory) noexcept { uncount(memory); }
void operator delete(void* memory, size_t) noexcept { uncount(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { uncount(memory); }
void operator delete(void* memory, size_t, std::align_val_t) noexcept { uncount(memory); }

namespace {

namespace fs = std::filesystem;
using candela::fuzz::Bytes;

Bytes read(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return Bytes(std::istreambuf_iterator<char>(stream), {});
}

// The quoted words of a libFuzzer dictionary; escaped bytes stay as their letters, which does no harm here.
std::vector<Bytes> read_words(const fs::path& path) {
  std::vector<Bytes> words;
  std::ifstream stream(path);
  for (std::string line; std::getline(stream, line);)
    if (line.size() > 2 && line.front() == '"') words.push_back(line.substr(1, line.size() - 2));
  return words;
}

// What failed is written out, to be made a test of its own.
[[noreturn]] void report(const Bytes& input, const std::string& what) {
  std::ofstream("mutate.failed", std::ios::binary) << input;
  fmt::print(stderr, "{}; the input of {} bytes is in mutate.failed\n", what, input.size());
  std::exit(1);
}

// The loader's own allowance is 64 MiB and 256 bytes for each byte read; posing and the JSON document come on top.
bool run(const Bytes& input) {
  const size_t before = live_bytes, bound = (size_t(96) << 20) + 1024 * input.size();
  peak_bytes = before;
  const bool loaded = candela::fuzz::exercise(std::as_bytes(std::span(input.data(), input.size())));
  if (peak_bytes - before > bound)
    report(input, fmt::format("{} bytes of memory, the bound is {}", peak_bytes - before, bound));
  return loaded;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) return 2;
  std::vector<Bytes> seeds;
  std::vector<fs::path> paths(fs::directory_iterator(argv[1]), {});
  std::sort(paths.begin(), paths.end());
  for (const fs::path& path : paths) seeds.push_back(read(path));
  if (seeds.empty()) report({}, "no seeds");
  for (size_t i = 0; i < seeds.size(); ++i)
    if (!run(seeds[i])) report(seeds[i], paths[i].filename().string() + " does not load, so it exercises nothing");

  size_t tried = 0, loaded = 0;
  for (const Bytes& seed : seeds)
    for (size_t n = 0; n < seed.size(); ++n, ++tried)
      if (run(seed.substr(0, n)) && seed.substr(n).find_first_not_of(" \r\n") != Bytes::npos)
        report(seed.substr(0, n), "a truncated file loaded");
  for (const size_t count = seeds.size(); seeds.size() < 2 * count;) {
    const Bytes& seed = seeds[seeds.size() - count];
    seeds.push_back(seed.starts_with('{') ? candela::fuzz::as_glb(seed) : seed);
  }

  candela::fuzz::Mutator mutator(seeds, read_words(argv[2]), argc > 4 ? uint32_t(std::stoul(argv[4])) : 1);
  for (size_t n = std::stoul(argv[3]); n > 0; --n, ++tried) {
    const Bytes input = mutator.next();
    loaded += run(input);
  }
  fmt::print("{} damaged files: {} of the mutated ones load, the rest are refused\n", tried, loaded);
  return 0;
}
