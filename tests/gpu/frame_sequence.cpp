#include <thread>

#include "base/files.h"
#include "frame_fixture.h"
#include "render/sequence.h"
#include "testscenes/procedural_textures.h"

namespace candela::test {
namespace {

// A lit square that moves, and in front of it one with a texture, an alpha mask and another material, which is there
// from frame 3 to frame 5 at 24 frames a second: the plan and the textures change in the middle.
GltfBuilder changing_scene() {
  GltfBuilder b = empty_scene();
  use_materials(b);
  b.use("KHR_node_visibility");
  b.use("KHR_animation_pointer");
  add_light(b, {{"type", "point"}, {"intensity", 30}}, {{"translation", {0.5, 0.5, 2}}});
  const int moving = add_node(b, {{"mesh", add_square_mesh(b, 1, add_material(b, diffuse_material(0.6, 0.4, 0.2)))}});
  const auto png = png_from(8, 8, 4, [](double u, double v) { return glm::dvec4(u, v, 0.5, u + v > 0.7 ? 1.0 : 0.0); });
  std::vector<uint8_t> bytes(png.size());
  std::memcpy(bytes.data(), png.data(), png.size());
  b.json["images"] = {{{"bufferView", b.view(bytes)}, {"mimeType", "image/png"}}};
  b.json["textures"] = {{{"source", 0}}};
  Json masked = diffuse_material(1, 1, 1);
  masked["alphaMode"] = "MASK";
  masked["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}};
  const int square = add_square_mesh(b, 0.5, add_material(b, masked));
  b.json["meshes"][size_t(square)]["primitives"][0]["attributes"]["TEXCOORD_0"] =
      b.accessor<float>("VEC2", {0, 1, 1, 1, 1, 0, 0, 0});
  const int appearing = add_node(b, {{"mesh", square}, {"translation", {0, 0, 0.5}}});
  b.json["nodes"][size_t(appearing)]["extensions"]["KHR_node_visibility"]["visible"] = false;
  const int times = b.accessor<float>("SCALAR", {0, 1});
  const int places = b.accessor<float>("VEC3", {-1, 0, 0, 1, 0, 0});
  const int steps = b.accessor<float>("SCALAR", {0, 2.5f / 24, 5.5f / 24});
  const int shown = b.accessor<uint8_t>("SCALAR", {0, 1, 0});
  const std::string pointer = fmt::format("/nodes/{}/extensions/KHR_node_visibility/visible", appearing);
  b.json["animations"] = {
      {{"samplers",
        {{{"input", times}, {"output", places}}, {{"input", steps}, {"output", shown}, {"interpolation", "STEP"}}}},
       {"channels",
        {{{"sampler", 0}, {"target", {{"node", moving}, {"path", "translation"}}}},
         {{"sampler", 1},
          {"target", {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}}}}}}}};
  return b;
}

// A read-back that memory runs out for when it is encoded, on whichever thread that is.
class EndlessReadback : public gpu::Readback {
 public:
  explicit EndlessReadback(std::shared_ptr<gpu::Readback> real) : real_(std::move(real)) {}
  std::span<const std::byte> bytes() const override {
    if (std::this_thread::get_id() != rendering_) throw std::bad_alloc();
    return real_->bytes();
  }

 private:
  std::shared_ptr<gpu::Readback> real_;
  std::thread::id rendering_ = std::this_thread::get_id();
};

// A session that fails where it is told to.
class FailingSession : public Session {
 public:
  FailingSession(Session& session, std::set<double> begins, std::set<double> finishes, std::set<double> encodes = {})
      : session_(session), begins_(std::move(begins)), finishes_(std::move(finishes)), encodes_(std::move(encodes)) {}
  Expected<FrameTicket> begin(double time_s, bool hash_outputs) override {
    if (begins_.contains(time_s)) return fail(ErrorKind::device, "", "begin refused");
    auto ticket = session_.begin(time_s, hash_outputs);
    if (ticket) times_[*ticket] = time_s;
    return ticket;
  }
  Expected<FrameResult> finish(FrameTicket ticket) override {
    auto result = session_.finish(ticket);
    if (finishes_.contains(times_.at(ticket))) return fail(ErrorKind::device, "", "finish refused");
    if (result && encodes_.contains(times_.at(ticket)))
      for (auto& [resource, readback] : result->readbacks) readback = std::make_shared<EndlessReadback>(readback);
    return result;
  }
  int in_flight() const override { return session_.in_flight(); }
  void set_camera(const CameraRequest& camera) override { session_.set_camera(camera); }
  Expected<void> set_settings(const Job& job) override { return session_.set_settings(job); }
  Expected<bool> reread_look() override { return session_.reread_look(); }
  void reread_shaders() override { session_.reread_shaders(); }
  void take_trees(const Session& earlier) override { session_.take_trees(earlier); }
  std::shared_ptr<const FrameRays> trees() const override { return session_.trees(); }
  Expected<FrameWork> work(double time_s) const override { return session_.work(time_s); }
  const Scene& scene() const override { return session_.scene(); }
  const gpu::Device& device() const override { return session_.device(); }
  const Timings& opening() const override { return session_.opening(); }
  Hash128 scene_content() const override { return session_.scene_content(); }

 private:
  Session& session_;
  std::set<double> begins_, finishes_, encodes_;
  std::map<FrameTicket, double> times_;
};

}  // namespace

class FrameSequence : public FrameTest {
 protected:
  static constexpr int64_t last = 7;

  static Job changing_job() {
    Job job = job_for(write(changing_scene()), 24, 16, 4);
    look(job, {0, 0, 3}, {0, 0, 0});
    return job;
  }
  static SequenceSettings settings_for(const std::string& folder, int in_flight) {
    SequenceSettings settings;
    settings.frames = *parse_frame_list(fmt::format("0-{}", last));
    settings.in_flight = in_flight;
    const std::filesystem::path path = std::filesystem::path(::testing::TempDir()) / folder;
    std::filesystem::remove_all(path);
    std::filesystem::create_directories(path);
    for (const char* ending : {"exr", "png"})
      settings.patterns.push_back(*parse_pattern((path / "%04d.").string() + ending));
    return settings;
  }
  static std::vector<std::vector<std::byte>> files_of(const SequenceSettings& settings) {
    std::vector<std::vector<std::byte>> files;
    for (const int64_t frame : settings.frames)
      for (const FramePattern& pattern : settings.patterns)
        if (std::filesystem::exists(pattern.name(frame))) files.push_back(read_file(pattern.name(frame)).value());
    return files;
  }
};

TEST_F(FrameSequence, BytesAreThoseOfSingleRendersHoweverManyAreInFlight) {
  const Job job = changing_job();
  const FrameRate rate;
  std::vector<Images> alone;
  std::set<std::string> plans;
  for (int64_t frame = 0; frame <= last; ++frame) {
    const auto session = open(job);
    ASSERT_TRUE(session);
    const FrameResult result = render(*session, rate.seconds(frame));
    alone.push_back(images(result));
    plans.insert(result.plan_hash.hex());
  }
  ASSERT_EQ(plans.size(), 3u) << "a material must appear, and a light's maps";
  ASSERT_NE(alone[0]["beauty"], alone[1]["beauty"]);
  for (const size_t most : {1u, 2u, 3u}) {
    const auto session = open(job);
    ASSERT_TRUE(session);
    std::vector<FrameTicket> tickets;
    for (int64_t frame = 0; frame <= last + int64_t(most); ++frame) {
      if (frame <= last) {
        const auto ticket = session->begin(rate.seconds(frame));
        ASSERT_TRUE(ticket) << ticket.error().text();
        tickets.push_back(*ticket);
      }
      const int64_t due = frame + 1 - int64_t(most);
      if (due < 0 || due > last) continue;
      const auto result = session->finish(tickets[size_t(due)]);
      ASSERT_TRUE(result) << result.error().text();
      EXPECT_EQ(images(*result), alone[size_t(due)]) << "frame " << due << ", " << most << " in flight";
      EXPECT_EQ(result->time_s, rate.seconds(due));
    }
  }
}

TEST_F(FrameSequence, FilesAreTheSameHoweverManyAreInFlightAndEncode) {
  const Job job = changing_job();
  std::vector<std::vector<std::byte>> wanted;
  for (const auto& [in_flight, encoders] : {std::pair(1, 1), std::pair(2, 2), std::pair(3, 8)}) {
    SequenceSettings settings = settings_for("candela_sequence", in_flight);
    settings.encoders = encoders;
    std::vector<int64_t> order;
    settings.rendered = [&](int64_t frame, const FrameResult&) -> Expected<void> {
      order.push_back(frame);
      return {};
    };
    const auto session = open(job, wanted_by(settings, job));
    ASSERT_TRUE(session);
    const auto result = run_sequence(*session, job, settings);
    ASSERT_TRUE(result) << result.error().text();
    EXPECT_EQ(result->rendered, size_t(last + 1));
    EXPECT_EQ(result->plan_hashes.size(), 3u);
    EXPECT_EQ(order, std::vector<int64_t>(settings.frames.begin(), settings.frames.end()));
    const auto files = files_of(settings);
    ASSERT_EQ(files.size(), size_t(2 * (last + 1)));
    if (wanted.empty()) wanted = files;
    EXPECT_EQ(files, wanted) << in_flight << " in flight, " << encoders << " encoders";
    EXPECT_LE(result->most_frames, size_t(encoders) + 2);
  }
}

// Of several failures in flight the first frame's is reported, and the frames before it are written.
TEST_F(FrameSequence, AnErrorNamesItsFrameAndEarlierFramesAreWritten) {
  const Job job = changing_job();
  const FrameRate rate;
  struct Case {
    std::set<double> begins, finishes;
    size_t failing;
    std::string message;
  };
  for (const Case& c : {Case{{}, {rate.seconds(3)}, 3, "frame 3: finish refused"},
                        Case{{rate.seconds(3)}, {}, 3, "frame 3: begin refused"},
                        Case{{rate.seconds(4)}, {rate.seconds(3)}, 3, "frame 3: finish refused"}})
    for (const int in_flight : {1, 2, 3}) {
      SequenceSettings settings = settings_for("candela_sequence_error", in_flight);
      settings.encoders = 2 * in_flight;
      const auto session = open(job, wanted_by(settings, job));
      ASSERT_TRUE(session);
      FailingSession failing(*session, c.begins, c.finishes);
      const auto result = run_sequence(failing, job, settings);
      ASSERT_FALSE(result);
      EXPECT_EQ(result.error().message, c.message) << in_flight << " in flight";
      EXPECT_EQ(result.error().kind, ErrorKind::device);
      EXPECT_EQ(files_of(settings).size(), 2 * c.failing) << in_flight << " in flight";
    }
}

// Frames after it are encoded beside it, sooner or later than it fails, and none of them is written.
TEST_F(FrameSequence, AnExceptionWhileEncodingNamesItsFrame) {
  const Job job = changing_job();
  const FrameRate rate;
  for (const int encoders : {1, 8}) {
    SequenceSettings settings = settings_for("candela_sequence_exception", 1);
    settings.encoders = encoders;
    const auto session = open(job, wanted_by(settings, job));
    ASSERT_TRUE(session);
    FailingSession failing(*session, {}, {}, {rate.seconds(2), rate.seconds(4)});
    const auto result = run_sequence(failing, job, settings);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().kind, ErrorKind::out_of_memory);
    EXPECT_TRUE(result.error().message.starts_with("frame 2: out of memory")) << result.error().text();
    EXPECT_EQ(files_of(settings).size(), 2u * 2u) << encoders << " encoders";
    for (const auto& entry :
         std::filesystem::directory_iterator(std::filesystem::path(settings.patterns[0].name(0)).parent_path()))
      EXPECT_FALSE(entry.path().filename().string().starts_with(".")) << entry.path();
  }
}

TEST_F(FrameSequence, AStopWritesTheFramesInFlight) {
  const Job job = changing_job();
  for (const int in_flight : {1, 3}) {
    SequenceSettings settings = settings_for("candela_sequence_stop", in_flight);
    std::atomic<int> stop = 0;
    settings.stop = &stop;
    settings.rendered = [&](int64_t frame, const FrameResult&) -> Expected<void> {
      if (frame == 1) stop = 1;
      return {};
    };
    const auto session = open(job, wanted_by(settings, job));
    ASSERT_TRUE(session);
    const auto result = run_sequence(*session, job, settings);
    ASSERT_TRUE(result) << result.error().text();
    EXPECT_TRUE(result->stopped);
    EXPECT_EQ(result->rendered, size_t(1 + in_flight));
    EXPECT_EQ(files_of(settings).size(), 2 * result->rendered);
  }
}

}  // namespace candela::test
