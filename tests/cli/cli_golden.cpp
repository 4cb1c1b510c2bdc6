#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/hash.h"
#include "image/io.h"
#include "image/png_write.h"
#include "program.h"

namespace candela::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

void write_manifest(const TestFolder& folder, const std::string& name, const Json& manifest) {
  fs::create_directories(folder / ("golden/" + name));
  std::ofstream(folder / ("golden/" + name + "/golden.json")) << manifest.dump();
}

Json box_manifest(double exposure = 0) {
  return {{"scene", "scenes/box.glb"}, {"job", {{"size", "32x18"}, {"exposure", exposure}}}, {"frame", 0}};
}

class Golden : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder / "scenes");
    fs::copy_file(scene("unlit-box"), folder / "scenes/box.glb");
    write_manifest(folder, "box", box_manifest());
  }
  Ended check(std::vector<std::string> more = {}) {
    std::vector<std::string> arguments = {"golden", "check", "--root", folder / "golden", "--json", "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return candela(arguments);
  }
  Ended update(const std::string& why, std::vector<std::string> more = {}) {
    std::vector<std::string> arguments = {"golden", "update", "--root", folder / "golden", "--why", why};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return candela(arguments);
  }
  // As if the golden had been made by another driver: its limits say what passes.
  static void made_elsewhere(Json& manifest) { manifest["made"]["driver"] = "another driver"; }
  TestFolder folder;
};

TEST_F(Golden, AMissingOneFailsAnUpdateMakesItAndThenItPasses) {
  const Ended missing = check();
  EXPECT_EQ(missing.code, 1) << missing.err;
  EXPECT_EQ(Json::parse(missing.out)["goldens"][0]["verdict"], "missing golden");
  const Ended made = update("the first picture");
  ASSERT_EQ(made.code, 0) << made.err;
  const std::string changes = bytes_of(folder / "golden/CHANGES.md");
  EXPECT_NE(changes.find("\n\n## the first picture\nbox ("), std::string::npos) << changes;
  const Ended passed = check();
  EXPECT_EQ(passed.code, 0) << passed.err;
  EXPECT_EQ(Json::parse(passed.out)["goldens"][0]["verdict"], "identical");
  // Nothing changed: nothing is written.
  ASSERT_EQ(update("again").code, 0);
  EXPECT_EQ(bytes_of(folder / "golden/CHANGES.md"), changes);
}

TEST_F(Golden, AnUpdateIsOneEntryAndTheNewestIsFirst) {
  write_manifest(folder, "darker", box_manifest(-1));
  ASSERT_EQ(update("first").code, 0);
  write_manifest(folder, "box", box_manifest(1));
  ASSERT_EQ(update("second").code, 0);
  const std::string changes = bytes_of(folder / "golden/CHANGES.md");
  const size_t second = changes.find("\n\n## second\nbox ("), first = changes.find("\n\n## first\nbox, darker (");
  EXPECT_NE(first, std::string::npos) << changes;
  EXPECT_LT(second, first) << changes;
  EXPECT_TRUE(changes.starts_with("# Why goldens changed\n")) << changes;
}

TEST_F(Golden, AGeneratedSceneIsMadeForTheRender) {
  Json generated = box_manifest();
  generated["scene"] = "made:unlit-box";
  write_manifest(folder, "generated", generated);
  ASSERT_EQ(update("first").code, 0);
  const auto committed = read_image(folder / "golden/box/golden.png"),
             made = read_image(folder / "golden/generated/golden.png");
  ASSERT_TRUE(committed && made);
  EXPECT_EQ(committed->channels[0].f, made->channels[0].f);
  EXPECT_EQ(check().code, 0);

  generated["scene"] = "made:castle";
  write_manifest(folder, "generated", generated);
  const Ended unknown = check();
  EXPECT_EQ(unknown.code, 3);
  EXPECT_NE(unknown.err.find("castle"), std::string::npos) << unknown.err;
}

TEST_F(Golden, AChangedPictureFailsWithAReport) {
  ASSERT_EQ(update("first").code, 0);
  Json manifest = Json::parse(bytes_of(folder / "golden/box/golden.json"));
  manifest["job"]["exposure"] = 2;
  write_manifest(folder, "box", manifest);
  const Ended failed = check({"--report", folder / "report"});
  EXPECT_EQ(failed.code, 1) << failed.err;
  EXPECT_EQ(Json::parse(failed.out)["goldens"][0]["verdict"], "failed");
  EXPECT_NE(bytes_of(folder / "report/index.html").find("box"), std::string::npos);
  EXPECT_NE(bytes_of(folder / "report/junit.xml").find("<failure"), std::string::npos);
}

// Limits that let a difference pass, and others that let it pass only with a warning.
TEST_F(Golden, AWarningPassesAndIsSaidEverywhere) {
  ASSERT_EQ(update("first").code, 0);
  Json manifest = Json::parse(bytes_of(folder / "golden/box/golden.json"));
  manifest["job"]["exposure"] = 0.2;
  made_elsewhere(manifest);
  manifest["gate"]["flip_mean"] = 1, manifest["gate"]["flip_p99"] = 1;
  manifest["gate"]["warn"] = {{"flip_mean", 0.9}};
  write_manifest(folder, "box", manifest);
  const Ended silent = check();
  EXPECT_EQ(silent.code, 0) << silent.err;
  EXPECT_EQ(Json::parse(silent.out)["goldens"][0]["verdict"], "similar");
  EXPECT_EQ(Json::parse(silent.out)["warned"], 0);
  EXPECT_NE(silent.out.find("since it was made on"), std::string::npos) << silent.out;

  manifest["gate"]["warn"] = {{"flip_mean", 0.0001}};
  write_manifest(folder, "box", manifest);
  const Ended warned = check({"--report", folder / "report"});
  EXPECT_EQ(warned.code, 0) << warned.err;
  const Json said = Json::parse(warned.out);
  EXPECT_EQ(said["goldens"][0]["verdict"], "warned");
  EXPECT_EQ(said["goldens"][0]["warned"], true);
  EXPECT_EQ(said["goldens"][0]["pass"], true);
  EXPECT_EQ(said["warned"], 1);
  EXPECT_EQ(said["passed"], 1);
  EXPECT_NE(warned.err.find("warning: box: warned"), std::string::npos) << warned.err;
  const std::string junit = bytes_of(folder / "report/junit.xml"), page = bytes_of(folder / "report/index.html");
  EXPECT_NE(junit.find("failures=\"0\""), std::string::npos) << junit;
  EXPECT_NE(junit.find("<system-out>warned; warning: "), std::string::npos) << junit;
  EXPECT_NE(page.find("<section class=\"warned\">"), std::string::npos);
  EXPECT_NE(page.find("1 to look at"), std::string::npos);

  // An update keeps the limits.
  ASSERT_EQ(update("second").code, 0);
  EXPECT_EQ(Json::parse(bytes_of(folder / "golden/box/golden.json"))["gate"]["warn"], Json({{"flip_mean", 0.0001}}));
  manifest["gate"]["warn"] = {{"flip_mean", 2}};
  write_manifest(folder, "box", manifest);
  const Ended beyond = check();
  EXPECT_EQ(beyond.code, 1);
  EXPECT_NE(beyond.out.find("beyond what fails"), std::string::npos) << beyond.out;
}

// One pixel by one code fails where the golden was made; elsewhere it passes the golden's limits, and not --exact. What
// is equal passes all.
TEST_F(Golden, OnItsOwnDeviceTheSamePixelsPassAlone) {
  ASSERT_EQ(update("first").code, 0);
  EXPECT_EQ(check({"--exact"}).code, 0);
  const std::string kept = folder / "golden/box/golden.png";
  auto image = read_image(kept);
  ASSERT_TRUE(image);
  DisplayImage changed{image->width, image->height, 4, 8, {}};
  for (size_t i = 0; i < size_t(image->width) * size_t(image->height); ++i)
    for (const char* channel : {"R", "G", "B", "A"})
      changed.pixels.push_back(std::byte(std::lround(image->find(channel)->f[i] * 255)));
  changed.pixels[4 * 100] ^= std::byte(1);
  ASSERT_TRUE(write_png(kept, changed, {}));
  const Ended own = check();
  EXPECT_EQ(own.code, 1) << own.err;
  EXPECT_NE(own.out.find("on the device that the golden was made on; its limits would call it nearly identical"),
            std::string::npos)
      << own.out;
  Json manifest = Json::parse(bytes_of(folder / "golden/box/golden.json"));
  made_elsewhere(manifest);
  write_manifest(folder, "box", manifest);
  const Ended passed = check(), failed = check({"--exact", "--report", folder / "report"});
  EXPECT_EQ(passed.code, 0) << passed.err;
  EXPECT_EQ(Json::parse(passed.out)["goldens"][0]["verdict"], "nearly identical");
  EXPECT_EQ(failed.code, 1) << failed.err;
  const Json said = Json::parse(failed.out)["goldens"][0];
  EXPECT_EQ(said["verdict"], "failed");
  EXPECT_NE(std::string(said["message"]).find("--exact asks for them; its limits would call it nearly identical"),
            std::string::npos)
      << said;
  EXPECT_NE(bytes_of(folder / "report/junit.xml").find("<failure"), std::string::npos);
}

TEST_F(Golden, OnlyTheAcceptedPictureIsAccepted) {
  ASSERT_EQ(update("first").code, 0);
  Json manifest = Json::parse(bytes_of(folder / "golden/box/golden.json"));
  const std::string here = manifest["made"]["device_class"];
  manifest["job"]["exposure"] = 2;
  manifest["accepted"] = {{here, {hash128("another picture").hex()}}};
  write_manifest(folder, "box", manifest);
  const Ended failed = check({"--report", folder / "report"});
  EXPECT_EQ(failed.code, 1) << failed.err;
  EXPECT_EQ(Json::parse(failed.out)["goldens"][0]["verdict"], "failed");

  const auto actual = read_image(folder / "report/box.png");
  ASSERT_TRUE(actual) << actual.error().text();
  // Of the decoded pixels: size, channel names and the digests of their values.
  std::string digests = "32x18";
  for (const Channel& channel : actual->channels)
    digests += "\n" + channel.name + " " + hash128(std::as_bytes(std::span(channel.f))).hex();
  const std::string digest = hash128(digests).hex();
  EXPECT_EQ(Json::parse(failed.out)["goldens"][0]["digest"], digest);
  manifest["accepted"][here].push_back(digest);
  write_manifest(folder, "box", manifest);
  const Ended passed = check();
  EXPECT_EQ(passed.code, 0) << passed.err << passed.out;
  // Of another class of device it is not.
  manifest["accepted"] = {{"another", manifest["accepted"][here]}};
  write_manifest(folder, "box", manifest);
  EXPECT_EQ(check().code, 1);
}

// What failed in a run is accepted at once, beside what was right before, with who, where and why.
TEST_F(Golden, AcceptKeepsTheFailedPicturesOfARun) {
  write_manifest(folder, "other", box_manifest());
  ASSERT_EQ(update("first").code, 0);
  for (const char* name : {"box", "other"}) {
    Json manifest = Json::parse(bytes_of(folder / ("golden/" + std::string(name) + "/golden.json")));
    manifest["job"]["exposure"] = 2;
    write_manifest(folder, name, manifest);
  }
  const std::string run = folder / "report";
  ASSERT_EQ(check({"--report", run}).code, 1);
  const auto accept = [&](std::vector<std::string> more) {
    std::vector<std::string> arguments = {"golden", "accept", run, "--root", folder / "golden"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return candela(arguments);
  };
  EXPECT_EQ(accept({}).code, 2) << "without a reason";
  EXPECT_EQ(accept({"--why", "brighter", "--filter", "nothing of that name"}).code, 2);
  ASSERT_EQ(accept({"--why", "brighter"}).code, 0);
  EXPECT_EQ(check().code, 0);
  const Json manifest = Json::parse(bytes_of(folder / "golden/other/golden.json"));
  const std::string here = manifest["made"]["device_class"];
  ASSERT_EQ(manifest["accepted"][here].size(), 1u) << manifest;
  const Json& entry = manifest["accepted"][here][0];
  EXPECT_EQ(entry["why"], "brighter");
  for (const char* key : {"device", "driver"}) EXPECT_EQ(entry[key], manifest["made"][key]);
  // A run without failures has nothing to accept.
  ASSERT_EQ(check({"--report", run}).code, 0);
  EXPECT_EQ(accept({"--why", "again"}).code, 2);
  EXPECT_EQ(candela({"golden", "accept", folder / "nowhere", "--why", "x"}).code, 3);
}

TEST_F(Golden, AnotherDeviceClassIsRefusedUnlessMeant) {
  ASSERT_EQ(update("first").code, 0);
  Json manifest = Json::parse(bytes_of(folder / "golden/box/golden.json"));
  const std::string here = manifest["made"]["device_class"];
  manifest["made"]["device_class"] = "another";
  manifest["job"]["exposure"] = 1;
  write_manifest(folder, "box", manifest);
  EXPECT_EQ(update("second").code, 2);
  EXPECT_EQ(update("second", {"--device-class", "another"}).code, 2);
  const std::string theirs = bytes_of(folder / "golden/box/golden.png");
  EXPECT_EQ(update("second", {"--device-class", here}).code, 0);
  // This class has its own picture now, and the other's is as it was.
  EXPECT_EQ(bytes_of(folder / "golden/box/golden.png"), theirs);
  EXPECT_NE(bytes_of(folder / ("golden/box/golden." + here + ".png")), theirs);
  manifest = Json::parse(bytes_of(folder / "golden/box/golden.json"));
  EXPECT_EQ(manifest["made"]["device_class"], "another");
  EXPECT_EQ(manifest["also_made"][here]["device_class"], here);
  EXPECT_EQ(check().code, 0);
}

TEST_F(Golden, AddKeepsAPictureOfAnyJobAndCheckPassesIt) {
  const std::vector<std::string> job = {"--size", "400x200", "--azimuth",      "200", "--fit", "--exposure",
                                        "1",      "--root",  folder / "golden"};
  const auto add = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"golden", "add", folder / "scenes/box.glb"});
    more.insert(more.end(), job.begin(), job.end());
    return candela(more);
  };
  ASSERT_EQ(update("first").code, 0);
  const Ended added = add({"--name", "turned", "--why", "the back of it"});
  ASSERT_EQ(added.code, 0) << added.err;
  const Json manifest = Json::parse(bytes_of(folder / "golden/turned/golden.json"));
  EXPECT_EQ(manifest["scene"], "scenes/box.glb");
  EXPECT_EQ(manifest["job"], Json({{"size", "400x200"},
                                   {"azimuth", 200.0},
                                   {"fit", true},
                                   {"exposure", 1.0},
                                   {"transparency", "auto"},
                                   {"animation", "auto"},
                                   {"framing", "film"},
                                   {"sky", "auto"}}));
  EXPECT_TRUE(manifest["gate"].contains("flip_mean"));
  EXPECT_NE(bytes_of(folder / "golden/CHANGES.md").find("## the back of it\nturned ("), std::string::npos);
  const Ended passed = check();
  EXPECT_EQ(passed.code, 0) << passed.err;
  EXPECT_EQ(Json::parse(passed.out)["passed"], 2);
  // What the golden holds is render's picture.
  ASSERT_EQ(candela({"render", folder / "scenes/box.glb", "--size", "400x200", "--azimuth", "200", "--fit",
                     "--exposure", "1", "-o", folder / "same.png"})
                .code,
            0);
  const auto kept = read_image(folder / "golden/turned/golden.png"), same = read_image(folder / "same.png");
  ASSERT_TRUE(kept && same);
  EXPECT_EQ(kept->channels[0].f, same->channels[0].f);
  EXPECT_EQ(add({"--name", "turned"}).code, 2);
  EXPECT_EQ(add({"--name", "a/b"}).code, 2);
  // A scene that the goldens' repository does not hold.
  const Ended outside = candela({"golden", "add", scene("unlit-box"), "--root", folder / "golden"});
  EXPECT_EQ(outside.code, 2);
  EXPECT_NE(outside.err.find("is not below"), std::string::npos) << outside.err;
}

TEST_F(Golden, AssetsThatAreNotThereAreSkippedAndCounted) {
  write_manifest(folder, "far", {{"scene", "assets:x/y.glb"}, {"job", {{"size", "32x18"}}}});
  ASSERT_EQ(update("first").code, 0);
  const Ended ended = check({"--assets", folder / "nowhere"});
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_EQ(Json::parse(ended.out)["skipped"], 1);
  EXPECT_NE(ended.err.find("skipped"), std::string::npos);
}

TEST_F(Golden, ABrokenManifestIsExitThree) {
  write_manifest(folder, "box", {{"scene", "scenes/box.glb"}, {"job", {{"tonemapp", "agx"}}}});
  const Ended ended = check();
  EXPECT_EQ(ended.code, 3);
  EXPECT_NE(ended.err.find("tonemap"), std::string::npos);
  EXPECT_EQ(check({"--filter", "nosuch"}).code, 2);
}

}  // namespace
}  // namespace candela::test
