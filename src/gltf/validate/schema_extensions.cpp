#include "gltf/validate/schema.h"

// The tables of the extensions that the loader reads, and the places of those that it only names.
namespace candela::validation {
namespace {

const ObjectSchema& spot_schema() {
  static const ObjectSchema schema{
      "spot",
      {{.name = "innerConeAngle", .shape = Shape::number, .lowest = 0, .highest = 1.5707963267948966},
       {.name = "outerConeAngle",
        .shape = Shape::number,
        .lowest = 0,
        .highest = 1.5707963267948966,
        .above_lowest = true}}};
  return schema;
}

const ObjectSchema& light_schema() {
  static const ObjectSchema schema{
      "light",
      {{.name = "color", .shape = Shape::numbers, .lowest = 0, .highest = 1, .lengths = {3}, .outside = Harm::warning},
       {.name = "intensity", .shape = Shape::number, .lowest = 0},
       {.name = "spot", .shape = Shape::object, .object = &spot_schema()},
       {.name = "type",
        .shape = Shape::string,
        .required = true,
        .names = {"directional", "point", "spot"},
        .unlisted = Harm::warning},
       {.name = "range", .shape = Shape::number, .lowest = 0, .above_lowest = true},
       {.name = "name", .shape = Shape::string, .wrong_type = Harm::warning}}};
  return schema;
}

const ObjectSchema& lights_schema() {
  static const ObjectSchema schema{
      "lights", {{.name = "lights", .shape = Shape::objects, .object = &light_schema(), .required = true}}};
  return schema;
}

const ObjectSchema& node_light_schema() {
  static const ObjectSchema schema{"nodeLight", {{.name = "light", .shape = Shape::index, .required = true}}};
  return schema;
}

const ObjectSchema& light_instances_schema() {
  static const ObjectSchema schema{"lightInstances",
                                   {{.name = "light", .shape = Shape::index, .required = true},
                                    {.name = "attributes", .shape = Shape::index_map, .required = true}}};
  return schema;
}

const ObjectSchema& light_size_schema() {
  static const ObjectSchema schema{"lightSize",
                                   {{.name = "radius", .shape = Shape::number, .required = true, .lowest = 0}}};
  return schema;
}

const ObjectSchema& metaball_schema() {
  static const ObjectSchema schema{
      "metaball",
      {{.name = "node", .shape = Shape::index, .required = true},
       {.name = "radius", .shape = Shape::number, .lowest = 0, .highest = 1e15, .above_lowest = true},
       {.name = "strength", .shape = Shape::number, .lowest = -1e6, .highest = 1e6}}};
  return schema;
}

const ObjectSchema& metaball_noise_schema() {
  static const ObjectSchema schema{
      "metaballNoise",
      {{.name = "amplitude", .shape = Shape::number, .lowest = 0, .highest = 0.99},
       {.name = "frequency", .shape = Shape::number, .lowest = 0, .highest = 1e15, .above_lowest = true}}};
  return schema;
}

const ObjectSchema& metaballs_schema() {
  static const ObjectSchema schema{
      "metaballs",
      {{.name = "threshold", .shape = Shape::number, .lowest = 0, .highest = 1e6},
       {.name = "radius", .shape = Shape::number, .lowest = 0, .highest = 1e15, .above_lowest = true},
       {.name = "strength", .shape = Shape::number, .lowest = -1e6, .highest = 1e6},
       {.name = "cell", .shape = Shape::number, .lowest = 0, .highest = 1e15, .above_lowest = true},
       {.name = "material", .shape = Shape::index},
       {.name = "noise", .shape = Shape::object, .object = &metaball_noise_schema()},
       {.name = "balls",
        .shape = Shape::objects,
        .object = &metaball_schema(),
        .required = true,
        .empty = Harm::fatal}}};
  return schema;
}

const ObjectSchema& texture_transform_schema() {
  static const ObjectSchema schema{"textureTransform",
                                   {{.name = "offset", .shape = Shape::numbers, .lengths = {2}},
                                    {.name = "rotation", .shape = Shape::number},
                                    {.name = "scale", .shape = Shape::numbers, .lengths = {2}},
                                    {.name = "texCoord", .shape = Shape::index}}};
  return schema;
}

const ObjectSchema& emissive_strength_schema() {
  static const ObjectSchema schema{"emissiveStrength",
                                   {{.name = "emissiveStrength", .shape = Shape::number, .lowest = 0}}};
  return schema;
}

const ObjectSchema& ior_schema() {
  static const ObjectSchema schema{"ior", {{.name = "ior", .shape = Shape::number, .lowest = 0}}};
  return schema;
}

const ObjectSchema& specular_schema() {
  static const ObjectSchema schema{
      "specular",
      {{.name = "specularFactor", .shape = Shape::number, .lowest = 0, .highest = 1},
       {.name = "specularTexture", .shape = Shape::object, .object = &texture_info_schema()},
       {.name = "specularColorFactor", .shape = Shape::numbers, .lowest = 0, .lengths = {3}},
       {.name = "specularColorTexture", .shape = Shape::object, .object = &texture_info_schema()}}};
  return schema;
}

const ObjectSchema& blinn_phong_schema() {
  static const ObjectSchema schema{
      "blinnPhong",
      {{.name = "specularFactor", .shape = Shape::numbers, .lowest = 0, .highest = 1, .lengths = {3}},
       {.name = "exponent", .shape = Shape::number, .lowest = 0, .highest = 1e6},
       {.name = "specularTexture", .shape = Shape::object, .object = &texture_info_schema()}}};
  return schema;
}

const ObjectSchema& relief_schema() {
  static const ObjectSchema schema{
      "relief",
      {{.name = "heightTexture", .shape = Shape::object, .object = &texture_info_schema(), .required = true},
       {.name = "depth", .shape = Shape::number, .required = true, .lowest = 0},
       {.name = "silhouettes", .shape = Shape::boolean}}};
  return schema;
}

const ObjectSchema& transmission_schema() {
  static const ObjectSchema schema{
      "transmission",
      {{.name = "transmissionFactor", .shape = Shape::number, .lowest = 0, .highest = 1},
       {.name = "transmissionTexture", .shape = Shape::object, .object = &texture_info_schema()}}};
  return schema;
}

const ObjectSchema& volume_schema() {
  static const ObjectSchema schema{
      "volume",
      {{.name = "thicknessFactor", .shape = Shape::number, .lowest = 0},
       {.name = "thicknessTexture", .shape = Shape::object, .object = &texture_info_schema()},
       {.name = "attenuationDistance", .shape = Shape::number, .lowest = 0, .above_lowest = true},
       {.name = "attenuationColor", .shape = Shape::numbers, .lowest = 0, .highest = 1, .lengths = {3}}}};
  return schema;
}

const ObjectSchema& volume_scatter_schema() {
  static const ObjectSchema schema{
      "volumeScatter",
      {{.name = "multiscatterColorFactor", .shape = Shape::numbers, .lowest = 0, .highest = 1, .lengths = {3}},
       {.name = "multiscatterColor", .shape = Shape::numbers, .lowest = 0, .highest = 1, .lengths = {3}},
       {.name = "multiscatterColorTexture", .shape = Shape::object, .object = &texture_info_schema()},
       {.name = "scatterAnisotropy", .shape = Shape::number, .lowest = -1, .highest = 1}}};
  return schema;
}

const ObjectSchema& dispersion_schema() {
  static const ObjectSchema schema{"dispersion", {{.name = "dispersion", .shape = Shape::number, .lowest = 0}}};
  return schema;
}

const ObjectSchema& empty_schema() {
  static const ObjectSchema schema{"empty", {}};
  return schema;
}

// The loader does not draw the coat, so what is wrong in its values harms nothing.
const ObjectSchema& clearcoat_schema() {
  static const ObjectSchema schema{
      "clearcoat",
      {{.name = "clearcoatFactor",
        .shape = Shape::number,
        .lowest = 0,
        .highest = 1,
        .wrong_type = Harm::warning,
        .outside = Harm::warning},
       {.name = "clearcoatTexture", .shape = Shape::object, .object = &texture_info_schema()},
       {.name = "clearcoatRoughnessFactor",
        .shape = Shape::number,
        .lowest = 0,
        .highest = 1,
        .wrong_type = Harm::warning,
        .outside = Harm::warning},
       {.name = "clearcoatRoughnessTexture", .shape = Shape::object, .object = &texture_info_schema()},
       {.name = "clearcoatNormalTexture", .shape = Shape::any}}};
  return schema;
}

const ObjectSchema& texture_source_schema() {
  static const ObjectSchema schema{"textureSource", {{.name = "source", .shape = Shape::index}}};
  return schema;
}

const ObjectSchema& draco_schema() {
  static const ObjectSchema schema{"draco",
                                   {{.name = "bufferView", .shape = Shape::index, .required = true},
                                    {.name = "attributes", .shape = Shape::index_map, .required = true}}};
  return schema;
}

const ObjectSchema& meshopt_view_schema() {
  static const ObjectSchema schema{
      "meshoptView",
      {{.name = "buffer", .shape = Shape::index, .required = true},
       {.name = "byteOffset", .shape = Shape::integer, .lowest = 0},
       {.name = "byteLength", .shape = Shape::integer, .required = true, .lowest = 1},
       {.name = "byteStride", .shape = Shape::integer, .required = true, .lowest = 1, .highest = 256},
       {.name = "count", .shape = Shape::integer, .required = true, .lowest = 1, .highest = 2147483647.0},
       {.name = "mode", .shape = Shape::string, .required = true, .names = {"ATTRIBUTES", "TRIANGLES", "INDICES"}},
       {.name = "filter",
        .shape = Shape::string,
        .names = {"NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL", "COLOR"}}}};
  return schema;
}

const ObjectSchema& meshopt_buffer_schema() {
  static const ObjectSchema schema{"meshoptBuffer", {{.name = "fallback", .shape = Shape::boolean}}};
  return schema;
}

const ObjectSchema& instancing_schema() {
  static const ObjectSchema schema{"instancing", {{.name = "attributes", .shape = Shape::index_map, .required = true}}};
  return schema;
}

const ObjectSchema& visibility_schema() {
  static const ObjectSchema schema{"visibility", {{.name = "visible", .shape = Shape::boolean}}};
  return schema;
}

const ObjectSchema& pointer_schema() {
  static const ObjectSchema schema{"pointer", {{.name = "pointer", .shape = Shape::string, .required = true}}};
  return schema;
}

}  // namespace

const std::vector<ExtensionSchema>& extension_schemas() {
  static const std::vector<ExtensionSchema> schemas{
      {"KHR_lights_punctual", "root", &lights_schema()},
      {"KHR_lights_punctual", "node", &node_light_schema()},
      {"CANDELA_light_instances", "node", &light_instances_schema()},
      {"CANDELA_light_size", "light", &light_size_schema()},
      {"CANDELA_metaballs", "node", &metaballs_schema()},
      {"CANDELA_materials_blinn_phong", "material", &blinn_phong_schema()},
      {"CANDELA_relief", "material", &relief_schema()},
      {"KHR_texture_transform", "textureInfo", &texture_transform_schema()},
      {"KHR_materials_emissive_strength", "material", &emissive_strength_schema()},
      {"KHR_materials_ior", "material", &ior_schema()},
      {"KHR_materials_specular", "material", &specular_schema()},
      {"KHR_materials_unlit", "material", &empty_schema()},
      {"KHR_materials_clearcoat", "material", &clearcoat_schema()},
      {"KHR_materials_sheen", "material", nullptr},
      {"KHR_materials_transmission", "material", &transmission_schema()},
      {"KHR_materials_volume", "material", &volume_schema()},
      {"KHR_materials_volume_scatter", "material", &volume_scatter_schema()},
      {"KHR_materials_anisotropy", "material", nullptr},
      {"KHR_materials_iridescence", "material", nullptr},
      {"KHR_materials_dispersion", "material", &dispersion_schema()},
      {"KHR_materials_pbrSpecularGlossiness", "material", nullptr},
      {"EXT_texture_webp", "texture", &texture_source_schema()},
      {"KHR_texture_basisu", "texture", &texture_source_schema()},
      {"KHR_draco_mesh_compression", "primitive", &draco_schema()},
      {"EXT_meshopt_compression", "bufferView", &meshopt_view_schema()},
      {"EXT_meshopt_compression", "buffer", &meshopt_buffer_schema()},
      {"KHR_meshopt_compression", "bufferView", &meshopt_view_schema()},
      {"KHR_meshopt_compression", "buffer", &meshopt_buffer_schema()},
      {"EXT_mesh_gpu_instancing", "node", &instancing_schema()},
      {"KHR_node_visibility", "node", &visibility_schema()},
      {"KHR_animation_pointer", "animationChannelTarget", &pointer_schema()},
  };
  return schemas;
}

}  // namespace candela::validation
