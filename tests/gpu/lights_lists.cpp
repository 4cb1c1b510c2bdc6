#include <numeric>

#include "passes/lights/light_scan.h"
#include "passes/lights/light_sort.h"
#include "passes_fixture.h"
#include "shared/lights.h"

// The passes that turn counts of lights into sorted lists, each alone, on lists in every order. In whole frames a CPU's
// workgroups run nearly in order, and lists come out of light_fill nearly sorted.
namespace candela::gpu::test {
namespace {

std::vector<uint32_t> offsets_of(const std::vector<uint32_t>& counts) {
  std::vector<uint32_t> offsets(counts.size() + 1, 0);
  std::partial_sum(counts.begin(), counts.end(), offsets.begin() + 1);
  return offsets;
}

}  // namespace

class LightLists : public PassTest {
 protected:
  std::vector<uint32_t> words_of(GraphBuilder& builder, BufferHandle buffer, size_t count) {
    const BufferHandle words = read_words(builder, "result", buffer, count * 4);
    const FrameRun run = run_all(builder);
    std::vector<uint32_t> result(count);
    std::memcpy(result.data(), run.readbacks.at(words.resource)->bytes().data(), count * 4);
    return result;
  }
};

// Around the size of a group: the last list's end too, whether or not a thread is left over for it.
TEST_F(LightLists, EachBeginsWhereTheOneBeforeEnds) {
  Rng rng(1);
  for (const uint32_t cells : {1u, 255u, 256u, 257u, 512u, 1000u, 70000u}) {
    imports.clear();
    std::vector<uint32_t> counts(cells), sums((cells + shared::light_scan_cells - 1) / shared::light_scan_cells, 0);
    for (uint32_t i = 0; i < cells; ++i) {
      counts[i] = i + 1 == cells ? 3 : uint32_t(rng.uniform(0, 20));
      sums[i / shared::light_scan_cells] += counts[i];
    }
    const Buffer counts_buffer = upload(counts, "counts"), sums_buffer = upload(sums, "sums");
    GraphBuilder builder;
    LightScan scan;
    scan.grid.compact = true, scan.grid.cells = cells;
    const auto out =
        add(builder, scan, {import(builder, counts_buffer, "counts"), import(builder, sums_buffer, "sums")});
    EXPECT_EQ(words_of(builder, out.offsets, cells + 1), offsets_of(counts)) << cells;
  }
}

// Short and long ones, around powers of two, in falling, shuffled and mostly sorted order.
TEST_F(LightLists, ComeOutInLightOrder) {
  std::vector<uint32_t> counts;
  for (const uint32_t n : {0u, 1u, 2u, 47u, 48u, 49u, 63u, 64u, 65u, 127u, 128u, 129u, 1000u, 2048u, 2049u, 3000u})
    counts.insert(counts.end(), 3, n);
  counts.insert(counts.end(), 30, 60);  // more long lists than one in a group
  const std::vector<uint32_t> offsets = offsets_of(counts);
  Rng rng(2);
  std::vector<uint32_t> wanted, unsorted;
  for (size_t cell = 0; cell < counts.size(); ++cell) {
    std::vector<uint32_t> list(counts[cell]);
    uint32_t light = 0;
    for (uint32_t& l : list) l = light += 1 + uint32_t(rng.uniform(0, 5));
    wanted.insert(wanted.end(), list.begin(), list.end());
    if (cell % 3 == 0) std::reverse(list.begin(), list.end());
    if (cell % 3 == 1)
      for (size_t i = list.size(); i > 1; --i) std::swap(list[i - 1], list[size_t(rng.uniform() * double(i))]);
    if (cell % 3 == 2 && list.size() > 1) std::swap(list.front(), list.back());
    unsorted.insert(unsorted.end(), list.begin(), list.end());
  }
  const Buffer offsets_buffer = upload(offsets, "offsets"), unsorted_buffer = upload(unsorted, "unsorted");
  GraphBuilder builder;
  LightSort sort;
  sort.grid.compact = true, sort.grid.cells = uint32_t(counts.size()), sort.grid.most_entries = unsorted.size();
  const auto out =
      add(builder, sort, {import(builder, offsets_buffer, "offsets"), import(builder, unsorted_buffer, "unsorted")});
  const std::vector<uint32_t> sorted = words_of(builder, out.entries, unsorted.size());
  for (size_t cell = 0; cell < counts.size(); ++cell)
    EXPECT_TRUE(
        std::equal(sorted.begin() + offsets[cell], sorted.begin() + offsets[cell + 1], wanted.begin() + offsets[cell]))
        << "a list of " << counts[cell] << ", order " << cell % 3;
}

}  // namespace candela::gpu::test
