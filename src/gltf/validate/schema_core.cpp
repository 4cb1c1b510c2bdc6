#include "gltf/validate/schema.h"

// The tables of glTF 2.0 itself. Numbers are those of the specification's JSON schema.
namespace candela::validation {
namespace {

constexpr double largest_count = 2147483647.0;  // what the loader's 32-bit indices can name

// Names and notes change no picture; neither do bounds, which the loader computes itself.
Property name_property(std::string_view name = "name") {
  return {.name = name, .shape = Shape::string, .wrong_type = Harm::warning};
}
Property offset_property(std::string_view name = "byteOffset", bool required = false) {
  return {.name = name, .shape = Shape::integer, .required = required, .lowest = 0};
}
Property unit_interval(std::string_view name) {
  return {.name = name, .shape = Shape::number, .lowest = 0, .highest = 1};
}

const ObjectSchema& asset_schema() {
  static const ObjectSchema schema{"asset",
                                   {{.name = "version", .shape = Shape::string, .required = true},
                                    {.name = "minVersion", .shape = Shape::string},
                                    name_property("generator"),
                                    name_property("copyright")}};
  return schema;
}

const ObjectSchema& sparse_indices_schema() {
  static const ObjectSchema schema{
      "sparseIndices",
      {{.name = "bufferView", .shape = Shape::index, .required = true},
       offset_property(),
       {.name = "componentType", .shape = Shape::integer, .required = true, .values = {5121, 5123, 5125}}}};
  return schema;
}

const ObjectSchema& sparse_values_schema() {
  static const ObjectSchema schema{
      "sparseValues", {{.name = "bufferView", .shape = Shape::index, .required = true}, offset_property()}};
  return schema;
}

const ObjectSchema& sparse_schema() {
  static const ObjectSchema schema{
      "sparse",
      {{.name = "count", .shape = Shape::integer, .required = true, .lowest = 1, .highest = largest_count},
       {.name = "indices", .shape = Shape::object, .object = &sparse_indices_schema(), .required = true},
       {.name = "values", .shape = Shape::object, .object = &sparse_values_schema(), .required = true}}};
  return schema;
}

const ObjectSchema& accessor_schema() {
  static const ObjectSchema schema{
      "accessor",
      {{.name = "bufferView", .shape = Shape::index},
       offset_property(),
       {.name = "componentType",
        .shape = Shape::integer,
        .required = true,
        .values = {5120, 5121, 5122, 5123, 5125, 5126},
        .unlisted = Harm::warning},
       {.name = "normalized", .shape = Shape::boolean},
       {.name = "count", .shape = Shape::integer, .required = true, .lowest = 1, .highest = largest_count},
       {.name = "type",
        .shape = Shape::string,
        .required = true,
        .names = {"SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"},
        .unlisted = Harm::warning},
       {.name = "max", .shape = Shape::numbers, .lengths = {1, 2, 3, 4, 9, 16}, .wrong_type = Harm::warning},
       {.name = "min", .shape = Shape::numbers, .lengths = {1, 2, 3, 4, 9, 16}, .wrong_type = Harm::warning},
       {.name = "sparse", .shape = Shape::object, .object = &sparse_schema()},
       name_property()}};
  return schema;
}

const ObjectSchema& buffer_schema() {
  static const ObjectSchema schema{"buffer",
                                   {{.name = "uri", .shape = Shape::string},
                                    {.name = "byteLength", .shape = Shape::integer, .required = true, .lowest = 1},
                                    name_property()}};
  return schema;
}

const ObjectSchema& buffer_view_schema() {
  static const ObjectSchema schema{
      "bufferView",
      {{.name = "buffer", .shape = Shape::index, .required = true},
       offset_property(),
       {.name = "byteLength", .shape = Shape::integer, .required = true, .lowest = 1},
       {.name = "byteStride", .shape = Shape::integer, .lowest = 4, .highest = 252, .multiple_of = 4},
       {.name = "target", .shape = Shape::integer, .values = {34962, 34963}, .unlisted = Harm::warning},
       name_property()}};
  return schema;
}

const ObjectSchema& animation_target_schema() {
  static const ObjectSchema schema{"animationChannelTarget",
                                   {{.name = "node", .shape = Shape::index},
                                    {.name = "path",
                                     .shape = Shape::string,
                                     .required = true,
                                     .names = {"translation", "rotation", "scale", "weights", "pointer"},
                                     .unlisted = Harm::warning}}};
  return schema;
}

const ObjectSchema& animation_channel_schema() {
  static const ObjectSchema schema{
      "animationChannel",
      {{.name = "sampler", .shape = Shape::index, .required = true},
       {.name = "target", .shape = Shape::object, .object = &animation_target_schema(), .required = true}}};
  return schema;
}

const ObjectSchema& animation_sampler_schema() {
  static const ObjectSchema schema{
      "animationSampler",
      {{.name = "input", .shape = Shape::index, .required = true},
       {.name = "interpolation", .shape = Shape::string, .names = {"LINEAR", "STEP", "CUBICSPLINE"}},
       {.name = "output", .shape = Shape::index, .required = true}}};
  return schema;
}

const ObjectSchema& animation_schema() {
  static const ObjectSchema schema{
      "animation",
      {{.name = "channels", .shape = Shape::objects, .object = &animation_channel_schema(), .required = true},
       {.name = "samplers", .shape = Shape::objects, .object = &animation_sampler_schema(), .required = true},
       name_property()}};
  return schema;
}

const ObjectSchema& orthographic_schema() {
  static const ObjectSchema schema{
      "orthographic",
      {{.name = "xmag", .shape = Shape::number, .required = true},
       {.name = "ymag", .shape = Shape::number, .required = true},
       {.name = "zfar", .shape = Shape::number, .required = true, .lowest = 0, .above_lowest = true},
       {.name = "znear", .shape = Shape::number, .required = true, .lowest = 0}}};
  return schema;
}

const ObjectSchema& perspective_schema() {
  static const ObjectSchema schema{
      "perspective",
      {{.name = "aspectRatio", .shape = Shape::number, .lowest = 0, .above_lowest = true},
       {.name = "yfov", .shape = Shape::number, .required = true, .lowest = 0, .above_lowest = true},
       {.name = "zfar", .shape = Shape::number, .lowest = 0, .above_lowest = true},
       {.name = "znear", .shape = Shape::number, .required = true, .lowest = 0, .above_lowest = true}}};
  return schema;
}

const ObjectSchema& camera_schema() {
  static const ObjectSchema schema{
      "camera",
      {{.name = "orthographic", .shape = Shape::object, .object = &orthographic_schema()},
       {.name = "perspective", .shape = Shape::object, .object = &perspective_schema()},
       {.name = "type", .shape = Shape::string, .required = true, .names = {"perspective", "orthographic"}},
       name_property()}};
  return schema;
}

const ObjectSchema& image_schema() {
  static const ObjectSchema schema{
      "image",
      {{.name = "uri", .shape = Shape::string},
       {.name = "mimeType",
        .shape = Shape::string,
        .names = {"image/jpeg", "image/png", "image/webp", "image/ktx2", "image/vnd-ms.dds"},
        .unlisted = Harm::warning},
       {.name = "bufferView", .shape = Shape::index},
       name_property()}};
  return schema;
}

const ObjectSchema& normal_texture_schema() {
  static const ObjectSchema schema{"textureInfo",
                                   {{.name = "index", .shape = Shape::index, .required = true},
                                    {.name = "texCoord", .shape = Shape::index},
                                    {.name = "scale", .shape = Shape::number}}};
  return schema;
}

const ObjectSchema& occlusion_texture_schema() {
  static const ObjectSchema schema{"textureInfo",
                                   {{.name = "index", .shape = Shape::index, .required = true},
                                    {.name = "texCoord", .shape = Shape::index},
                                    unit_interval("strength")}};
  return schema;
}

const ObjectSchema& metallic_roughness_schema() {
  static const ObjectSchema schema{
      "pbrMetallicRoughness",
      {{.name = "baseColorFactor", .shape = Shape::numbers, .lowest = 0, .highest = 1, .lengths = {4}},
       {.name = "baseColorTexture", .shape = Shape::object, .object = &texture_info_schema()},
       unit_interval("metallicFactor"),
       unit_interval("roughnessFactor"),
       {.name = "metallicRoughnessTexture", .shape = Shape::object, .object = &texture_info_schema()}}};
  return schema;
}

// emissiveFactor above 1: what exporters wrote before KHR_materials_emissive_strength, and what they mean is plain.
const ObjectSchema& material_schema() {
  static const ObjectSchema schema{
      "material",
      {{.name = "pbrMetallicRoughness", .shape = Shape::object, .object = &metallic_roughness_schema()},
       {.name = "normalTexture", .shape = Shape::object, .object = &normal_texture_schema()},
       {.name = "occlusionTexture", .shape = Shape::object, .object = &occlusion_texture_schema()},
       {.name = "emissiveTexture", .shape = Shape::object, .object = &texture_info_schema()},
       {.name = "emissiveFactor",
        .shape = Shape::numbers,
        .lowest = 0,
        .highest = 1,
        .lengths = {3},
        .outside = Harm::warning},
       {.name = "alphaMode", .shape = Shape::string, .names = {"OPAQUE", "MASK", "BLEND"}},
       {.name = "alphaCutoff", .shape = Shape::number, .lowest = 0},
       {.name = "doubleSided", .shape = Shape::boolean},
       name_property()}};
  return schema;
}

const ObjectSchema& primitive_schema() {
  static const ObjectSchema schema{"primitive",
                                   {{.name = "attributes", .shape = Shape::index_map, .required = true},
                                    {.name = "indices", .shape = Shape::index},
                                    {.name = "material", .shape = Shape::index},
                                    {.name = "mode", .shape = Shape::integer, .values = {0, 1, 2, 3, 4, 5, 6}},
                                    {.name = "targets", .shape = Shape::index_maps}}};
  return schema;
}

const ObjectSchema& mesh_schema() {
  static const ObjectSchema schema{
      "mesh",
      {{.name = "primitives", .shape = Shape::objects, .object = &primitive_schema(), .required = true},
       {.name = "weights", .shape = Shape::numbers},
       name_property()}};
  return schema;
}

const ObjectSchema& node_schema() {
  static const ObjectSchema schema{
      "node",
      {{.name = "camera", .shape = Shape::index},
       {.name = "children", .shape = Shape::indices, .repeated = Harm::fatal, .unique = true},
       {.name = "skin", .shape = Shape::index},
       {.name = "matrix", .shape = Shape::numbers, .lengths = {16}},
       {.name = "mesh", .shape = Shape::index},
       {.name = "rotation", .shape = Shape::numbers, .lengths = {4}},
       {.name = "scale", .shape = Shape::numbers, .lengths = {3}},
       {.name = "translation", .shape = Shape::numbers, .lengths = {3}},
       {.name = "weights", .shape = Shape::numbers},
       name_property()}};
  return schema;
}

const ObjectSchema& sampler_schema() {
  static const ObjectSchema schema{
      "sampler",
      {{.name = "magFilter", .shape = Shape::integer, .values = {9728, 9729}, .unlisted = Harm::warning},
       {.name = "minFilter",
        .shape = Shape::integer,
        .values = {9728, 9729, 9984, 9985, 9986, 9987},
        .unlisted = Harm::warning},
       {.name = "wrapS", .shape = Shape::integer, .values = {33071, 33648, 10497}, .unlisted = Harm::warning},
       {.name = "wrapT", .shape = Shape::integer, .values = {33071, 33648, 10497}, .unlisted = Harm::warning},
       name_property()}};
  return schema;
}

const ObjectSchema& scene_schema() {
  static const ObjectSchema schema{
      "scene", {{.name = "nodes", .shape = Shape::indices, .repeated = Harm::fatal, .unique = true}, name_property()}};
  return schema;
}

const ObjectSchema& skin_schema() {
  static const ObjectSchema schema{
      "skin",
      {{.name = "inverseBindMatrices", .shape = Shape::index},
       {.name = "skeleton", .shape = Shape::index},
       {.name = "joints", .shape = Shape::indices, .required = true, .empty = Harm::fatal, .unique = true},
       name_property()}};
  return schema;
}

const ObjectSchema& texture_schema() {
  static const ObjectSchema schema{
      "texture",
      {{.name = "sampler", .shape = Shape::index}, {.name = "source", .shape = Shape::index}, name_property()}};
  return schema;
}

}  // namespace

const ObjectSchema& texture_info_schema() {
  static const ObjectSchema schema{
      "textureInfo",
      {{.name = "index", .shape = Shape::index, .required = true}, {.name = "texCoord", .shape = Shape::index}}};
  return schema;
}

const ObjectSchema& root_schema() {
  const auto objects = [](std::string_view name, const ObjectSchema& schema) {
    return Property{.name = name, .shape = Shape::objects, .object = &schema};
  };
  static const ObjectSchema schema{
      "root",
      {{.name = "asset", .shape = Shape::object, .object = &asset_schema(), .required = true},
       {.name = "extensionsUsed", .shape = Shape::strings, .unique = true},
       {.name = "extensionsRequired", .shape = Shape::strings, .unique = true},
       {.name = "scene", .shape = Shape::index},
       objects("accessors", accessor_schema()),
       objects("animations", animation_schema()),
       objects("buffers", buffer_schema()),
       objects("bufferViews", buffer_view_schema()),
       objects("cameras", camera_schema()),
       objects("images", image_schema()),
       objects("materials", material_schema()),
       objects("meshes", mesh_schema()),
       objects("nodes", node_schema()),
       objects("samplers", sampler_schema()),
       objects("scenes", scene_schema()),
       objects("skins", skin_schema()),
       objects("textures", texture_schema())}};
  return schema;
}

}  // namespace candela::validation
