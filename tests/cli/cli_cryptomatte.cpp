// Cryptomatte files as a compositor reads them: by channels and attributes alone, with a reader of this test's own.
#include <gtest/gtest.h>

#include <bit>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "image/io.h"
#include "program.h"

namespace candela::test {
namespace {

using Json = nlohmann::json;

struct Mattes {
  FloatImage image;
  std::string key;  // of the layer's attributes
  std::map<std::string, uint32_t> manifest;
  std::vector<std::vector<float>> ranks;  // id, coverage, id, coverage ...

  std::string attribute(const std::string& name) const {
    for (const MetadataEntry& entry : image.metadata)
      if (entry.name == name) return entry.text;
    return {};
  }
  // The matte of one name.
  std::vector<float> matte(const std::string& name) const {
    std::vector<float> values(size_t(image.width) * size_t(image.height));
    const uint32_t id = manifest.at(name);
    for (size_t r = 0; r < ranks.size(); r += 2)
      for (size_t i = 0; i < values.size(); ++i)
        if (std::bit_cast<uint32_t>(ranks[r][i]) == id) values[i] += ranks[r + 1][i];
    return values;
  }
};

// Finds the layer by the attribute that names it, as readers do.
Mattes read_mattes(const std::string& file, const std::string& layer) {
  Mattes mattes;
  auto image = read_image(file);
  EXPECT_TRUE(image);
  if (!image) return mattes;
  mattes.image = std::move(*image);
  for (const MetadataEntry& entry : mattes.image.metadata)
    if (entry.name.starts_with("cryptomatte/") && entry.name.ends_with("/name") && entry.text == layer)
      mattes.key = entry.name.substr(0, entry.name.size() - 4);
  EXPECT_EQ(mattes.attribute(mattes.key + "hash"), "MurmurHash3_32");
  EXPECT_EQ(mattes.attribute(mattes.key + "conversion"), "uint32_to_float32");
  const Json manifest = Json::parse(mattes.attribute(mattes.key + "manifest"));
  for (const auto& [name, hex] : manifest.items()) {
    const std::string digits = hex;
    EXPECT_EQ(digits.size(), 8u);
    mattes.manifest[name] = uint32_t(std::stoul(digits, nullptr, 16));
  }
  for (int level = 0;; ++level) {
    const std::string prefix = fmt::format("{}{:02}.", layer, level);
    if (!mattes.image.find(prefix + "R")) break;
    for (const char* channel : {"R", "G", "B", "A"}) {
      const Channel* found = mattes.image.find(prefix + channel);
      EXPECT_TRUE(found && found->type == ChannelType::float32) << prefix << channel;
      if (found) mattes.ranks.push_back(found->f);
    }
  }
  return mattes;
}

// By id, from the layer of ids and the names that stand beside it.
std::map<std::string, std::vector<float>> mattes_of_ids(const Mattes& mattes, const std::string& layer) {
  std::map<std::string, std::vector<float>> named;
  const Json names = Json::parse(mattes.attribute("candela:" + layer));
  const std::vector<uint32_t>& ids = mattes.image.find(layer + ".X")->u;
  for (size_t i = 0; i < ids.size(); ++i) {
    if (ids[i] == 0xffffffffu) continue;
    std::vector<float>& matte = named[names[std::to_string(ids[i])]];
    matte.resize(ids.size());
    matte[i] = 1;
  }
  return named;
}

}  // namespace

// Of one sample a pixel a matte is what the layer of ids says, and of many the coverages sum to alpha.
TEST(Cryptomatte, MattesByNameAreThoseOfTheIds) {
  const TestFolder folder;
  for (const auto& [command, options] :
       {std::pair<std::string, std::vector<std::string>>{"render", {"--samples", "1"}},
        {"render", {"--samples", "4", "--exr-compression", "b44a"}},
        {"render", {"--samples", "4", "--exr-compression", "piz", "--exr-type", "float"}},
        {"reference", {"--spp", "1", "--sampler", "uniform"}},
        {"reference", {"--spp", "16", "--sampler", "uniform"}}}) {
    SCOPED_TRACE(command + " " + options[1]);
    const std::string file = folder / "mattes.exr";
    std::vector<std::string> arguments = {command,    scene("spheres"),
                                          "--size",   "64x36",
                                          "--sky",    "none",
                                          "--layers", "crypto_object,crypto_material,object_id,material_id",
                                          "-o",       file,
                                          "--quiet"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Ended made = candela(arguments);
    ASSERT_EQ(made.code, 0) << made.err;
    for (const auto& [layer, ids, key] : {std::tuple("crypto_object", "object_id", "cryptomatte/f834d0a/"),
                                          {"crypto_material", "material_id", "cryptomatte/bda530a/"}}) {
      const Mattes mattes = read_mattes(file, layer);
      EXPECT_EQ(mattes.key, key);
      ASSERT_GE(mattes.ranks.size(), 4u);
      const std::vector<float>& alpha = mattes.image.find("A")->f;
      std::vector<float> sums(alpha.size());
      for (size_t r = 0; r < mattes.ranks.size(); r += 2)
        for (size_t i = 0; i < sums.size(); ++i) sums[i] += mattes.ranks[r + 1][i];
      EXPECT_EQ(sums, alpha);
      size_t mixed = 0;  // pixels of two names or more
      for (const float second : mattes.ranks[3]) mixed += second > 0;
      const bool one_sample = options[1] == "1";
      EXPECT_EQ(mixed > 10, !one_sample) << mixed;
      const auto named = mattes_of_ids(mattes, ids);
      EXPECT_GT(named.size(), 3u);
      for (const auto& [name, expected] : named) {
        ASSERT_TRUE(mattes.manifest.contains(name)) << name;
        const std::vector<float> matte = mattes.matte(name);
        if (one_sample) {
          EXPECT_EQ(matte, expected) << name;
        }
        // Where all of a pixel is of one name, its centre is.
        for (size_t i = 0; i < matte.size(); ++i) ASSERT_TRUE(matte[i] != 1 || expected[i] == 1) << name << " " << i;
      }
    }
  }
}

// The same picture written with each compression holds the same bits, or is refused before anything is rendered.
TEST(Cryptomatte, IdsSurviveCompressionOrAreRefused) {
  const TestFolder folder;
  std::optional<Mattes> first;
  for (const std::string compression : {"none", "rle", "zips", "zip", "piz", "b44", "b44a", "pxr24", "dwaa", "dwab"}) {
    const std::string file = folder / (compression + ".exr");
    const Ended made = candela({"render", scene("spheres"), "--size", "48x27", "--layers", "depth,crypto_object",
                                "--exr-compression", compression, "-o", file, "--quiet"});
    if (compression == "pxr24" || compression.starts_with("dwa")) {
      EXPECT_EQ(made.code, 2);
      EXPECT_NE(made.err.find("the ids of crypto_object"), std::string::npos) << made.err;
      EXPECT_EQ(candela({"reference", scene("spheres"), "--layers", "crypto_material", "--exr-compression", compression,
                         "-o", file, "--quiet"})
                    .code,
                2);
      continue;
    }
    ASSERT_EQ(made.code, 0) << made.err;
    const Mattes mattes = read_mattes(file, "crypto_object");
    if (!first) first = mattes;
    ASSERT_EQ(mattes.ranks.size(), first->ranks.size());
    for (size_t r = 0; r < mattes.ranks.size(); ++r)
      EXPECT_EQ(std::memcmp(mattes.ranks[r].data(), first->ranks[r].data(), mattes.ranks[r].size() * 4), 0)
          << compression;
  }
}

// compare takes their levels for ids; the frame of a sequence has the bytes of the frame alone.
TEST(Cryptomatte, IsComparedAsIds) {
  const TestFolder folder;
  const std::string alone = folder / "alone.exr", other = folder / "other.exr";
  for (const auto& [file, animation] : {std::pair(alone, "all"), {other, "none"}})
    ASSERT_EQ(candela({"render", scene("animated"), "--frame", "20", "--animation", animation, "--size", "48x27",
                       "--layers", "crypto_object", "-o", file, "--quiet"})
                  .code,
              0);
  ASSERT_EQ(candela({"sequence", scene("animated"), "--frames", "19-20", "--size", "48x27", "--layers", "crypto_object",
                     "-o", folder / "%04d.exr", "--quiet"})
                .code,
            0);
  EXPECT_EQ(read_mattes(alone, "crypto_object").ranks, read_mattes(folder / "0020.exr", "crypto_object").ranks);
  const Ended compared = candela({"compare", alone, other, "--json"});
  const Json layers = Json::parse(compared.out)["layers"];
  bool seen = false;
  for (const Json& layer : layers) {
    if (layer["name"] != "crypto_object00") continue;
    seen = true;
    EXPECT_EQ(layer["kind"], "ids");
    EXPECT_GT(double(layer["metrics"]["differing"]), 0);
    EXPECT_FALSE(layer["metrics"].contains("rmse"));
  }
  EXPECT_TRUE(seen) << layers.dump();
}

// One level, and two, which hold all that four samples can: the one that both have is compared, and a line says so.
TEST(Cryptomatte, FilesWithDifferentLevelsAreComparedByThoseOfBoth) {
  const TestFolder folder;
  const std::string few = folder / "few.exr", many = folder / "many.exr";
  for (const auto& [file, ranks] : {std::pair(few, "2"), {many, "6"}})
    ASSERT_EQ(candela({"render", scene("spheres"), "--size", "48x27", "--layers", "crypto_object", "--set",
                       std::string("cryptomatte.ranks=") + ranks, "-o", file, "--quiet"})
                  .code,
              0);
  const Ended compared = candela({"compare", few, many, "--json", "--limit", "differing=0", "--hdr-flip", "off"});
  EXPECT_EQ(compared.code, 0) << compared.err;
  EXPECT_NE(compared.err.find("crypto_object has 1 levels in"), std::string::npos) << compared.err;
  EXPECT_EQ(Json::parse(compared.out)["shared_levels"],
            (Json{{{"layer", "crypto_object"}, {"reference", 1}, {"test", 2}, {"compared", 1}}}));
}

// A layer for the screen alone is in no file, and so are the names of its ids.
TEST(Cryptomatte, IsNotNamedWhereOnlyTheScreenShowsIt) {
  const TestFolder folder;
  const std::string file = folder / "a.exr";
  ASSERT_EQ(candela({"render", scene("spheres"), "--size", "48x27", "--view", "crypto_object", "-o", file, "-o",
                     folder / "a.png", "--quiet"})
                .code,
            0);
  const auto image = read_image(file);
  ASSERT_TRUE(image);
  for (const MetadataEntry& entry : image->metadata) EXPECT_FALSE(entry.name.starts_with("cryptomatte/")) << entry.name;
  for (const Channel& channel : image->channels) EXPECT_FALSE(channel.name.starts_with("crypto_")) << channel.name;
}

// A reader that is not ours, where the machine has one.
TEST(Cryptomatte, IsReadByOiiotool) {
  ASSERT_EQ(std::system("oiiotool --help >/dev/null 2>&1"), 0) << "the package openimageio-tools is missing";
  const TestFolder folder;
  const std::string file = folder / "mattes.exr", text = folder / "info.txt";
  ASSERT_EQ(candela({"render", scene("spheres"), "--size", "48x27", "--layers", "crypto_object,crypto_material", "-o",
                     file, "--quiet"})
                .code,
            0);
  ASSERT_EQ(std::system(fmt::format("oiiotool --info -v '{}' > '{}'", file, text).c_str()), 0);
  std::string info, line;
  for (std::ifstream in(text); std::getline(in, line);) info += line + "\n";
  for (const char* part : {"crypto_object00.R", "crypto_object01.A", "crypto_material00.G",
                           "cryptomatte/f834d0a/name: \"crypto_object\"", "cryptomatte/bda530a/manifest"})
    EXPECT_NE(info.find(part), std::string::npos) << part << "\n" << info;
}

}  // namespace candela::test
