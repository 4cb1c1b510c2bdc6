// What `candela watch` makes of files that change: replaced, half written, deleted, touched.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <map>
#include <thread>

#include "image/io.h"
#include "program.h"

namespace candela::test {
namespace {

namespace fs = std::filesystem;

// A watch that runs beside the test, on a scene of its own with a look and a path.
class Watched {
 public:
  struct Setup {
    std::vector<std::string> more;                     // words of the command
    bool own_shaders = false;                          // a copy of the shaders, in the folder `shaders`
    bool look = true;                                  // box.look.json, with a path of the camera
    std::map<std::string, std::string> in_place = {};  // files with box.gltf, instead of box.glb
  };
  Watched() : Watched(Setup{}) {}
  explicit Watched(const Setup& setup) {
    if (setup.in_place.empty()) fs::copy_file(scene("unlit-box"), folder_ / "box.glb");
    for (const auto& [name, text] : setup.in_place) write(name, text);
    if (setup.look)
      write("box.look.json", R"({"exposure": {"ev": 0}, "paths": [{"target": "camera", "points": "eye.txt"}]})");
    write("eye.txt", "0 1 4\n");
    std::vector<std::string> words = {
        "watch",     folder_ / (setup.in_place.empty() ? "box.glb" : "box.gltf"), "-o", picture(), "--size", "32x24",
        "--validate"};
    words.insert(words.end(), setup.more.begin(), setup.more.end());
    if (setup.own_shaders) {
      fs::copy(CANDELA_SOURCE_DIR "/shaders", folder_ / "shaders", fs::copy_options::recursive);
      words.insert(words.end(), {"--shader-dir", folder_ / "shaders"});
    }
    process_ = start_candela(words, folder_ / "out.txt", folder_ / "err.txt");
    wait_for("opened: ");
  }
  ~Watched() { end(SIGKILL); }
  Watched(const Watched&) = delete;
  Watched& operator=(const Watched&) = delete;

  std::string picture() const { return folder_ / "out.png"; }
  std::string file(const std::string& name) const { return folder_ / name; }
  void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }
  // As editors do.
  void replace(const std::string& name, const std::string& text) const {
    write(name + "~", text);
    fs::rename(folder_ / (name + "~"), folder_ / name);
  }
  std::string said() const { return bytes_of(folder_ / "err.txt"); }
  // Until the text came once more; false where it does not within a minute or the program ends.
  bool wait_for(const std::string& text) {
    for (int i = 0; i < 6000; ++i) {
      const size_t at = said().find(text, heard_);
      if (at != std::string::npos) {
        heard_ = at + text.size();
        // Up to the end of the line: what follows is said later.
        for (int k = 0; k < 1000 && said().find('\n', heard_) == std::string::npos; ++k)
          std::this_thread::sleep_for(std::chrono::milliseconds(5));
        return true;
      }
      if (process_ > 0 && waitpid(process_, &status_, WNOHANG) == process_) process_ = -1;
      if (process_ < 0 && said().find(text, heard_) == std::string::npos) break;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    ADD_FAILURE() << "'" << text << "' was not said: " << said();
    return false;
  }
  // What happens meanwhile comes to it all at once.
  void hold() const { kill(process_, SIGSTOP); }
  void go_on() const { kill(process_, SIGCONT); }
  // Nothing more is said for a while.
  bool is_quiet() const {
    const std::string before = said();
    std::this_thread::sleep_for(std::chrono::milliseconds(700));
    return said() == before;
  }
  // Its exit code, or 128 + signal.
  int end(int signal = 0) {
    if (process_ > 0) {
      if (signal != 0) kill(process_, signal);
      waitpid(process_, &status_, 0);
      process_ = -1;
    }
    return WIFEXITED(status_) ? WEXITSTATUS(status_) : 128 + WTERMSIG(status_);
  }

 private:
  TestFolder folder_;
  int process_ = -1, status_ = 0;
  size_t heard_ = 0;
};

std::string look_of(double ev) {
  return fmt::format(R"({{"exposure": {{"ev": {}}}, "paths": [{{"target": "camera", "points": "eye.txt"}}]}})", ev);
}

}  // namespace

TEST(Watch, ALookAndAPathGiveThePicturesThatRenderGives) {
  Watched watched;
  const std::string first = bytes_of(watched.picture());
  watched.write("box.look.json", look_of(-2));
  ASSERT_TRUE(watched.wait_for("box.look.json changed: "));
  const std::string darker = bytes_of(watched.picture());
  EXPECT_NE(darker, first);
  watched.replace("eye.txt", "2 1 5\n");
  ASSERT_TRUE(watched.wait_for("eye.txt changed: "));
  const std::string elsewhere = bytes_of(watched.picture());
  EXPECT_NE(elsewhere, darker);
  EXPECT_NE(watched.said().find("RMSE"), std::string::npos);
  const std::string alone = watched.file("alone.png");
  const Ended rendered = candela({"render", watched.file("box.glb"), "-o", alone, "--size", "32x24"});
  ASSERT_EQ(rendered.code, 0) << rendered.err;
  const auto a = read_image(alone), b = read_image(watched.picture());
  ASSERT_TRUE(a && b);
  ASSERT_EQ(a->channels.size(), b->channels.size());
  for (size_t c = 0; c < a->channels.size(); ++c) EXPECT_EQ(a->channels[c].f, b->channels[c].f);
}

TEST(Watch, AThousandTouchesAreNoChangeAndAThousandChangesOne) {
  Watched watched;
  for (int i = 0; i < 1000; ++i) fs::last_write_time(watched.file("box.look.json"), fs::file_time_type::clock::now());
  EXPECT_TRUE(watched.is_quiet()) << watched.said();
  watched.hold();
  for (int i = 0; i < 1000; ++i) watched.replace("box.look.json", look_of(-0.001 * (i + 1)));
  watched.go_on();
  ASSERT_TRUE(watched.wait_for("box.look.json changed: "));
  EXPECT_TRUE(watched.is_quiet()) << watched.said();
  const std::string last = bytes_of(watched.picture());
  watched.write("box.look.json", look_of(-3));
  ASSERT_TRUE(watched.wait_for("box.look.json changed: "));
  EXPECT_NE(bytes_of(watched.picture()), last);
}

TEST(Watch, AHalfWrittenSceneKeepsThePicture) {
  Watched watched;
  const std::string before = bytes_of(watched.picture()), whole = bytes_of(watched.file("box.glb"));
  watched.write("box.glb", whole.substr(0, whole.size() / 2));
  ASSERT_TRUE(watched.wait_for("the last picture stays"));
  EXPECT_EQ(bytes_of(watched.picture()), before);
  // As it was: nothing is made anew. Then another scene.
  watched.write("box.glb", whole);
  ASSERT_TRUE(watched.wait_for("the file is as before again"));
  EXPECT_EQ(bytes_of(watched.picture()), before);
  watched.write("box.glb", bytes_of(scene("orthographic")));
  ASSERT_TRUE(watched.wait_for("box.glb changed: "));
  EXPECT_NE(bytes_of(watched.picture()), before);
}

TEST(Watch, DeletedFilesAreWaitedFor) {
  Watched watched;
  const std::string before = bytes_of(watched.picture());
  for (const std::string name : {"box.look.json", "eye.txt", "box.glb"}) {
    const std::string text = bytes_of(watched.file(name));
    fs::remove(watched.file(name));
    ASSERT_TRUE(watched.wait_for("the last picture stays")) << name;
    EXPECT_EQ(bytes_of(watched.picture()), before) << name;
    watched.replace(name, text);
    ASSERT_TRUE(watched.wait_for("the file is as before again")) << name;
  }
  watched.write("eye.txt", "0 1 8\n");
  ASSERT_TRUE(watched.wait_for("eye.txt changed: "));
  EXPECT_NE(bytes_of(watched.picture()), before);
}

TEST(Watch, MalformedLinesAreSaidAndAnInstancingFileIsRead) {
  Watched watched;
  watched.write("eye.txt", "0 1 4\n0 1\n");
  ASSERT_TRUE(watched.wait_for("eye.txt:2: the line holds 2 numbers"));
  watched.write("eye.txt", "0 1 6\n");
  ASSERT_TRUE(watched.wait_for("eye.txt changed: "));
  const std::string one = bytes_of(watched.picture());
  // The look asks for instances that were not there.
  watched.write("many.txt", "1 1 1\n0 0 0\n0 0 0\n\n1 1 1\n0 45 0\n-2 0 0\n");
  watched.write(
      "box.look.json",
      R"({"paths": [{"target": "camera", "points": "eye.txt"}], "instances": [{"node": "box", "file": "many.txt"}]})");
  ASSERT_TRUE(watched.wait_for("box.look.json changed: "));
  const std::string two = bytes_of(watched.picture());
  EXPECT_NE(two, one);
  watched.write("many.txt", "1 1 1\n0 0 0\n0 0 0\n\n1 1 1\n0 45 0\n2 0 0\n");
  ASSERT_TRUE(watched.wait_for("many.txt changed: "));
  EXPECT_NE(bytes_of(watched.picture()), two);
}

TEST(Watch, AShaderThatDoesNotCompileSaysWhyAndTheNextOneIsDrawn) {
  Watched watched({.more = {}, .own_shaders = true});
  const std::string before = bytes_of(watched.picture());
  const std::string file = watched.file("shaders/tonemap.comp"), text = bytes_of(file);
  std::ofstream(file) << text << "\nthis is no GLSL\n";
  ASSERT_TRUE(watched.wait_for("tonemap.comp"));
  ASSERT_TRUE(watched.wait_for("the last picture stays"));
  EXPECT_EQ(bytes_of(watched.picture()), before);
  // A comment alone: another shader, and the same picture.
  std::ofstream(file) << text << "\n// another\n";
  ASSERT_TRUE(watched.wait_for("tonemap.comp changed: "));
  EXPECT_EQ(bytes_of(watched.picture()), before);
  EXPECT_NE(watched.said().find("the same as the last picture"), std::string::npos) << watched.said();
}

TEST(Watch, ALookThatAppearsBesideTheSceneIsTaken) {
  Watched watched({.more = {}, .look = false});
  const std::string before = bytes_of(watched.picture());
  watched.replace("box.look.json", look_of(-1));
  ASSERT_TRUE(watched.wait_for("box.look.json changed: "));
  EXPECT_NE(bytes_of(watched.picture()), before);
}

// A square with a buffer and a texture in files of their own.
TEST(Watch, BuffersAndTexturesAreOfTheScene) {
  const auto square = [](float half) {
    const float values[] = {-1, -1, 0, 1, -half, 0, half, half, 0, -half, 1, 0, 0, 1, 1, 1, 1, 0, 0, 0};
    const uint16_t index[] = {0, 1, 2, 0, 2, 3};
    return std::string(reinterpret_cast<const char*>(values), sizeof values) +
           std::string(reinterpret_cast<const char*>(index), sizeof index);
  };
  const std::string text = R"({"asset": {"version": "2.0"}, "extensionsUsed": ["KHR_materials_unlit"],
    "buffers": [{"uri": "square.bin", "byteLength": 92}], "images": [{"uri": "texture.png"}],
    "textures": [{"source": 0}], "bufferViews": [{"buffer": 0, "byteLength": 48},
      {"buffer": 0, "byteOffset": 48, "byteLength": 32}, {"buffer": 0, "byteOffset": 80, "byteLength": 12}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [-1, -1, 0], "max": [1, 1, 0]},
      {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
      {"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"}],
    "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}, "extensions": {"KHR_materials_unlit": {}}}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}],
    "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}], "scene": 0})";
  const auto image = [](const std::string& golden) {
    return bytes_of(fs::path(CANDELA_SOURCE_DIR) / "golden" / golden / "golden.png");
  };
  Watched watched(
      {.more = {}, .in_place = {{"box.gltf", text}, {"square.bin", square(1)}, {"texture.png", image("alpha")}}});
  const std::string first = bytes_of(watched.picture());
  watched.replace("texture.png", image("spheres"));
  ASSERT_TRUE(watched.wait_for("texture.png changed: "));
  const std::string textured = bytes_of(watched.picture());
  EXPECT_NE(textured, first);
  // Without its texture, or with a part of it, a scene would be drawn with a checker.
  fs::remove(watched.file("texture.png"));
  ASSERT_TRUE(watched.wait_for("the last picture stays"));
  watched.replace("texture.png", image("spheres").substr(0, 500));
  ASSERT_TRUE(watched.wait_for("the last picture stays"));
  EXPECT_EQ(bytes_of(watched.picture()), textured);
  watched.replace("texture.png", image("spheres"));
  ASSERT_TRUE(watched.wait_for("the file is as before again"));
  watched.replace("square.bin", square(0.5f));
  ASSERT_TRUE(watched.wait_for("square.bin changed: "));
  const std::string small = bytes_of(watched.picture());
  EXPECT_NE(small, textured);
  // What a new scene names may come after it.
  std::string other = text;
  other.replace(other.find("texture.png"), 11, "another.png");
  watched.replace("box.gltf", other);
  ASSERT_TRUE(watched.wait_for("the last picture stays"));
  EXPECT_EQ(bytes_of(watched.picture()), small);
  watched.replace("another.png", image("animated"));
  ASSERT_TRUE(watched.wait_for("box.gltf changed: "));
  EXPECT_NE(bytes_of(watched.picture()), small);
}

// What is missing from the begin is drawn without, and drawn when it comes, whole.
TEST(Watch, ATextureThatIsMissingFromTheBeginIsWaitedFor) {
  const std::string text = R"({"asset": {"version": "2.0"}, "extensionsUsed": ["KHR_materials_unlit"],
    "buffers": [{"uri": "square.bin", "byteLength": 74}], "images": [{"uri": "late.png"}],
    "textures": [{"source": 0}], "bufferViews": [{"buffer": 0, "byteLength": 36},
      {"buffer": 0, "byteOffset": 36, "byteLength": 32}, {"buffer": 0, "byteOffset": 68, "byteLength": 6}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [-1, -1, 0], "max": [1, 1, 0]},
      {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"},
      {"bufferView": 2, "componentType": 5123, "count": 3, "type": "SCALAR"}],
    "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}, "extensions": {"KHR_materials_unlit": {}}}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}],
    "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}], "scene": 0})";
  const float values[] = {-1, -1, 0, 1, -1, 0, 1, 1, 0, 0, 1, 1, 1, 1, 0, 0, 0};
  const uint16_t index[] = {0, 1, 2};
  const std::string triangle = std::string(reinterpret_cast<const char*>(values), sizeof values) +
                               std::string(reinterpret_cast<const char*>(index), sizeof index);
  const std::string image = bytes_of(fs::path(CANDELA_SOURCE_DIR) / "golden/spheres/golden.png");
  Watched watched({.more = {}, .in_place = {{"box.gltf", text}, {"square.bin", triangle}}});
  const std::string checker = bytes_of(watched.picture());
  watched.write("late.png", image.substr(0, 500));
  ASSERT_TRUE(watched.wait_for("the last picture stays"));
  EXPECT_EQ(bytes_of(watched.picture()), checker);
  watched.replace("late.png", image);
  ASSERT_TRUE(watched.wait_for("late.png changed: "));
  EXPECT_NE(bytes_of(watched.picture()), checker);
}

TEST(Watch, EndsAsItIsTold) {
  {
    Watched watched;
    EXPECT_EQ(watched.end(SIGINT), 130);
  }
  {
    Watched watched({.more = {"--stop-after", "2", "--json", "--pass-times"}});
    watched.write("eye.txt", "0 1 7\n");
    EXPECT_EQ(watched.end(), 0) << watched.said();
    EXPECT_NE(bytes_of(watched.file("out.txt")).find("\"picture\":2"), std::string::npos)
        << bytes_of(watched.file("out.txt"));
    EXPECT_NE(bytes_of(watched.file("out.txt")).find("\"gpu_ms\":{"), std::string::npos);
    EXPECT_NE(watched.said().find(" passes; "), std::string::npos) << watched.said();
  }
  const TestFolder folder;
  EXPECT_EQ(candela({"watch", folder / "none.glb", "-o", folder / "a.png"}).code, 3);
  EXPECT_EQ(candela({"watch", scene("unlit-box")}).code, 2);
}

}  // namespace candela::test
