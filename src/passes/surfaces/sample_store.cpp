#include "passes/surfaces/sample_store.h"

namespace candela {

std::span<const Knob> SampleStoreKnobs::table() {
  static const Knob table[] = {
      {.name = "in",
       .member = &SampleStoreKnobs::in,
       .lowest = automatic,
       .highest = buffer,
       .levels = {automatic},
       .description = "where compute shaders store the samples of a multisampled picture: in the image, or in a buffer "
                      "that fragment shaders copy; auto: in the image if the device can",
       .choices = {"auto", "image", "buffer"},
       .kind = Trades::time,
       .sweep = {image, buffer, automatic}},
  };
  return table;
}

SampleStore declare_sample_store(GraphBuilder& builder, const SceneInputs& scene, std::string_view pass,
                                 std::string& shader) {
  SampleStore store;
  if (scene.samples == 1 || scene.stores_samples) {
    shader += scene.samples == 1 ? "#STORE=1" : "#STORE=2";
    const ImageDesc desc{"color", color_format, scene.width_px, scene.height_px, scene.samples};
    store.color = builder.write(builder.create(desc), Access::storage_image_write);
  } else {
    BufferDesc desc{.name = fmt::format("{}.samples", pass)};
    desc.row_bytes = uint64_t(scene.width_px) * scene.samples * sizeof(glm::vec4);
    desc.size_bytes = scene.height_px * desc.row_bytes;
    store.buffer = builder.write(builder.create(desc), Access::compute_write);
  }
  return store;
}

void push_sample_store(CommandList& commands, const SampleStore& store, OwnInputs& own) {
  own.deformed_before = store.buffer;
  if (store.color) own.number = commands.storage(store.color);
}

}  // namespace candela
