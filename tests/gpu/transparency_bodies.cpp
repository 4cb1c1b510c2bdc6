// What bodies of glass absorb by the effect `refraction`: by their own faces, and not by the file's thickness alone.
#include "glass_fixture.h"

namespace candela::test {

class TransparencyBodies : public GlassTest {
 protected:
  // Of a body of the index of air: nothing is bent or reflected.
  static constexpr double distance_m = 0.5;
  static Json body(double file_thickness_m, glm::dvec3 attenuation = {0.2, 0.5, 0.9}) {
    return glass_material({.thickness_m = file_thickness_m, .attenuation = attenuation, .distance_m = distance_m});
  }
  static void add_box(GltfBuilder& b, glm::dvec3 size, double z, const Json& material) {
    add_shape(b, box(size), material, {0, 0, z});
  }
  // The middle over the wall's colour, as what is left over so many metres.
  static void expect_metres(const GltfBuilder& b, double metres, const std::string& what, const char* backs = "3",
                            int samples = 1, glm::dvec3 attenuation = {0.2, 0.5, 0.9}) {
    Job job = seen(b, samples);
    job.settings = {{"refraction", "backs", backs}};
    const glm::vec4 middle = images_of(job)["beauty"].at<glm::vec4>(glass_width / 2, glass_height / 2);
    expect_color(middle, wall_colour * glm::pow(attenuation, glm::dvec3(metres / distance_m)), what, 2e-3);
  }
};

TEST_F(TransparencyBodies, AbsorbByTheirFaces) {
  for (const double file_m : {0.02, 0.3, 5.0}) {
    GltfBuilder one = dark();
    add_wall(one);
    add_box(one, {1.6, 1.6, 0.3}, 0, body(file_m));
    for (const int samples : {1, 4}) expect_metres(one, 0.3, fmt::format("{} m in the file", file_m), "3", samples);
    expect_metres(one, file_m, "a slab", "0");
    // Behind it another, as a hollow body's far wall.
    add_box(one, {1.6, 1.6, 0.1}, -0.5, body(file_m));
    expect_metres(one, 0.4, fmt::format("two, {} m in the file", file_m));
  }
}

TEST_F(TransparencyBodies, WhatIsBehindSomethingOpaqueDoesNotCount) {
  GltfBuilder b = dark();
  add_box(b, {1.6, 1.6, 0.3}, 0, body(0.02));
  add_wall(b, -0.4);
  add_box(b, {1.6, 1.6, 0.1}, -0.6, body(0.02));
  expect_metres(b, 0.3, "a box behind the wall");
}

// A square is no body, and one that reaches into the wall has no other side before it: the file's thickness counts.
TEST_F(TransparencyBodies, OpenOnesAreSlabs) {
  GltfBuilder square = dark(), sunk = dark();
  add_wall(square), add_wall(sunk);
  add_sheet(square, body(0.2));
  add_box(sunk, {1.6, 1.6, 1}, -0.8, body(0.2));
  expect_metres(square, 0.2, "a square");
  expect_metres(sunk, 0.2, "a box in the wall");
}

}  // namespace candela::test
