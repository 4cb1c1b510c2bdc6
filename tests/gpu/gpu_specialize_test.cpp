// What specialization constants leave of a shader (gpu/specialize.h).
#include <fstream>

#include "base/files.h"
#include "glsl/shader_compiler.h"
#include "gpu/specialize.h"
#include "gpu_fixture.h"

namespace candela::gpu::test {
namespace {

namespace fs = std::filesystem;

struct Count {
  int functions = 0, branches = 0, selections = 0;
};
Count count_of(std::span<const uint32_t> spirv) {
  Count count;
  for (size_t at = 5; at < spirv.size(); at += spirv[at] >> 16) {
    const uint32_t op = spirv[at] & 0xffff;
    EXPECT_GT(spirv[at] >> 16, 0u);
    count.functions += op == 54, count.branches += op == 250, count.selections += op == 247;
    if (spirv[at] >> 16 == 0) break;
  }
  return count;
}

std::vector<uint32_t> compiled(const std::string& body) {
  const fs::path folder = fs::temp_directory_path() / fmt::format("candela-specialize-{}", getpid());
  fs::create_directories(folder);
  std::ofstream(folder / "test.comp") << "#version 460\n"
                                         "layout(local_size_x = 1) in;\n"
                                         "layout(constant_id = 0) const int KIND = 0;\n"
                                         "layout(constant_id = 1) const bool ON = false;\n"
                                         "layout(constant_id = 2) const uint BITS = 0u;\n"
                                         "layout(set = 0, binding = 0) buffer B { uint v[]; };\n"
                                      << body;
  const auto result = glsl::ShaderCompiler(folder).compile("test.comp");
  EXPECT_TRUE(result) << result.error().text();
  fs::remove_all(folder);
  return result ? result->spirv : std::vector<uint32_t>();
}

TEST(Specialize, DropsWhatIsNeverReached) {
  const std::vector<uint32_t> code = compiled(R"(
    uint one(uint x) { return x + 1u; }
    uint two(uint x) { for (uint i = 0u; i < x; ++i) if (v[i] == 7u) return i; return one(x); }
    uint three(uint x) { return 3u * x; }
    void main() {
      if (ON && (BITS & 8u) != 0u) v[4] = three(v[4]);
      if (KIND == 3) v[0] = two(v[0]);
      if (ON && v[1] > 2u) v[1] = one(v[1]); else v[2] = 5u;
      if ((BITS & 4u) != 0u) { if (v[3] > 1u) v[3] = 1u; }
      bool some = v[5] > 2u;  // one side of && and || is known
      if (ON && some) v[5] = 9u;
      if (!ON || some) v[6] = 9u;
    })");
  const auto left = [&](std::vector<SpecConstant> constants) { return count_of(specialized(code, constants)); };
  // main and what it calls; a loop's own branch and those on memory stay.
  const Count none = left({}), all = left({{0, "KIND", 3}, {1, "ON", 1}, {2, "BITS", 6}});
  EXPECT_EQ(none.functions, 1);
  EXPECT_EQ(none.branches, 0);
  EXPECT_EQ(none.selections, 0);
  EXPECT_EQ(all.functions, 3);
  EXPECT_EQ(all.branches, 6);
  const Count bits = left({{2, "BITS", 4}});
  EXPECT_EQ(bits.functions, 1);
  EXPECT_EQ(bits.branches, 1);
  EXPECT_EQ(left({{1, "ON", 1}}).functions, 2);
  EXPECT_EQ(left({{1, "ON", 1}, {2, "BITS", 8}}).functions, 3);
  EXPECT_EQ(left({{2, "BITS", 8}}).functions, 1);
}

// A loop that is left before it comes round again has no such way any more: it stays as it is.
TEST(Specialize, LeavesWhatItDoesNotKnow) {
  const std::vector<uint32_t> code = compiled(R"(
    void main() { for (uint i = 0u; i < v[0]; ++i) { v[1] += i; if (KIND == 0) break; } })");
  EXPECT_EQ(specialized(code, {}), code);
  const std::vector<uint32_t> cut(code.begin(), code.begin() + long(code.size()) - 3);
  EXPECT_EQ(specialized(cut, {}), cut);
  EXPECT_LT(specialized(code, std::vector<SpecConstant>{{0, "KIND", 1}}).size(), code.size());
}

}  // namespace
}  // namespace candela::gpu::test
