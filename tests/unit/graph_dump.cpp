#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "graph_random.h"

namespace candela {
namespace {

// A small frame; the arguments are what the hash must feel.
struct Frame {
  uint32_t width = 64, samples = 4, spec = 1;
  std::string shade = "shade";
  bool extra_dropped_pass = false, zeroed = false;
  Access use = Access::sampled_compute;

  FramePlan plan() const {
    GraphBuilder b;
    const BufferHandle scene = b.import_buffer({"scene", 3000});
    b.leave_out("sky", "the scene has no \"sky\"");
    b.begin_pass("depth_prepass");
    const ImageHandle depth = b.write(
        b.create(ImageDesc{
            .name = "depth", .format = VK_FORMAT_D32_SFLOAT, .width_px = width, .height_px = 32, .samples = samples}),
        Access::depth_attachment);
    b.read(scene, Access::vertex_read, "scene");
    b.end_pass({});
    b.begin_pass(shade);
    b.read(depth, Access::depth_test, "depth");
    b.read(scene, Access::fragment_read, "scene");
    const ImageHandle color =
        b.write(b.create(ImageDesc{
                    .name = "color", .format = VK_FORMAT_R16G16B16A16_SFLOAT, .width_px = width, .height_px = 32}),
                Access::color_attachment);
    b.pipeline(GraphicsPipelineDesc{
        .vertex_shader = "draw.vert", .fragment_shader = "shade.frag", .constants = {{3, "HAS_LIGHTS", spec}}});
    b.end_pass({});
    b.begin_pass("tonemap");
    b.read(color, use, "color");
    const ImageHandle display = b.write(
        b.create(ImageDesc{.name = "display", .format = VK_FORMAT_R8G8B8A8_UNORM, .width_px = width, .height_px = 32}),
        Access::storage_image_write);
    b.end_pass({});
    b.begin_pass("readback");
    b.read(display, Access::transfer_source, "display");
    b.sink(
        b.write(b.create(BufferDesc{"readback", 8192, BufferMemory::host_read, zeroed}), Access::transfer_destination));
    b.end_pass({});
    if (extra_dropped_pass) {
      b.begin_pass("unread");
      b.write(b.create(BufferDesc{"unread_out", 4}), Access::compute_write);
      b.end_pass({});
    }
    return compile_graph(b).plan;
  }
};

TEST(GraphDump, TextIsWhatAPersonReads) {
  const FramePlan plan = Frame{}.plan();
  const std::string text = plan_text(plan);
  const std::string expected = "plan " + plan_hash(plan).hex() +
                               R"(: 4 passes, 1 left out

passes
  #  pass           reads                      writes
  0  depth_prepass  scene (vertex_read)        depth (depth_attachment)
  1  shade          depth (depth_test)         color (color_attachment)
                    scene (fragment_read)
  2  tonemap        color (sampled_compute)    display (storage_image_write)
  3  readback       display (transfer_source)  readback (transfer_destination)

left out
  pass  reason
  sky   the scene has no "sky"

images
  image    format               size   samples      bytes  passes  block
  depth    D32_SFLOAT           64x32        4  32.00 KiB  0-1         0
  color    R16G16B16A16_SFLOAT  64x32        1  16.00 KiB  1-2         1
  display  R8G8B8A8_UNORM       64x32        1   8.00 KiB  2-3         0

buffers
  buffer    lifetime     bytes  passes
  scene     scene     2.93 KiB  0-1
  readback  readback  8.00 KiB  3-3

pipelines
  pass   shaders               constants
  shade  draw.vert shade.frag  HAS_LIGHTS=1

memory of the frame
  48.00 KiB (56.00 KiB without aliasing)
)";
  EXPECT_EQ(text, expected);
}

TEST(GraphDump, JsonHoldsThePlan) {
  const FramePlan plan = Frame{}.plan();
  const nlohmann::json json = nlohmann::json::parse(plan_json(plan));
  ASSERT_EQ(json["passes"].size(), 4u);
  EXPECT_EQ(json["passes"][1]["name"], "shade");
  EXPECT_EQ(json["passes"][1]["queue"], "main");
  EXPECT_EQ(json["passes"][1]["reads"], (nlohmann::json{"depth", "scene"}));
  EXPECT_EQ(json["passes"][1]["writes"], nlohmann::json::array({"color"}));
  EXPECT_EQ(json["passes"][1]["pipelines"][0]["constants"]["HAS_LIGHTS"], 1);
  EXPECT_EQ(json["left_out"][0]["pass"], "sky");
  EXPECT_EQ(json["left_out"][0]["reason"], "the scene has no \"sky\"");
  EXPECT_EQ(json["resources"].size(), 5u);
  EXPECT_EQ(json["memory"]["transient_bytes"], transient_bytes(plan));
  EXPECT_EQ(json["memory"]["transient_bytes_unaliased"], transient_bytes_unaliased(plan));
  EXPECT_EQ(json["hash"], plan_hash(plan).hex());
  for (uint32_t seed = 0; seed < 50; ++seed)
    EXPECT_TRUE(nlohmann::json::accept(plan_json(compile_graph(test::RandomGraph(seed).builder()).plan)));
}

TEST(GraphDump, DotIsWellFormed) {
  const std::string dot = plan_dot(Frame{}.plan());
  EXPECT_TRUE(dot.starts_with("digraph plan {\n"));
  EXPECT_TRUE(dot.ends_with("}\n"));
  EXPECT_NE(dot.find("pass0 -> pass1 [label=\"depth\""), std::string::npos) << dot;
  EXPECT_NE(dot.find("import0 -> pass0 [label=\"scene\""), std::string::npos) << dot;
  EXPECT_NE(dot.find("the scene has no \\\"sky\\\""), std::string::npos) << "quotes are escaped";
  EXPECT_NE(dot.find("style=dashed"), std::string::npos) << "left-out passes are dimmed";
  size_t line_start = dot.find('\n') + 1;
  for (size_t end = 0; (end = dot.find('\n', line_start)) != std::string::npos; line_start = end + 1) {
    const std::string line = dot.substr(line_start, end - line_start);
    size_t quotes = 0;
    for (size_t i = 0; i < line.size(); ++i) quotes += line[i] == '"' && (i == 0 || line[i - 1] != '\\');
    EXPECT_EQ(quotes % 2, 0u) << line;
    EXPECT_TRUE(line == "}" || line.ends_with(";")) << line;
  }
}

TEST(GraphDump, HashIsStableAndFeelsWhatTimingsDependOn) {
  const Hash128 hash = plan_hash(Frame{}.plan());
  EXPECT_EQ(hash, plan_hash(Frame{}.plan()));
  EXPECT_EQ(hash, plan_hash(Frame{.extra_dropped_pass = true}.plan())) << "what does not run does not count";
  EXPECT_NE(hash, plan_hash(Frame{.width = 65}.plan()));
  EXPECT_NE(hash, plan_hash(Frame{.samples = 1}.plan()));
  EXPECT_NE(hash, plan_hash(Frame{.spec = 0}.plan()));
  EXPECT_NE(hash, plan_hash(Frame{.shade = "shade_unlit"}.plan()));
  EXPECT_NE(hash, plan_hash(Frame{.use = Access::sampled_fragment}.plan()));
  EXPECT_NE(hash, plan_hash(Frame{.zeroed = true}.plan()));
}

}  // namespace
}  // namespace candela
