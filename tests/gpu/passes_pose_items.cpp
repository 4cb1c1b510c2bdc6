#include "instances_fixture.h"
#include "passes/geometry/pose_items.h"
#include "passes_fixture.h"
#include "plan/frame_upload.h"

// Items that a compute pass poses, against the host's in double.
namespace candela::gpu::test {
namespace {

using candela::test::Crowd;

class PoseItemsPass : public PassTest {};

// Each float of each box and transform is the host's, which has it in double and rounds it once.
TEST_F(PoseItemsPass, RoundsToTheHostsFloats) {
  const glm::dvec3 away(2e6, -1000, 3e6);
  const auto scene = Crowd(away, 200).load();
  ASSERT_TRUE(scene) << scene.error().text();
  const InstanceLayout layout = layout_instances(*scene);
  ASSERT_EQ(layout.sets.size(), 3u);
  const GeometryLayout geometry = *layout_geometry(*scene);
  View view;
  view.position = away + glm::dvec3(0.123, 0.456, 3.21);
  for (const double time_s : {0.0, 0.77}) {
    const Pose pose = evaluate_pose(*scene, *choose_animations(*scene, "all"), time_s);
    const auto upload_of = [&](const InstanceLayout* instances) {
      const FrameData data = make_frame_data(*scene, pose, view, 0, {nullptr, instances});
      EXPECT_EQ(data.item_groups.size(), instances ? 2u : 0u) << "blended ones are the host's";
      const DrawList draws = make_draw_list(*scene, pose, data, false);
      FrameUpload upload = make_frame_upload(*scene, pose, view, data, draws, geometry, {}, {});
      add_batches(draws, upload);
      return upload;
    };
    const FrameUpload expected = upload_of(nullptr), given = upload_of(&layout);
    ASSERT_EQ(given.item_count, expected.items.size());
    ASSERT_EQ(given.batch_count, expected.batches.size());
    const std::vector<uint32_t> room(given.item_count * sizeof(shared::Item) / 4),
        transform_room(given.transform_count * sizeof(shared::Transform) / 4),
        batch_room(given.batch_count * sizeof(shared::TriangleBatch) / 4);
    const Buffer groups = upload(given.item_groups, "groups"), spans = upload(given.item_spans, "spans"),
                 sections = upload(given.item_sections, "sections"),
                 instances = upload(pack_mesh_instances(layout), "instances"),
                 batch_spans = upload(given.batch_spans, "batch spans"), posed = upload(given.items, "posed"),
                 posed_transforms = upload(given.transforms, "posed transforms"),
                 posed_batches = upload(given.batches, "posed batches"), items = upload(room, "items"),
                 transforms = upload(transform_room, "transforms"), batches = upload(batch_room, "batches");
    GraphBuilder builder;
    SceneInputs s;
    s.item_groups = import(builder, groups, "groups"), s.item_spans = import(builder, spans, "spans");
    s.item_sections = import(builder, sections, "sections");
    s.mesh_instances = import(builder, instances, "instances");
    s.batch_spans = import(builder, batch_spans, "batch spans");
    s.posed_items = import(builder, posed, "posed");
    s.posed_transforms = import(builder, posed_transforms, "posed transforms");
    s.posed_batches = import(builder, posed_batches, "posed batches");
    const auto to_fill = [&](const Buffer& buffer, const char* name) {
      const BufferHandle handle = builder.import_buffer({name, buffer.size()}, GraphBuilder::Import::to_fill);
      imports[handle.resource] = &buffer;
      return handle;
    };
    s.items = to_fill(items, "items"), s.transforms = to_fill(transforms, "transforms");
    s.batches = to_fill(batches, "batches");
    s.item_count = given.item_count, s.transform_count = given.transform_count, s.batch_count = given.batch_count;
    s.item_group_count = uint32_t(given.item_groups.size()), s.item_span_count = uint32_t(given.item_spans.size());
    s.batch_span_count = uint32_t(given.batch_spans.size());
    const PoseItems::Out out = add(builder, PoseItems{.on_device = true}, {s});
    const BufferHandle item_words = read_words(builder, "items", out.items, items.size()),
                       transform_words = read_words(builder, "transforms", out.transforms, transforms.size()),
                       batch_words = read_words(builder, "batches", out.batches, batches.size());
    const FrameRun run = run_all(builder);
    const auto bytes = [&](BufferHandle words) { return run.readbacks.at(words.resource)->bytes().data(); };
    EXPECT_EQ(std::memcmp(bytes(batch_words), expected.batches.data(), batches.size()), 0);
    size_t boxes = 0, places = 0;
    for (size_t i = 0; i < expected.items.size(); ++i) {
      shared::Item got, wanted = expected.items[i];
      std::memcpy(&got, bytes(item_words) + i * sizeof got, sizeof got);
      ASSERT_LT(got.transform, given.transform_count);
      places += std::memcmp(bytes(transform_words) + got.transform * sizeof(shared::Transform),
                            &expected.transforms[wanted.transform], sizeof(shared::Transform)) != 0;
      wanted.transform = got.transform;
      boxes += std::memcmp(&got, &wanted, sizeof got) != 0;
    }
    EXPECT_EQ(boxes, 0u) << "at " << time_s;
    EXPECT_EQ(places, 0u) << "at " << time_s;
  }
}

}  // namespace
}  // namespace candela::gpu::test
