#include "frame_fixture.h"
#include "graph/formats.h"
#include "render/dump.h"

namespace candela::test {

class Dumps : public FrameTest {
 protected:
  static WantedOutputs wanting(std::vector<std::string> dumps) {
    WantedOutputs wanted;
    for (const std::string& text : dumps) wanted.dumps.push_back(*parse_dump(text));
    return wanted;
  }
  // Copied, for the readbacks must not outlive the session.
  std::vector<FloatImage> dump(const Job& job, std::vector<std::string> dumps) {
    const auto session = open(job, wanting(dumps));
    if (!session) return {};
    const FrameResult result = render(*session);
    frame = images(result);
    std::vector<FloatImage> out;
    for (const FrameDump& of : result.dumps) out.push_back(dump_image(of, result.readbacks.at(of.resource)->bytes()));
    EXPECT_EQ(out.size(), dumps.size());
    return out;
  }
  Images frame;
};

// The resolved picture is the linear output; the frame is the same with and without dumps.
TEST_F(Dumps, HoldWhatTheImageHolds) {
  Job job = job_for(scene("spheres"), 40, 24, 4);
  const Images plain = images_of(job);
  const auto dumps = dump(job, {"resolve.resolved", "background.color", "depth_prepass.depth", "shade_forward.color",
                                "depth_views.sun.sun.maps[0,1]"});
  ASSERT_EQ(dumps.size(), 5u);
  EXPECT_EQ(frame, plain);
  const std::vector<float> beauty = plain["beauty"].values<float>();
  const char* names[] = {"R", "G", "B", "A"};
  for (size_t c = 0; c < 4; ++c) {
    const Channel* resolved = dumps[0].find(names[c]);
    ASSERT_NE(resolved, nullptr);
    for (size_t i = 0; i < resolved->f.size(); ++i) ASSERT_EQ(resolved->f[i], beauty[4 * i + c]) << i;
  }
  // One of four samples: the mean where all are alike.
  const Channel *first = dumps[1].find("R"), *mean = dumps[0].find("R");
  ASSERT_TRUE(first && first->f.size() == mean->f.size());
  size_t equal = 0;
  for (size_t i = 0; i < first->f.size(); ++i) equal += std::abs(first->f[i] - mean->f[i]) <= 1e-3f * mean->f[i];
  EXPECT_GT(equal, first->f.size() / 4);
  EXPECT_EQ(dumps[1].metadata.back().text, "first of 4");
  // Reversed depth: 0 where nothing is, and nothing else than where the surfaces' pass has drawn.
  const Channel *z = dumps[2].find("Z"), *surfaces = dumps[3].find("A");
  ASSERT_TRUE(z && surfaces);
  size_t hit = 0;
  for (size_t i = 0; i < z->f.size(); ++i) {
    ASSERT_GE(z->f[i], 0);
    ASSERT_LE(z->f[i], 1);
    EXPECT_EQ(z->f[i] > 0, surfaces->f[i] > 0) << i;
    hit += z->f[i] > 0;
  }
  EXPECT_GT(hit, 50u);
  const Channel* map = dumps[4].find("Z");
  ASSERT_NE(map, nullptr);
  EXPECT_GT(dumps[4].width, 512);
  EXPECT_GT(*std::max_element(map->f.begin(), map->f.end()), 0);
}

TEST_F(Dumps, OfIntegers) {
  Job job = job_for(scene("spheres"), 64, 40);
  job.layers = {"object_id"};
  const auto dumps = dump(job, {"layers.layers.object_id"});
  ASSERT_EQ(dumps.size(), 1u);
  const Channel* ids = dumps[0].find("Y");
  ASSERT_NE(ids, nullptr);
  EXPECT_EQ(ids->type, ChannelType::uint32);
  EXPECT_EQ(ids->u, frame["object_id"].values<uint32_t>());
}

// Every format of the table, texel by texel.
TEST(DumpFormats, AreDecoded) {
  const auto decoded = [](VkFormat format, std::vector<uint8_t> bytes) {
    const FloatImage image =
        dump_image({{"p.i", 0, 0}, "p", ImageDesc{"i", format, 1, 1}, -1}, std::as_bytes(std::span(bytes)));
    std::map<std::string, double> values;
    for (const Channel& c : image.channels)
      values[c.name] = c.type == ChannelType::uint32 ? double(c.u.at(0)) : double(c.f.at(0));
    return values;
  };
  using Values = std::map<std::string, double>;
  EXPECT_EQ(decoded(VK_FORMAT_R8G8B8A8_UNORM, {255, 0, 51, 102}),
            (Values{{"R", 1}, {"G", 0}, {"B", 0.2f}, {"A", 0.4f}}));
  EXPECT_EQ(decoded(VK_FORMAT_B8G8R8A8_UNORM, {255, 0, 51, 102}),
            (Values{{"B", 1}, {"G", 0}, {"R", 0.2f}, {"A", 0.4f}}));
  EXPECT_EQ(decoded(VK_FORMAT_R8G8_SNORM, {0x81, 0x80}), (Values{{"R", -1}, {"G", -1}}));
  EXPECT_EQ(decoded(VK_FORMAT_R16_UINT, {0x34, 0x12}), (Values{{"Y", 0x1234}}));
  EXPECT_EQ(decoded(VK_FORMAT_R32_SINT, {0xfe, 0xff, 0xff, 0xff}), (Values{{"Y", -2}}));
  EXPECT_EQ(decoded(VK_FORMAT_R32G32_UINT, {1, 0, 0, 0x80, 2, 0, 0, 0}), (Values{{"R", 2147483649.0}, {"G", 2}}));
  EXPECT_EQ(decoded(VK_FORMAT_R16G16_SFLOAT, {0x00, 0xc0, 0x01, 0x00}), (Values{{"R", -2}, {"G", std::ldexp(1, -24)}}));
  EXPECT_EQ(decoded(VK_FORMAT_D16_UNORM, {0xff, 0xff}), (Values{{"Z", 1}}));
  EXPECT_EQ(decoded(VK_FORMAT_D32_SFLOAT_S8_UINT, {0, 0, 0x80, 0x3f}), (Values{{"Z", 1}}));
  // A 01, B 0000000001, G all, R 0.
  EXPECT_EQ(decoded(VK_FORMAT_A2B10G10R10_UNORM_PACK32, {0x00, 0xfc, 0x1f, 0x40}),
            (Values{{"A", float(1 / 3.0)}, {"B", float(1 / 1023.0)}, {"G", 1}, {"R", 0}}));
  // B 1 (ten bits: 15 << 5), G 2 (16 << 6), R 0.5 (14 << 6).
  const uint32_t packed = (15u << 5) << 22 | (16u << 6) << 11 | (14u << 6);
  EXPECT_EQ(decoded(VK_FORMAT_B10G11R11_UFLOAT_PACK32,
                    {uint8_t(packed), uint8_t(packed >> 8), uint8_t(packed >> 16), uint8_t(packed >> 24)}),
            (Values{{"B", 1}, {"G", 2}, {"R", 0.5}}));
  // Exponent 16: R 256 is 1, G 512 would be 2 (9 bits hold 511), B 1.
  const uint32_t shared = 16u << 27 | 1u << 18 | 511u << 9 | 256u;
  EXPECT_EQ(decoded(VK_FORMAT_E5B9G9R9_UFLOAT_PACK32,
                    {uint8_t(shared), uint8_t(shared >> 8), uint8_t(shared >> 16), uint8_t(shared >> 24)}),
            (Values{{"B", 1 / 256.0}, {"G", 511 / 256.0}, {"R", 1}}));
}

// A slice of one mip.
TEST(DumpFormats, SlicesOfVolumes) {
  std::vector<float> texels(4 * 4 * 2);
  for (size_t i = 0; i < texels.size(); ++i) texels[i] = float(i);
  ImageDesc desc{"volume", VK_FORMAT_R32_SFLOAT, 8, 8};
  desc.kind = ImageKind::d3;
  desc.depth_px = 4;
  desc.mips = 2;
  const FloatImage image = dump_image({{"p.volume", 1, 1}, "p", desc, -1}, std::as_bytes(std::span(texels)));
  EXPECT_EQ(image.width, 4);
  EXPECT_EQ(image.height, 4);
  EXPECT_EQ(image.channels.at(0).f.front(), 16);
  EXPECT_EQ(image.channels.at(0).f.back(), 31);
}

}  // namespace candela::test
