#include "image/file_threads.h"

#include <atomic>

#include "image/exr.h"
#include "image/prepare.h"

namespace candela {
namespace {
std::atomic<bool> threads = true;
}  // namespace

bool file_threads() { return threads; }
bool set_file_threads(bool own) {
  const bool before = threads.exchange(own);
  if (own != before) set_exr_threads(own);
  return before;
}

}  // namespace candela
