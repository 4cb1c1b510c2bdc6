#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/files.h"
#include "image/io.h"
#include "program.h"

// Inputs that nobody should have to trust: what they name, how large they become, what the system refuses.
namespace candela::test::cli_input {
namespace {

namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;

// A quad before the camera whose unlit colour is the texture.
std::string textured(const std::string& image) {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"extensionsUsed":["KHR_materials_unlit","KHR_texture_transform"],
"meshes":[{"primitives":[{"attributes":{"POSITION":1,"TEXCOORD_0":2},"indices":0,"material":0}]}],
"materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0,"extensions":{"KHR_texture_transform":{"offset":[0.06,0]}}}},
"extensions":{"KHR_materials_unlit":{}}}],
"textures":[{"source":0}],"images":[{"uri":")" +
         image + R"("}],
"buffers":[{"byteLength":44,"uri":"data:application/octet-stream;base64,AAABAAIAAAAAAAAAAAAAAAAAAAAAAIA/AAAAAAAAAAAAAAAAAACAPwAAAAA="}],
"bufferViews":[{"buffer":0,"byteLength":6},{"buffer":0,"byteOffset":8,"byteLength":36},{"buffer":0,"byteOffset":8,"byteLength":24}],
"accessors":[{"bufferView":0,"componentType":5123,"count":3,"type":"SCALAR"},
{"bufferView":1,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
{"bufferView":2,"componentType":5126,"count":3,"type":"VEC2"}]})";
}

TEST(NamedFiles, AreBelowTheScenesFolderOrAnAllowedOne) {
  TestFolder folder;
  fs::create_directories(folder / "scene");
  ASSERT_EQ(candela({"render", scene("animated"), "-o", folder / "outside.png", "--size", "16x16"}).code, 0);
  std::ofstream(folder / "scene/a.gltf") << textured("../outside.png");
  const Ended refused = candela({"plan", folder / "scene/a.gltf"});
  EXPECT_EQ(refused.code, 3) << refused.err;
  EXPECT_NE(refused.err.find("--allow-path"), std::string::npos) << refused.err;
  EXPECT_EQ(candela({"plan", folder / "scene/a.gltf", "--allow-path", folder.path().string()}).code, 0);
  EXPECT_EQ(candela({"plan", folder / "scene/a.gltf", "--allow-path", folder / "outside.png"}).code, 2);
  std::ofstream(folder / "scene/suite.json") << R"({"scenes": ["../../scene/a.glb"]})";
  const Ended suite = candela({"bench", folder / "scene/suite.json"});
  EXPECT_EQ(suite.code, 3) << suite.err;
  EXPECT_NE(suite.err.find("suite.json: /scenes/0: "), std::string::npos) << suite.err;
}

// A KTX2 texture gives the pictures that a PNG of its texels gives, in every renderer.
TEST(Textures, OfKtx2GiveThePicturesOfTheirTexels) {
  TestFolder folder;
  const fs::path images = fs::path(CANDELA_SOURCE_DIR) / "tests/images";
  for (const std::string name : {"uastc_modes", "etc1s_alpha"}) {
    for (const std::string ending : {".png", ".ktx2"}) fs::copy(images / (name + ending), folder / (name + ending));
    std::ofstream(folder / "png.gltf") << textured(name + ".png");
    std::string packed = textured(name + ".ktx2");
    const std::string plain = R"("textures":[{"source":0}])", core = R"("KHR_texture_transform"],)";
    packed.replace(packed.find(plain), plain.size(),
                   R"("textures":[{"extensions":{"KHR_texture_basisu":{"source":0}}}])");
    packed.replace(packed.find(core), core.size(),
                   R"("KHR_texture_transform","KHR_texture_basisu"],"extensionsRequired":["KHR_texture_basisu"],)");
    std::ofstream(folder / "ktx2.gltf") << packed;
    for (const std::string command : {"render", "reference"}) {
      for (const std::string scene : {"png", "ktx2"}) {
        const Ended ended =
            candela({command, folder / (scene + ".gltf"), "--size", "48x48", "-o", folder / (scene + ".exr")});
        ASSERT_EQ(ended.code, 0) << ended.err;
      }
      const auto compared = candela({"compare", folder / "png.exr", folder / "ktx2.exr", "--limit", "rmse=0"});
      EXPECT_EQ(compared.code, 0) << command << name << compared.out << compared.err;
      for (const std::string scene : {"png", "ktx2"}) fs::remove(folder / (scene + ".exr"));
    }
  }
}

// The triangle is one of two unlit materials; facts says which there are and what is drawn.
TEST(Variants, AreListedChosenAndRefusedByName) {
  TestFolder folder;
  const std::string file = folder / "shoe.gltf";
  std::string text = textured("absent.png");
  const auto replace = [&](const std::string& old, const std::string& with) {
    ASSERT_NE(text.find(old), std::string::npos) << old;
    text.replace(text.find(old), old.size(), with);
  };
  replace(R"("KHR_texture_transform"])", R"("KHR_texture_transform","KHR_materials_variants"])");
  replace(R"("material":0})",
          R"("material":0,"extensions":{"KHR_materials_variants":{"mappings":[{"material":1,"variants":[1]}]}}})");
  replace(R"("materials":[)",
          R"("extensions":{"KHR_materials_variants":{"variants":[{"name":"beach"},{"name":"street"}]}},"materials":[)");
  replace(R"("extensions":{"KHR_materials_unlit":{}}}],)",
          R"("extensions":{"KHR_materials_unlit":{}}},
{"pbrMetallicRoughness":{"baseColorFactor":[0,0.5,0,1]},"extensions":{"KHR_materials_unlit":{}}}],)");
  std::ofstream(file) << text;
  const auto facts = [&](const Arguments& more) {
    Arguments arguments = {"facts", file, "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Ended ended = candela(arguments);
    EXPECT_EQ(ended.code, 0) << ended.err;
    return nlohmann::json::parse(ended.out, nullptr, false);
  };
  const auto plain = facts({}), street = facts({"--variant", "street"});
  EXPECT_EQ(plain["variants"], (nlohmann::json{"beach", "street"}));
  EXPECT_TRUE(plain["variant"].is_null());
  EXPECT_EQ(plain["materials_used"], nlohmann::json{0});
  EXPECT_EQ(street["variant"], "street");
  EXPECT_EQ(street["materials_used"], nlohmann::json{1});
  for (const auto& extension : plain["extensions"]) EXPECT_EQ(extension["support"], "supported") << extension["name"];
  EXPECT_EQ(plain["extensions"].size(), 3u);
  for (const std::string command : {"render", "reference"}) {
    const std::string out = folder / (command + ".exr");
    const Ended drawn = candela({command, file, "--size", "16x16", "--variant", "street", "-o", out});
    ASSERT_EQ(drawn.code, 0) << drawn.err;
    const auto picture = read_image(out);
    ASSERT_TRUE(picture);
    float brightest = 0;
    for (const float value : picture->find("G")->f) brightest = std::max(brightest, value);
    EXPECT_NEAR(brightest, 0.5f, 0.001f) << command;
  }
  const Ended unknown = candela({"render", file, "--variant", "Street", "-o", folder / "a.png"});
  EXPECT_EQ(unknown.code, 2) << unknown.err;
  EXPECT_NE(unknown.err.find("'Street' is none of the file's variants: beach, street"), std::string::npos)
      << unknown.err;
}

TEST(SpecialFiles, AreRefusedAtOnceAsAnyInput) {
  TestFolder folder;
  const std::string fifo = folder / "fifo", box = scene("unlit-box"), out = folder / "a.exr";
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  for (const std::string& special : {fifo, std::string("/dev/zero"), folder.path().string()})
    for (const Arguments& arguments :
         {Arguments{"plan", special}, Arguments{"plan", box, "--sky", special},
          Arguments{"plan", box, "--look", special}, Arguments{"plan", box, "--config", special},
          Arguments{"reference", special, "-o", out}, Arguments{"bench", "--json", "-", "--from", special},
          Arguments{"bench", "--compare", special, special}, Arguments{"compare", special, special}}) {
      const Ended ended = candela(arguments);
      EXPECT_EQ(ended.code, 3) << arguments[0] << " " << arguments.back() << ": " << ended.err;
      // A sky may be a folder of six faces.
      const bool faces = special == folder.path() && arguments.size() > 2 && arguments[2] == "--sky";
      EXPECT_NE(ended.err.find(faces ? "holds no face of a sky" : "not a regular file"), std::string::npos)
          << arguments[0] << ": " << ended.err;
    }
  fs::rename(fifo, folder / "suite.json");
  EXPECT_EQ(candela({"bench", folder / "suite.json"}).code, 3);
}

TEST(DecodeBudget, IsExitThreeWithFileAndSum) {
  TestFolder folder;
  FloatImage sky{.width = 512, .height = 256};
  for (const char* name : {"R", "G", "B"})
    sky.channels.push_back({name, ChannelType::half, std::vector<float>(512 * 256, 1.0f), {}});
  ASSERT_TRUE(write_exr(folder / "sky.exr", sky));
  const Arguments plan = {"plan", scene("unlit-box"), "--sky", folder / "sky.exr", "--quiet"};
  EXPECT_EQ(candela(plan).code, 0);
  Arguments small = plan;
  small.insert(small.end(), {"--decode-budget-mb", "1"});
  const Ended over = candela(small);
  EXPECT_EQ(over.code, 3) << over.err;
  for (const char* part : {"sky.exr", "the sum of textures, sky and meshes is 3 MiB", "budget of 1 MiB"})
    EXPECT_NE(over.err.find(part), std::string::npos) << over.err;
  EXPECT_EQ(candela({"compare", folder / "sky.exr", folder / "sky.exr", "--decode-budget-mb", "1"}).code, 3);
  EXPECT_EQ(candela({"plan", scene("unlit-box"), "--decode-budget-mb", "0"}).code, 2);
}

TEST(DeepJson, IsRefusedWhereverJsonIsRead) {
  TestFolder folder;
  std::string deep;
  for (int i = 0; i < 1'000'000; ++i) deep += R"({"a":)";
  fs::create_directories(folder / "golden/deep");
  for (const char* name : {"scene.gltf", "look.json", "suite.json", "rows.json", "golden/deep/golden.json"})
    std::ofstream(folder / name) << deep;
  for (const Arguments& arguments :
       {Arguments{"plan", folder / "scene.gltf"}, Arguments{"plan", scene("unlit-box"), "--look", folder / "look.json"},
        Arguments{"bench", folder / "suite.json"}, Arguments{"bench", "--json", "-", "--from", folder / "rows.json"},
        Arguments{"golden", "check", "--root", folder / "golden"}}) {
    const Ended ended = candela(arguments);
    EXPECT_EQ(ended.code, 3) << arguments[0] << ": " << ended.err;
    EXPECT_NE(ended.err.find("nest deeper than 128 levels"), std::string::npos) << arguments[0] << ": " << ended.err;
  }
}

TEST(MissingTexture, IsACheckerInEveryRendererAndExitThreeWhenStrict) {
  TestFolder folder;
  std::ofstream(folder / "a.gltf") << textured("absent.png");
  const Arguments common = {folder / "a.gltf", "--size", "192x192", "--exr-type", "float"};
  Arguments render = {"render", "-o", folder / "render.exr", "--samples", "4"},
            reference = {"reference", "-o", folder / "reference.exr", "--spp", "16"};
  for (Arguments* arguments : {&render, &reference}) {
    arguments->insert(arguments->end(), common.begin(), common.end());
    const Ended ended = candela(*arguments);
    ASSERT_EQ(ended.code, 0) << ended.err;
    EXPECT_NE(ended.err.find("absent.png"), std::string::npos) << ended.err;
    EXPECT_NE(ended.err.find("a magenta and black checker is drawn instead"), std::string::npos) << ended.err;
    arguments->push_back("--strict");
    EXPECT_EQ(candela(*arguments).code, 3);
  }
  const auto a = read_image(folder / "render.exr"), b = read_image(folder / "reference.exr");
  ASSERT_TRUE(a && b);
  int magenta = 0, black = 0, different = 0;
  for (size_t i = 0; i < 192 * 192; ++i) {
    const auto value = [&](const FloatImage& image, const char* channel) { return image.find(channel)->f[i]; };
    if (value(*a, "A") < 1 || value(*b, "A") < 1) continue;
    EXPECT_EQ(value(*a, "G"), 0);
    magenta += value(*a, "R") > 0.9f && value(*a, "B") > 0.9f;
    black += value(*a, "R") < 0.1f;
    const float traced = value(*b, "R");
    if (traced < 0.02f || traced > 0.98f) different += std::abs(value(*a, "R") - traced) > 0.3f;  // off the edges
  }
  EXPECT_GT(magenta, 20);
  EXPECT_GT(black, 20);
  EXPECT_LT(different, 5);
}

// A texture that is cut or damaged within its pixels is drawn as one that is not there: no part of it is seen, and the
// warning names the scene's file, the image and what is wrong.
TEST(DamagedTexture, IsTheCheckerWholeAndNamed) {
  TestFolder folder;
  const fs::path images = fs::path(CANDELA_SOURCE_DIR) / "tests/images";
  const auto draw = [&](const std::string& image, const std::string& extension) {
    std::string text = textured(image);
    if (!extension.empty()) {
      const std::string plain = R"("textures":[{"source":0}])", core = R"("KHR_texture_transform"],)";
      text.replace(text.find(plain), plain.size(),
                   R"("textures":[{"extensions":{")" + extension + R"(":{"source":0}}}])");
      text.replace(text.find(core), core.size(),
                   R"("KHR_texture_transform",")" + extension + R"("],"extensionsRequired":[")" + extension + "\"],");
    }
    std::ofstream(folder / "a.gltf") << text;
    fs::remove(folder / "a.png");
    return Arguments{"render", folder / "a.gltf", "--size", "32x32", "-o", folder / "a.png"};
  };
  const auto picture = [&] {
    const auto bytes = read_file(folder / "a.png");
    const auto image = bytes ? decode_image(*bytes, "a.png") : fail(ErrorKind::input, "a.png", "is not there");
    EXPECT_TRUE(image);
    return image ? image->pixels : std::vector<std::byte>();
  };
  ASSERT_EQ(candela(draw("absent.png", "")).code, 0);
  const auto checker = picture();
  struct Damage {
    std::string file, extension;
    bool cut;  // in the middle of the pixels; else one bit there is another
    std::string says;
  };
  for (const Damage& d : {Damage{"etc1s_alpha.png", "", true, "the file is truncated"},
                          Damage{"etc1s_alpha.png", "", false, "a checksum is wrong"},
                          Damage{"etc1s_alpha.ktx2", "KHR_texture_basisu", true, "the file is truncated"},
                          Damage{"lossless.webp", "EXT_texture_webp", true, "the WebP is truncated"}}) {
    SCOPED_TRACE(d.file + ": " + d.says);
    auto bytes = read_file(images / d.file);
    ASSERT_TRUE(bytes);
    const size_t middle = bytes->size() * 6 / 10;
    for (const bool whole : {true, false}) {
      if (!whole && d.cut) bytes->resize(middle);
      if (!whole && !d.cut) (*bytes)[middle] ^= std::byte(1);
      std::ofstream(folder / d.file, std::ios::binary)
          .write(reinterpret_cast<const char*>(bytes->data()), std::streamsize(bytes->size()));
      Arguments arguments = draw(d.file, d.extension);
      const Ended ended = candela(arguments);
      ASSERT_EQ(ended.code, 0) << ended.err;
      EXPECT_EQ(picture() == checker, !whole);
      EXPECT_EQ(ended.err.find("a.gltf: /images/0: ") != std::string::npos, !whole) << ended.err;
      EXPECT_EQ(ended.err.find(d.says) != std::string::npos, !whole) << ended.err;
      fs::remove(folder / "a.png");
      arguments.push_back("--strict");
      EXPECT_EQ(candela(arguments).code, whole ? 0 : 3);
      EXPECT_EQ(fs::exists(folder / "a.png"), whole);
    }
  }
}

// A user of its own has processes of its own: the limit then counts what the program starts.
TEST(VolumeScatter, IsApproximatedAndSaidSoByFactsAndEveryRenderer) {
  TestFolder folder;
  const std::string file = folder / "wax.gltf";
  std::ofstream(file) << R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"extensionsUsed":["KHR_materials_volume","KHR_materials_volume_scatter"],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":0}]}],
"materials":[{"name":"wax","extensions":{"KHR_materials_volume":{"thicknessFactor":1},
"KHR_materials_volume_scatter":{"multiscatterColor":[0.6,0.2,0.1]}}}],
"buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAAAAAAAAAAAAAIA/AAAAAAAAAAAAAAAAAACAPw=="}],
"bufferViews":[{"buffer":0,"byteLength":36}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,1]}]})";
  const Ended facts = candela({"facts", file, "--json"});
  ASSERT_EQ(facts.code, 0) << facts.err;
  const auto json = nlohmann::json::parse(facts.out);
  bool listed = false;
  for (const auto& use : json["extensions"])
    if (use["name"] == "KHR_materials_volume_scatter") {
      listed = true;
      EXPECT_EQ(use["support"], "approximated");
      EXPECT_EQ(use["users"], nlohmann::json::array({"/materials/0 'wax'"}));
    }
  EXPECT_TRUE(listed) << facts.out;
  for (const char* command : {"render", "reference"}) {
    const Ended ended = candela({command, file, "-o", folder / "wax.png", "--size", "16x16", "--verbose"});
    EXPECT_EQ(ended.code, 0) << ended.err;
    EXPECT_NE(ended.err.find("extension KHR_materials_volume_scatter is approximated"), std::string::npos)
        << command << ": " << ended.err;
  }
}

TEST(Limits, RefusedThreadsAndMemoryAreAnExitCodeAndALine) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can become a user without processes";
  TestFolder folder;
  fs::permissions(folder.path(), fs::perms::all);
  fs::permissions(folder.path().parent_path(), fs::perms::group_exec | fs::perms::others_exec, fs::perm_options::add);
  fs::copy_file(scene("unlit-box"), folder / "box.glb");
  for (const char* command : {"render", "reference"})
    for (const int processes : {1, 3, 5, 9, 64}) {
      const Ended ended = run_program({"setpriv", "--reuid", "61234", "--clear-groups", "prlimit",
                                       "--nproc=" + std::to_string(processes), "--core=0", "env",
                                       "HOME=" + folder.path().string(), CANDELA_PROGRAM, command, folder / "box.glb",
                                       "--size", "16x16", "-o", folder / "a.exr", "--quiet"});
      const int wanted = processes == 64 ? 0 : 6;
      const bool may_do = std::string(command) == "reference";  // the CPU alone needs none beside the first
      EXPECT_TRUE(ended.code == wanted || (may_do && ended.code == 0)) << command << processes << ended.err;
      if (ended.code == 6) {
        EXPECT_NE(ended.err.find("threads"), std::string::npos) << ended.err;
      }
    }
  const Ended memory = run_program({"prlimit", "--as=200000000", "--core=0", CANDELA_PROGRAM, "render",
                                    folder / "box.glb", "--size", "16x16", "-o", folder / "b.exr"});
  EXPECT_EQ(memory.code, 6) << memory.err;
  EXPECT_NE(memory.err.find("take less memory"), std::string::npos) << memory.err;
  EXPECT_NE(memory.err.find("memory ran out while Vulkan started"), std::string::npos) << memory.err;
}

}  // namespace
}  // namespace candela::test::cli_input
