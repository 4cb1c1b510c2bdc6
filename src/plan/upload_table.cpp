#include "plan/upload_table.h"

#include <bit>

#include "passes/lights/light_grid.h"
#include "plan/plan_frame.h"

namespace candela {

void upload_table(const PlannedFrame& frame, const GeometryLayout& layout, std::vector<UploadRow>& rows) {
  rows.clear();
  const FrameUpload& u = frame.upload;
  const LightGrid& grid = frame.light_grid;
  using Inputs = SceneInputs;
  using Constants = shared::FrameConstants;
  const auto add = [&](const char* name, BufferHandle Inputs::*input, const auto& values,
                       size_t address = UploadRow::no_address, size_t room = 0) {
    const auto bytes = std::as_bytes(std::span(values));
    rows.push_back({name, input, std::max(bytes.size(), room * sizeof(values[0])), bytes, address});
  };
  // Lists of lights have sizes in powers of two: lights that move do not change the plan.
  const auto add_rounded = [&](const char* name, BufferHandle Inputs::*input, const auto& values, size_t room = 0) {
    if (!values.empty()) add(name, input, values, UploadRow::no_address, std::bit_ceil(std::max(values.size(), room)));
  };
  const auto add_lights = [&] {
    add("frame.lights", u.light_groups.empty() ? &Inputs::lights : &Inputs::posed_lights, u.lights,
        UploadRow::no_address, light_room(uint32_t(u.lights.size())));
    if (!u.light_groups.empty()) {
      add("frame.light_groups", &Inputs::light_groups, u.light_groups);
      rows.push_back({"scene.light_instances",
                      &Inputs::light_instances,
                      frame.light_instances * sizeof(shared::LightInstance),
                      {},
                      UploadRow::no_address});
    }
    add_rounded("frame.light_bounds", &Inputs::light_bounds, grid.bounds);
    add_rounded("frame.light_chunks", &Inputs::light_chunks, grid.chunks);
    if (!grid.chunks.empty()) add("frame.light_dispatch", &Inputs::light_dispatch, std::span(&grid.dispatch, 1));
    add("frame.light_globals", &Inputs::light_globals, grid.globals,
        offsetof(Constants, grid) + offsetof(shared::LightGrid, globals));
  };
  if (u.item_count > 0) {
    rows.push_back({"scene.vertices", &Inputs::vertices, layout.vertex_words * 4, {}, offsetof(Constants, vertices)});
    rows.push_back({"scene.indices", &Inputs::indices, layout.index_count * 4, {}, offsetof(Constants, indices)});
    const bool posed = !u.item_groups.empty();
    if (posed) {
      add("frame.item_groups", &Inputs::item_groups, u.item_groups);
      add("frame.item_spans", &Inputs::item_spans, u.item_spans);
      add("frame.item_sections", &Inputs::item_sections, u.item_sections);
      add("frame.batch_spans", &Inputs::batch_spans, u.batch_spans);
      rows.push_back({"scene.mesh_instances",
                      &Inputs::mesh_instances,
                      frame.mesh_instances * sizeof(shared::WideTransform),
                      {},
                      UploadRow::no_address});
    }
    // What a pass fills, and what the host has posed of it; or the host has posed all.
    const auto add_posed = [&](const char* name, BufferHandle Inputs::*input, size_t address, const char* posed_name,
                               BufferHandle Inputs::*posed_input, const auto& values, size_t count) {
      if (!posed) return add(name, input, values, address);
      add(name, posed_input, values);
      rows.push_back({posed_name, input, count * sizeof(values[0]), {}, address});
      rows.back().to_fill = true;
    };
    add_posed("frame.items", &Inputs::items, offsetof(Constants, items), "posed.items", &Inputs::posed_items, u.items,
              u.item_count);
    add_posed("frame.transforms", &Inputs::transforms, offsetof(Constants, transforms), "posed.transforms",
              &Inputs::posed_transforms, u.transforms, u.transform_count);
    if (frame.lamps.image && frame.lamps.image->apart)
      add_posed("frame.places", &Inputs::places, UploadRow::no_address, "posed.places", &Inputs::posed_places, u.places,
                u.transform_count);
    add("frame.geometries", &Inputs::geometries, u.geometries, offsetof(Constants, geometries));
    add("frame.materials", &Inputs::materials, u.materials, offsetof(Constants, materials));
    add("frame.lobes", &Inputs::lobes, u.lobes, offsetof(Constants, lobes));
    add_lights();
    add("frame.cull_groups", &Inputs::cull_groups, u.groups);
    add("frame.triangle_numbers", &Inputs::triangle_numbers, u.triangle_numbers);
    add("frame.drawn_items", &Inputs::drawn_items, u.drawn_items);
    add_posed("frame.triangle_batches", &Inputs::batches, offsetof(Constants, batches), "posed.triangle_batches",
              &Inputs::posed_batches, u.batches, u.batch_count);
    add("frame.views", &Inputs::views, frame.suns.views.table);
    add("frame.view_regions", &Inputs::view_regions, frame.suns.views.first_command);
    add("frame.suns", &Inputs::suns, frame.suns.shadows);
    // Views of lamps come and go as the camera moves: their buffers have sizes in powers of two.
    const uint32_t views = frame.lamps.image ? frame.lamps.image->room() : 0;
    add_rounded("frame.local_views", &Inputs::lamp_views, frame.lamps.views.table, views);
    add_rounded("frame.local_view_regions", &Inputs::lamp_view_regions, frame.lamps.views.first_command,
                views * frame.draws.batches.size() + 1);
    add("frame.moving", &Inputs::moving, frame.lamps.moving);
    add_rounded("frame.local_lights", &Inputs::lamps, frame.lamps.shadows);
    add("frame.deform_jobs", &Inputs::deform_jobs, u.deform_jobs);
    add("frame.joints", &Inputs::joints, frame.data.joint_matrices);
    add("frame.weights", &Inputs::weights, frame.data.morph_weights);
    add("frame.metaball_bodies", &Inputs::metaball_bodies, u.metaball_bodies);
    add("frame.metaballs", &Inputs::metaballs, u.metaballs);
    add_rounded("frame.metaball_blocks", &Inputs::metaball_blocks, u.metaball_blocks);
    add_rounded("frame.metaball_lists", &Inputs::metaball_lists, u.metaball_lists);
    add("frame.metaballs_before", &Inputs::metaballs_before, u.metaballs_before);
    add("frame.object_mattes", &Inputs::object_mattes, u.object_mattes);
    add("frame.motion", &Inputs::motion, u.motion);
    add("frame.joints_before", &Inputs::joints_before, u.joints_before);
    add("frame.weights_before", &Inputs::weights_before, u.weights_before);
    add("frame.material_mattes", &Inputs::material_mattes, u.material_mattes);
  }
  if (!frame.ray_settings.empty()) add("frame.ray_settings", &Inputs::ray_settings, frame.ray_settings);
  if (frame.rays) {
    // Trees of moving things differ a little in size, which should not change the plan.
    const size_t bytes = frame.rays->bytes.size(), step = std::max<size_t>(std::bit_floor(bytes) / 8, 4096);
    rows.push_back({"frame.trees", &Inputs::trees, (bytes + step - 1) / step * step, frame.rays->bytes});
    rows.back().key = frame.rays->key;
    rows.back().owner = frame.rays;
    if (frame.traced.tree.on_device()) rows.back().on_device = &frame.rays->on_device;
  }
  // The air is lit where there is nothing else.
  if (u.item_count == 0 && (frame.request.draws_fog() || frame.request.draws_volumetric())) add_lights();
  rows.push_back({"frame.constants", &Inputs::constants, sizeof(Constants), std::as_bytes(std::span(&u.constants, 1))});
}

}  // namespace candela
