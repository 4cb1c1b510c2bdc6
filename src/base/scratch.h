#pragma once
#include <cstddef>
#include <memory_resource>
#include <vector>

namespace candela {

// Memory for what a function needs while it runs: taken one after another from a block that the thread keeps, and given
// back all at once when the Scratch ends. So work that is done again for every frame asks the heap for nothing.
//
//   Scratch scratch;
//   ScratchVector<double> areas(&scratch);
//
// Of several that are alive on a thread the one that was made last takes from the block; what asks another meanwhile
// gets its memory from the heap, as does what finds the block too small. The block is then larger the next time.
class Scratch final : public std::pmr::memory_resource {
 public:
  Scratch();
  ~Scratch() override;
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

 private:
  void* do_allocate(size_t bytes, size_t alignment) override;
  void do_deallocate(void* memory, size_t bytes, size_t alignment) override;
  bool do_is_equal(const memory_resource& other) const noexcept override { return this == &other; }
  Scratch* before_;
  size_t begin_;
};

template <class T>
using ScratchVector = std::pmr::vector<T>;

}  // namespace candela
