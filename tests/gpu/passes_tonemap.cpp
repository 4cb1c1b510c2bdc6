#include <numbers>

#include "passes/post/resolve.h"
#include "passes/post/tonemap.h"
#include "passes_fixture.h"

namespace candela::gpu::test {
namespace {

// The curves again, in double and from their definitions, with none of the shader's code.
glm::dvec3 per_channel(glm::dvec3 c, double (*f)(double)) { return {f(c.x), f(c.y), f(c.z)}; }
double srgb(double c) { return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055; }

glm::dvec3 by_rows(const double (&m)[3][3], glm::dvec3 c) {
  glm::dvec3 out(0);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) out[row] += m[row][column] * c[column];
  return out;
}

glm::dvec3 aces(glm::dvec3 c) {
  constexpr double in[3][3] = {{0.59719, 0.35458, 0.04823}, {0.07600, 0.90834, 0.01566}, {0.02840, 0.13383, 0.83777}};
  constexpr double out[3][3] = {
      {1.60475, -0.53108, -0.07367}, {-0.10208, 1.10813, -0.00605}, {-0.00327, -0.07276, 1.07602}};
  return by_rows(out, per_channel(by_rows(in, c / 0.6), [](double v) {
                   return (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081);
                 }));
}

// Khronos PBR Neutral, as its specification writes it: F90 0.04, start of compression 0.8 - F90, desaturation 0.15.
glm::dvec3 neutral(glm::dvec3 c) {
  const double least = std::min({c.x, c.y, c.z});
  const double offset = least <= 0.08 ? least - least * least / (4 * 0.04) : 0.04;
  c -= offset;
  const double peak = std::max({c.x, c.y, c.z}), start = 0.8 - 0.04;
  if (peak <= start) return c;
  const double compressed = 1 - (1 - start) * (1 - start) / (peak + 1 - 2 * start);
  const double g = 1 / (0.15 * (peak - compressed) + 1);
  return c * (compressed / peak) * g + glm::dvec3(compressed) * (1 - g);
}

constexpr double agx_inset[3][3] = {{0.842479062253094, 0.0784335999999992, 0.0792237451477643},
                                    {0.0423282422610123, 0.878468636469772, 0.0791661274605434},
                                    {0.0423756549057051, 0.0784336, 0.879142973793104}};
constexpr double agx_outset[3][3] = {{1.19687900512017, -0.0980208811401368, -0.0990297440797205},
                                     {-0.0528968517574562, 1.15190312990417, -0.0989611768448433},
                                     {-0.0529716355144438, -0.0980434501171241, 1.15107367264116}};
constexpr double agx_lowest_ev = -12.47393, agx_highest_ev = 4.026069;

// Slope 2 through (10/16.5, 0.5); toe and shoulder powers 3 and 3.25, scaled to reach (0, 0) and (1, 1).
double agx_sigmoid(double x) {
  const double pivot = 10 / 16.5, slope = 2, power = x < pivot ? 3 : 3.25;
  const double run = x < pivot ? pivot : 1 - pivot, rise = 0.5;
  const double scale = slope * run / std::pow(std::pow(slope * run / rise, power) - 1, 1 / power);
  const double u = slope * std::abs(x - pivot) / scale;
  const double y = scale * u / std::pow(1 + std::pow(u, power), 1 / power);
  return x < pivot ? 0.5 - y : 0.5 + y;
}
glm::dvec3 agx(glm::dvec3 c) {
  const glm::dvec3 curved = per_channel(by_rows(agx_inset, c), [](double v) {
    const double ev = std::log2(std::max(v, 1e-10));
    return agx_sigmoid(std::clamp((ev - agx_lowest_ev) / (agx_highest_ev - agx_lowest_ev), 0.0, 1.0));
  });
  return per_channel(by_rows(agx_outset, curved), [](double v) { return std::pow(std::max(v, 0.0), 2.2); });
}

// Between Rec.2020 primaries; matrices column by column, as three.js prints them.
glm::dvec3 agx_2020(glm::dvec3 c) {
  const glm::dmat3 wide(0.6274039, 0.0690973, 0.0163914, 0.3292830, 0.9195404, 0.0880133, 0.0433131, 0.0113623,
                        0.8955953);
  const glm::dmat3 inset(0.856627153315983, 0.137318972929847, 0.11189821299995, 0.0951212405381588, 0.761241990602591,
                         0.0767994186031903, 0.0482516061458583, 0.101439036467562, 0.811302368396859);
  const glm::dmat3 outset(1.1271005818144368, -0.1413297634984383, -0.1413297634984383, -0.1106066430966032,
                          1.157823702216272, -0.1106066430966032, -0.0164939387178346, -0.0164939387178346,
                          1.2519364065950405);
  const glm::dvec3 curved = per_channel(inset * (wide * c), [](double v) {
    const double ev = std::log2(std::max(v, 1e-10));
    return agx_sigmoid(std::clamp((ev - agx_lowest_ev) / (agx_highest_ev - agx_lowest_ev), 0.0, 1.0));
  });
  const glm::dvec3 linear = per_channel(outset * curved, [](double v) { return std::pow(std::max(v, 0.0), 2.2); });
  return glm::max(glm::inverse(wide) * linear, glm::dvec3(0));
}

glm::dvec3 expected(ToneCurve curve, glm::dvec3 c) {
  switch (curve) {
    case ToneCurve::none:
      break;
    case ToneCurve::agx:
      c = agx(c);
      break;
    case ToneCurve::reinhard:
      c = c / (1.0 + c);
      break;
    case ToneCurve::aces:
      c = aces(c);
      break;
    case ToneCurve::neutral:
      c = neutral(c);
      break;
    case ToneCurve::rec709:
      return per_channel(glm::clamp(c, 0.0, 1.0),
                         [](double v) { return v < 0.018 ? 4.5 * v : 1.099 * std::pow(v, 0.45) - 0.099; });
    case ToneCurve::agx_2020:
      c = agx_2020(c);
      break;
    case ToneCurve::reinhard_luminance:
      c = c / (1 + glm::dot(c, glm::dvec3(0.2126, 0.7152, 0.0722)));
      break;
  }
  return per_channel(glm::clamp(c, 0.0, 1.0), srgb);
}

std::vector<glm::vec4> colours() {
  std::vector<glm::vec4> list;
  std::vector<float> values = {0, 1e-10f, 0.5f, 1, 0.08f, 0.0031308f};
  // Where Khronos PBR Neutral begins to compress: 0.76, or 0.8 before the offset is taken off.
  for (const float v : {0.75f, 0.76f, 0.765f, 0.77f, 0.78f, 0.79f, 0.8f, 0.81f, 0.82f, 0.83f}) values.push_back(v);
  for (double e = -4; e <= 5.001; e += 0.125) values.push_back(float(std::pow(10.0, e)));
  for (const float v : values) {
    const float part[] = {0, 0.3f, 1};
    for (const float r : part)
      for (const float g : part)
        for (const float b : part) list.push_back(glm::vec4(v * r, v * g, v * b, 1));  // with saturated primaries
  }
  return list;
}

constexpr ToneCurve curves[] = {ToneCurve::none,   ToneCurve::agx,     ToneCurve::reinhard,
                                ToneCurve::aces,   ToneCurve::neutral, ToneCurve::reinhard_luminance,
                                ToneCurve::rec709, ToneCurve::agx_2020};

}  // namespace

class ToneMapping : public PassTest {
 protected:
  template <class T>
  std::vector<T> map(const std::vector<glm::vec4>& texels, uint32_t width, Tonemap::In in) {
    imports.clear();
    const uint32_t height = uint32_t(texels.size()) / width;
    const Buffer buffer = upload(texels, "texels");
    GraphBuilder builder;
    in.color = make_image(builder, import(builder, buffer, "texels"), width, height);
    in.width_px = width;
    in.height_px = height;
    in.bits = sizeof(T) * 8;
    const ImageHandle display = add(builder, Tonemap{}, in).display;
    const BufferHandle bytes = add_readback(builder, "display", display, uint64_t(width) * height * 4 * sizeof(T));
    return values_of<T>(*run_all(builder).readbacks.at(bytes.resource));
  }
};

// 16-bit output against double: half a code value of rounding, and float arithmetic. The steepest is AgX, where log2's
// error of 3 ulp of a 16 EV range is stretched by slope 2 and two powers: in all less than half a code value more.
TEST_F(ToneMapping, EveryCurveIsWithinOneCodeValueOfDouble) {
  const std::vector<glm::vec4> texels = colours();
  for (const ToneCurve curve : curves) {
    const auto codes = map<uint16_t>(texels, uint32_t(texels.size()), {.curve = curve, .dither = false});
    double worst = 0;
    for (size_t i = 0; i < texels.size(); ++i) {
      const glm::dvec3 e = expected(curve, glm::dvec3(texels[i])) * 65535.0;
      for (int c = 0; c < 3; ++c) {
        worst = std::max(worst, std::abs(codes[4 * i + size_t(c)] - e[c]));
        EXPECT_NEAR(codes[4 * i + size_t(c)], e[c], 1)
            << tone_curve_names()[size_t(curve)] << " of " << texels[i].x << " " << texels[i].y << " " << texels[i].z;
      }
      EXPECT_EQ(codes[4 * i + 3], 65535);
    }
    RecordProperty(std::string(tone_curve_names()[size_t(curve)]) + "_worst_code_error", std::to_string(worst));
  }
}

TEST_F(ToneMapping, GreysRiseWithTheirInputAndStayGrey) {
  std::vector<glm::vec4> greys;
  for (int i = 0; i < 2048; ++i) greys.push_back(glm::vec4(glm::vec3(float(std::exp2(-20 + i * 40.0 / 2047))), 1));
  for (const ToneCurve curve : curves) {
    const auto codes = map<uint16_t>(greys, 2048, {.curve = curve, .dither = false});
    for (size_t i = 0; i < greys.size(); ++i) {
      // The published AgX matrices' rows sum to 1 within 1.7e-4 and those of ACES within 5e-5, so greys tint by 16 of
      // 65,535 code values at most.
      // agx_2020's sum to 1, but for the rounding of its matrices.
      const int tint = curve == ToneCurve::agx || curve == ToneCurve::aces ? 16 : curve == ToneCurve::agx_2020 ? 1 : 0;
      for (size_t c = 1; c < 3; ++c) EXPECT_NEAR(codes[4 * i], codes[4 * i + c], tint);
      if (i > 0) {
        EXPECT_GE(codes[4 * i], codes[4 * i - 4]) << tone_curve_names()[size_t(curve)] << " " << greys[i].x;
      }
    }
    EXPECT_GE(codes[4 * 2047], 64000);
    EXPECT_LE(codes[0], 200);
  }
}

TEST(AgX, OutsetIsTheInverseOfTheInset) {
  for (int column = 0; column < 3; ++column) {
    glm::dvec3 unit(0);
    unit[column] = 1;
    const glm::dvec3 back = by_rows(agx_outset, by_rows(agx_inset, unit));
    EXPECT_LT(glm::length(back - unit), 1e-6);
  }
}

// The sigmoid through the device: a grey of known EV, where inset and outset cancel up to their rows' sums (12 codes).
TEST_F(ToneMapping, AgxSigmoidMeetsItsEndsAndItsPivot) {
  const double pivot_ev = agx_lowest_ev + 10 / 16.5 * (agx_highest_ev - agx_lowest_ev);
  std::vector<glm::vec4> texels;
  for (const double ev : {agx_lowest_ev - 1, agx_lowest_ev, pivot_ev, agx_highest_ev, agx_highest_ev + 1})
    texels.push_back(glm::vec4(glm::vec3(float(std::exp2(ev))), 1));
  const auto codes = map<uint16_t>(texels, 5, {.curve = ToneCurve::agx, .dither = false});
  const double middle = 65535 * srgb(std::pow(0.5, 2.2));
  const double wanted[] = {0, 0, middle, 65535, 65535};
  for (size_t i = 0; i < 5; ++i) EXPECT_NEAR(codes[4 * i], wanted[i], 12) << i;
  EXPECT_NEAR(agx_sigmoid(0), 0, 1e-12);
  EXPECT_NEAR(agx_sigmoid(10 / 16.5), 0.5, 1e-12);
  EXPECT_NEAR(agx_sigmoid(1), 1, 1e-12);
}

TEST_F(ToneMapping, AlphaComesOutStraight) {
  const std::vector<glm::vec4> texels = {{0.2f, 0.1f, 0.05f, 0.5f}, {0.4f, 0.2f, 0.1f, 1}, {0, 0, 0, 0}, {-1, 2, 0, 2}};
  const auto codes = map<uint16_t>(texels, 4, {.curve = ToneCurve::none, .dither = false});
  for (size_t c = 0; c < 3; ++c) EXPECT_EQ(codes[c], codes[4 + c]);
  EXPECT_NEAR(codes[3], 32767.5, 1);
  for (size_t c = 8; c < 12; ++c) EXPECT_EQ(codes[c], 0);
  EXPECT_EQ(codes[12], 0);
  EXPECT_EQ(codes[15], 65535);
}

// At most one code value from the undithered one. The error's variance is a quarter of a squared code value, so the
// mean of 16,384 pixels lies within 5 sigma = 0.02 code values of the truth.
TEST_F(ToneMapping, DitherIsUnbiasedSmallAndSeeded) {
  const uint32_t side = 128;
  for (const float level : {0.0f, 1e-4f, 0.003f, 0.02f, 0.2f, 0.5f, 0.77f, 0.99f, 1.0f}) {
    const std::vector<glm::vec4> texels(side * side, glm::vec4(level, level * 0.7f, level * 0.9f, 1));
    const auto plain = map<uint8_t>(texels, side, {.curve = ToneCurve::none, .dither = false});
    const auto first = map<uint8_t>(texels, side, {.curve = ToneCurve::none, .seed = 1});
    const auto again = map<uint8_t>(texels, side, {.curve = ToneCurve::none, .seed = 1});
    const auto other = map<uint8_t>(texels, side, {.curve = ToneCurve::none, .seed = 2});
    EXPECT_EQ(first, again);
    if (level > 0.01f && level < 0.9f) {
      EXPECT_NE(first, other);
    }
    for (size_t c = 0; c < 3; ++c) {
      const double wanted = 255 * srgb(double(texels[0][int(c)]));
      double sum = 0;
      int farthest = 0;
      for (size_t p = 0; p < texels.size(); ++p) {
        EXPECT_EQ(plain[4 * p + c], plain[c]);
        sum += first[4 * p + c];
        farthest = std::max(farthest, std::abs(int(first[4 * p + c]) - int(plain[c])));
      }
      EXPECT_NEAR(plain[c], wanted, 0.501);
      EXPECT_NEAR(sum / double(texels.size()), wanted, 0.02) << "level " << level << " channel " << c;
      EXPECT_LE(farthest, 1);
    }
    if (HasFailure()) return;
  }
}

TEST_F(ToneMapping, ChannelsAreDitheredIndependently) {
  const std::vector<glm::vec4> texels(64 * 64, glm::vec4(0.2f, 0.2f, 0.2f, 1));
  const auto codes = map<uint8_t>(texels, 64, {.curve = ToneCurve::none});
  size_t differing = 0;
  for (size_t p = 0; p < texels.size(); ++p) differing += codes[4 * p] != codes[4 * p + 1];
  EXPECT_GT(differing, texels.size() / 10);
}

TEST_F(ToneMapping, SixteenBitsAreNotDithered) {
  const std::vector<glm::vec4> texels(64, glm::vec4(0.21f, 0.33f, 0.47f, 1));
  const auto codes = map<uint16_t>(texels, 64, {.curve = ToneCurve::agx, .dither = true});
  for (size_t i = 4; i < codes.size(); ++i) EXPECT_EQ(codes[i], codes[i % 4]);
}

class Resolving : public PassTest {
 protected:
  static constexpr uint32_t width = 19, height = 7, samples = 4;

  // Of sizes from 2^-10 to 2^16.
  static std::vector<glm::vec4> any_samples() {
    Rng rng(1);
    std::vector<glm::vec4> values;
    for (uint32_t i = 0; i < width * height * samples; ++i) {
      const float size = float(std::exp2(rng.uniform(-10, 16)));
      values.push_back(glm::vec4(rng.uniform(), rng.uniform(), rng.uniform(), i % 3 ? 1 : rng.uniform()) * size);
    }
    return values;
  }

  // An image whose samples are those of the buffer.
  ImageHandle draw_samples(GraphBuilder& builder, const Buffer& buffer) {
    const BufferHandle source = import(builder, buffer, "samples");
    builder.begin_pass("draw samples");
    builder.read(source, Access::fragment_read, "samples");
    ImageHandle color = builder.create(ImageDesc{"color", color_format, width, height, samples});
    color = builder.write(color, Access::color_attachment);
    const PipelineHandle pipeline = builder.pipeline(GraphicsPipelineDesc{.vertex_shader = "fullscreen.vert",
                                                                          .fragment_shader = "one_sample.frag",
                                                                          .color_formats = {color_format},
                                                                          .samples = samples});
    const CommandList::Attachment target{color};
    builder.end_pass([=](CommandList& commands) {
      commands.begin_rendering({&target, 1}, {});
      commands.bind(pipeline);
      for (uint32_t s = 0; s < samples; ++s) {
        struct {
          uint64_t source;
          uint32_t width, samples, which;
        } const push{commands.address(source), width, samples, s};
        commands.push(push);
        commands.draw(3);
      }
      commands.end_rendering();
    });
    return color;
  }
};

// The sum runs in sample order without contraction and the division is by a power of two, so the result is known
// exactly.
TEST_F(Resolving, IsTheMeanOfFourSamplesExactly) {
  const std::vector<glm::vec4> values = any_samples();
  const Buffer buffer = upload(values, "samples");
  GraphBuilder builder;
  const ImageHandle color = draw_samples(builder, buffer);
  const ImageHandle resolved = add(builder, Resolve{}, {color, width, height, samples}).resolved;
  const BufferHandle bytes = add_readback(builder, "resolved", resolved, width * height * 16);
  const auto means = values_of<glm::vec4>(*run_all(builder).readbacks.at(bytes.resource));
  for (size_t p = 0; p < means.size(); ++p) {
    const glm::vec4* v = values.data() + p * samples;
    for (int c = 0; c < 4; ++c)
      EXPECT_EQ(means[p][c], (((v[0][c] + v[1][c]) + v[2][c]) + v[3][c]) / 4) << "pixel " << p;
  }
}

// A display value of samples is that of their mean, bit for bit: a frame that shows them alone resolves nothing.
TEST_F(Resolving, TonesOfSamplesAreThoseOfTheirMean) {
  const Buffer buffer = upload(any_samples(), "samples");
  const auto tones = [&](bool resolved) {
    imports.clear();
    GraphBuilder builder;
    Tonemap::In in{draw_samples(builder, buffer), width, height, ToneCurve::agx, 16};
    in.exposure = 0.01f;
    if (resolved)
      in.color = add(builder, Resolve{}, {in.color, width, height, samples}).resolved;
    else
      in.samples = samples;
    const ImageHandle display = add(builder, Tonemap{}, in).display;
    const BufferHandle bytes = add_readback(builder, "display", display, width * height * 8);
    return values_of<uint16_t>(*run_all(builder).readbacks.at(bytes.resource));
  };
  const auto shown = tones(false);
  EXPECT_EQ(shown, tones(true));
  EXPECT_GT(std::ranges::count_if(shown, [](uint16_t code) { return code > 0 && code < 65535; }), width * height);
}

}  // namespace candela::gpu::test
