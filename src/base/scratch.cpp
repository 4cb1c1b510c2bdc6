#include "base/scratch.h"

#include <algorithm>
#include <memory>

namespace candela {
namespace {

struct Block {
  std::unique_ptr<std::byte[]> bytes;
  size_t size = 0, used = 0;
  size_t wanted = 0;  // the most that was asked for at once
  Scratch* last = nullptr;
  bool holds(const void* memory) const {
    const auto* at = static_cast<const std::byte*>(memory);
    return !std::less<>()(at, bytes.get()) && std::less<>()(at, bytes.get() + size);
  }
};
thread_local Block block;

}  // namespace

Scratch::Scratch() : before_(block.last), begin_(block.used) {
  // Nobody uses the block now.
  if (!before_ && block.wanted > block.size) {
    block.size = std::max(block.wanted, 2 * block.size);
    block.bytes = std::make_unique_for_overwrite<std::byte[]>(block.size);
  }
  block.last = this;
}

Scratch::~Scratch() {
  block.used = begin_;
  block.last = before_;
}

void* Scratch::do_allocate(size_t bytes, size_t alignment) {
  if (block.last == this) {
    const size_t at = (block.used + alignment - 1) / alignment * alignment;
    block.wanted = std::max(block.wanted, at + bytes);
    if (at + bytes <= block.size && alignment <= alignof(std::max_align_t)) {
      block.used = at + bytes;
      return block.bytes.get() + at;
    }
    // What comes behind it is counted as if it had found room.
    block.wanted = std::max(block.wanted, block.size + bytes);
  }
  return std::pmr::new_delete_resource()->allocate(bytes, alignment);
}

void Scratch::do_deallocate(void* memory, size_t bytes, size_t alignment) {
  if (block.holds(memory)) {
    // The last that was taken is given back: a vector that grows alone moves on from there.
    if (block.last == this && static_cast<std::byte*>(memory) + bytes == block.bytes.get() + block.used)
      block.used = size_t(static_cast<std::byte*>(memory) - block.bytes.get());
    return;
  }
  std::pmr::new_delete_resource()->deallocate(memory, bytes, alignment);
}

}  // namespace candela
