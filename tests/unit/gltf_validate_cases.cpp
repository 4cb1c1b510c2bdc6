#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "gltf/validate/validate.h"

// Small documents, each wrong in one way: the code, the place and whether the file is refused. They start from one good
// document and replace what a JSON merge patch (RFC 7386) names.
namespace candela {
namespace {

using nlohmann::json;

// A skinned, morphed, animated triangle with a camera, a light and a textured material. 256 bytes hold all its data.
json good() {
  return json::parse(R"({
    "asset": {"version": "2.0"}, "extensionsUsed": ["KHR_lights_punctual"],
    "extensions": {"KHR_lights_punctual": {"lights": [{"type": "spot", "spot": {}}]}},
    "scene": 0, "scenes": [{"nodes": [0, 2]}],
    "nodes": [{"mesh": 0, "skin": 0, "children": [1]}, {"camera": 0},
              {"extensions": {"KHR_lights_punctual": {"light": 0}}, "children": [3]}, {}],
    "cameras": [{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}],
    "skins": [{"joints": [2, 3], "inverseBindMatrices": 4}],
    "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
    "textures": [{"source": 0, "sampler": 0}], "samplers": [{}], "images": [{"uri": "a.png"}],
    "meshes": [{"weights": [0.5], "primitives": [{"material": 0, "indices": 1, "targets": [{"POSITION": 0}],
        "attributes": {"POSITION": 0, "TEXCOORD_0": 5, "JOINTS_0": 2, "WEIGHTS_0": 3}}]}],
    "animations": [{"channels": [{"sampler": 0, "target": {"node": 3, "path": "translation"}}],
                    "samplers": [{"input": 6, "output": 7}]}],
    "accessors": [
      {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1]},
      {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"},
      {"bufferView": 2, "componentType": 5121, "count": 3, "type": "VEC4"},
      {"bufferView": 0, "componentType": 5121, "normalized": true, "count": 3, "type": "VEC4"},
      {"bufferView": 3, "componentType": 5126, "count": 2, "type": "MAT4"},
      {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC2"},
      {"bufferView": 4, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0], "max": [1]},
      {"bufferView": 5, "componentType": 5126, "count": 2, "type": "VEC3"}],
    "bufferViews": [{"buffer": 0, "byteLength": 64, "byteStride": 16}, {"buffer": 0, "byteLength": 8},
                    {"buffer": 0, "byteLength": 12}, {"buffer": 0, "byteLength": 128},
                    {"buffer": 0, "byteLength": 8}, {"buffer": 0, "byteLength": 24}],
    "buffers": [{"uri": "a.bin", "byteLength": 256}]
  })");
}

struct Case {
  const char *name, *patch, *code, *path;
  bool fatal = true;
};

// Values of arrays cannot be patched one by one in RFC 7386; {"#2": x} stands for element 2.
void patch(json& target, const json& change) {
  for (const auto& [key, value] : change.items()) {
    json& item = key[0] == '#' ? target[size_t(std::stoi(key.substr(1)))] : target[key];
    const bool deeper = value.is_object() && !value.empty() && (item.is_object() || item.is_array());
    if (deeper)
      patch(item, value);
    else if (value.is_null())
      target.erase(key);
    else
      item = value;
  }
}

const Case cases[] = {
    {"AssetMissing", R"({"asset": null})", "UNDEFINED_PROPERTY", "/"},
    {"AssetNotObject", R"({"asset": 3})", "TYPE_MISMATCH", "/asset"},
    {"VersionPattern", R"({"asset": {"version": "two"}})", "PATTERN_MISMATCH", "/asset/version"},
    {"VersionMajor", R"({"asset": {"version": "3.0"}})", "UNKNOWN_ASSET_MAJOR_VERSION", "/asset/version"},
    {"VersionMajorFirst", R"({"asset": {"version": "1.0"}, "accessors": 3})", "UNKNOWN_ASSET_MAJOR_VERSION",
     "/asset/version"},
    {"VersionMinor", R"({"asset": {"version": "2.7"}})", "UNKNOWN_ASSET_MINOR_VERSION", "/asset/version", false},
    {"MinVersion", R"({"asset": {"minVersion": "2.9"}})", "ASSET_MIN_VERSION_GREATER_THAN_VERSION",
     "/asset/minVersion"},
    {"Unexpected", R"({"surprise": 1})", "UNEXPECTED_PROPERTY", "/surprise", false},
    {"EmptyArray", R"({"nodes": {"#3": {"children": []}}})", "EMPTY_ENTITY", "/nodes/3/children", false},
    {"EmptyJoints", R"({"skins": {"#0": {"joints": []}}})", "EMPTY_ENTITY", "/skins/0/joints"},
    {"ArrayOfNumbers", R"({"nodes": [1, 2]})", "ARRAY_TYPE_MISMATCH", "/nodes"},
    {"NotAnArray", R"({"meshes": {}})", "TYPE_MISMATCH", "/meshes"},
    {"NegativeIndex", R"({"nodes": {"#0": {"mesh": -1}}})", "INVALID_INDEX", "/nodes/0/mesh"},
    {"FractionalIndex", R"({"nodes": {"#0": {"mesh": 0.5}}})", "TYPE_MISMATCH", "/nodes/0/mesh"},
    {"StringIndex", R"({"nodes": {"#0": {"mesh": "0"}}})", "TYPE_MISMATCH", "/nodes/0/mesh"},
    {"HugeIndex", R"({"nodes": {"#0": {"mesh": 4294967296}}})", "INVALID_INDEX", "/nodes/0/mesh"},
    {"WrongLength", R"({"nodes": {"#3": {"scale": [1, 2]}}})", "ARRAY_LENGTH_NOT_IN_LIST", "/nodes/3/scale"},
    {"FactorOutside", R"({"materials": {"#0": {"pbrMetallicRoughness": {"metallicFactor": 7}}}})", "VALUE_NOT_IN_RANGE",
     "/materials/0/pbrMetallicRoughness/metallicFactor"},
    {"FactorRounded", R"({"materials": {"#0": {"pbrMetallicRoughness": {"metallicFactor": 1.0000001}}}})",
     "VALUE_NOT_IN_RANGE", "/materials/0/pbrMetallicRoughness/metallicFactor", false},
    {"AlphaMode", R"({"materials": {"#0": {"alphaMode": "GLASS"}}})", "VALUE_NOT_IN_LIST", "/materials/0/alphaMode"},
    {"Filter", R"({"samplers": [{"minFilter": 1}]})", "VALUE_NOT_IN_LIST", "/samplers/0/minFilter", false},
    {"DuplicateChild", R"({"nodes": {"#0": {"children": [1, 1]}}})", "DUPLICATE_ELEMENTS", "/nodes/0/children/1"},
    {"Mesh", R"({"nodes": {"#0": {"mesh": 9}}})", "UNRESOLVED_REFERENCE", "/nodes/0/mesh"},
    {"Camera", R"({"nodes": {"#1": {"camera": 1}}})", "UNRESOLVED_REFERENCE", "/nodes/1/camera"},
    {"Skin", R"({"nodes": {"#0": {"skin": 1}}})", "UNRESOLVED_REFERENCE", "/nodes/0/skin"},
    {"Child", R"({"nodes": {"#0": {"children": [4]}}})", "UNRESOLVED_REFERENCE", "/nodes/0/children/0"},
    {"Scene", R"({"scene": 1})", "UNRESOLVED_REFERENCE", "/scene"},
    {"SceneNode", R"({"scenes": [{"nodes": [8]}]})", "UNRESOLVED_REFERENCE", "/scenes/0/nodes/0"},
    {"Joint", R"({"skins": {"#0": {"joints": [2, 9]}}})", "UNRESOLVED_REFERENCE", "/skins/0/joints/1"},
    {"Material", R"({"meshes": {"#0": {"primitives": {"#0": {"material": 1}}}}})", "UNRESOLVED_REFERENCE",
     "/meshes/0/primitives/0/material"},
    {"Texture", R"({"materials": {"#0": {"emissiveTexture": {"index": 1}}}})", "UNRESOLVED_REFERENCE",
     "/materials/0/emissiveTexture/index"},
    {"TextureSource", R"({"textures": [{"source": 1}]})", "UNRESOLVED_REFERENCE", "/textures/0/source"},
    {"Light", R"({"nodes": {"#2": {"extensions": {"KHR_lights_punctual": {"light": 1}}}}})", "UNRESOLVED_REFERENCE",
     "/nodes/2/extensions/KHR_lights_punctual/light"},
    {"LightsAbsent", R"({"extensions": null})", "UNSATISFIED_DEPENDENCY", "/nodes/2/extensions/KHR_lights_punctual"},
    {"Loop", R"({"nodes": {"#3": {"children": [2]}}})", "NODE_LOOP", "/nodes/2"},
    {"OwnChild", R"({"nodes": {"#1": {"children": [1]}, "#0": {"children": null}}})", "NODE_LOOP", "/nodes/1"},
    {"TwoParents", R"({"nodes": {"#2": {"children": [1]}}})", "NODE_PARENT_OVERRIDE", "/nodes/2/children/0"},
    {"SceneNonRoot", R"({"scenes": [{"nodes": [1]}]})", "SCENE_NON_ROOT_NODE", "/scenes/0/nodes/0"},
    {"MatrixAndTrs", R"({"nodes": {"#1": {"matrix": [1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1], "scale": [1,1,1]}}})",
     "NODE_MATRIX_TRS", "/nodes/1/matrix"},
    {"Projective", R"({"nodes": {"#1": {"matrix": [1,0,0,1,0,1,0,0,0,0,1,0,0,0,0,1]}}})", "NODE_MATRIX_NON_TRS",
     "/nodes/1/matrix"},
    {"Sheared", R"({"nodes": {"#1": {"matrix": [1,0,0,0,1,1,0,0,0,0,1,0,0,0,0,1]}}})", "NODE_MATRIX_NON_TRS",
     "/nodes/1/matrix", false},
    {"LongRotation", R"({"nodes": {"#1": {"rotation": [0, 0, 0, 2]}}})", "ROTATION_NON_UNIT", "/nodes/1/rotation",
     false},
    {"ZeroRotation", R"({"nodes": {"#1": {"rotation": [0, 0, 0, 0]}}})", "ROTATION_NON_UNIT", "/nodes/1/rotation"},
    {"NodeWeights", R"({"nodes": {"#0": {"weights": [1, 2]}}})", "NODE_WEIGHTS_INVALID", "/nodes/0/weights"},
    {"MeshWeights", R"({"meshes": {"#0": {"weights": [1, 2]}}})", "MESH_INVALID_WEIGHTS_COUNT", "/meshes/0/weights"},
    {"SkinWithoutMesh", R"({"nodes": {"#1": {"skin": 0}}})", "UNSATISFIED_DEPENDENCY", "/nodes/1/skin", false},
    {"ViewTooLong", R"({"bufferViews": {"#1": {"byteLength": 257}}})", "BUFFER_VIEW_TOO_LONG",
     "/bufferViews/1/byteLength"},
    {"ViewOffset", R"({"bufferViews": {"#1": {"byteOffset": 9007199254740991}}})", "BUFFER_VIEW_TOO_LONG",
     "/bufferViews/1/byteOffset"},
    {"ViewHuge", R"({"bufferViews": {"#1": {"byteLength": 1e300}}})", "BUFFER_VIEW_TOO_LONG",
     "/bufferViews/1/byteLength"},
    {"ViewHugeInteger", R"({"bufferViews": {"#1": {"byteOffset": 18446744073709551615}}})", "BUFFER_VIEW_TOO_LONG",
     "/bufferViews/1/byteOffset"},
    {"ViewBuffer", R"({"bufferViews": {"#1": {"buffer": 1}}})", "UNRESOLVED_REFERENCE", "/bufferViews/1/buffer"},
    {"StrideMultiple", R"({"bufferViews": {"#0": {"byteStride": 18}}})", "VALUE_MULTIPLE_OF",
     "/bufferViews/0/byteStride"},
    {"StrideRange", R"({"bufferViews": {"#0": {"byteStride": 256}}})", "VALUE_NOT_IN_RANGE",
     "/bufferViews/0/byteStride"},
    {"StrideSmall", R"({"bufferViews": {"#0": {"byteStride": 4}}})", "ACCESSOR_SMALL_BYTESTRIDE", "/accessors/0"},
    {"AccessorTooLong", R"({"accessors": {"#0": {"count": 5}}})", "ACCESSOR_TOO_LONG", "/accessors/0"},
    {"AccessorHugeCount", R"({"accessors": {"#0": {"count": 2147483647}}})", "ACCESSOR_TOO_LONG", "/accessors/0"},
    {"AccessorZeroCount", R"({"accessors": {"#0": {"count": 0}}})", "VALUE_NOT_IN_RANGE", "/accessors/0/count"},
    {"AccessorNegativeOffset", R"({"accessors": {"#0": {"byteOffset": -4}}})", "VALUE_NOT_IN_RANGE",
     "/accessors/0/byteOffset"},
    {"AccessorOutOfNothing", R"({"accessors": {"#0": {"bufferView": null, "count": 900000000}}})", "VALUE_NOT_IN_RANGE",
     "/accessors/0/count"},
    {"AccessorType", R"({"accessors": {"#0": {"type": "VEC9"}}})", "VALUE_NOT_IN_LIST", "/accessors/0/type"},
    {"AccessorView", R"({"accessors": {"#0": {"bufferView": 6}}})", "UNRESOLVED_REFERENCE", "/accessors/0/bufferView"},
    {"AccessorUnaligned", R"({"accessors": {"#0": {"byteOffset": 2}}})", "ACCESSOR_OFFSET_ALIGNMENT",
     "/accessors/0/byteOffset", false},
    {"SparseCount", R"({"accessors": {"#0": {"sparse": {"count": 4, "indices": {"bufferView": 1, "componentType": 5121},
        "values": {"bufferView": 3}}}}})",
     "ACCESSOR_SPARSE_COUNT_OUT_OF_RANGE", "/accessors/0/sparse/count"},
    {"SparseRange", R"({"accessors": {"#0": {"sparse": {"count": 3, "indices": {"bufferView": 1, "componentType": 5125},
        "values": {"bufferView": 3}}}}})",
     "ACCESSOR_TOO_LONG", "/accessors/0/sparse/indices/byteOffset"},
    {"PositionFormat", R"({"accessors": {"#0": {"type": "VEC4"}}})",
     "MESH_PRIMITIVE_ATTRIBUTES_ACCESSOR_INVALID_FORMAT", "/meshes/0/primitives/0/attributes/POSITION"},
    {"IndexFormat", R"({"accessors": {"#1": {"componentType": 5122}}})",
     "MESH_PRIMITIVE_INDICES_ACCESSOR_INVALID_FORMAT", "/meshes/0/primitives/0/indices"},
    {"CountsDiffer", R"({"accessors": {"#5": {"count": 2}}})", "MESH_PRIMITIVE_UNEQUAL_ACCESSOR_COUNT",
     "/meshes/0/primitives/0/attributes/TEXCOORD_0"},
    {"NoWeights", R"({"meshes": {"#0": {"primitives": {"#0": {"attributes": {"WEIGHTS_0": null}}}}}})",
     "MESH_PRIMITIVE_JOINTS_WEIGHTS_MISMATCH", "/meshes/0/primitives/0/attributes"},
    {"AttributeName", R"({"meshes": {"#0": {"primitives": {"#0": {"attributes": {"FOO/BAR": 0}}}}}})",
     "MESH_PRIMITIVE_INVALID_ATTRIBUTE", "/meshes/0/primitives/0/attributes/FOO~1BAR", false},
    {"NoTexcoord", R"({"meshes": {"#0": {"primitives": {"#0": {"attributes": {"TEXCOORD_0": null}}}}}})",
     "MESH_PRIMITIVE_TOO_FEW_TEXCOORDS", "/meshes/0/primitives/0/material", false},
    {"Mode", R"({"meshes": {"#0": {"primitives": {"#0": {"mode": 7}}}}})", "VALUE_NOT_IN_LIST",
     "/meshes/0/primitives/0/mode"},
    {"BindCount", R"({"accessors": {"#4": {"count": 1}}})", "INVALID_IBM_ACCESSOR_COUNT",
     "/skins/0/inverseBindMatrices"},
    {"BindFormat", R"({"skins": {"#0": {"inverseBindMatrices": 0}}})", "SKIN_IBM_INVALID_FORMAT",
     "/skins/0/inverseBindMatrices"},
    {"JointsApart", R"({"skins": {"#0": {"joints": [0, 3]}}})", "SKIN_NO_COMMON_ROOT", "/skins/0/joints", false},
    {"Skeleton", R"({"skins": {"#0": {"skeleton": 1}}})", "SKIN_SKELETON_INVALID", "/skins/0/skeleton", false},
    {"ChannelSampler", R"({"animations": {"#0": {"channels": {"#0": {"sampler": 1}}}}})", "UNRESOLVED_REFERENCE",
     "/animations/0/channels/0/sampler"},
    {"OutputCount", R"({"accessors": {"#7": {"count": 1}}})", "ANIMATION_SAMPLER_OUTPUT_ACCESSOR_INVALID_COUNT",
     "/animations/0/channels/0/sampler"},
    {"OutputFormat", R"({"accessors": {"#7": {"type": "VEC2"}}})", "ANIMATION_SAMPLER_OUTPUT_ACCESSOR_INVALID_FORMAT",
     "/animations/0/channels/0/sampler"},
    {"InputFormat", R"({"accessors": {"#6": {"componentType": 5125}}})",
     "ANIMATION_SAMPLER_INPUT_ACCESSOR_INVALID_FORMAT", "/animations/0/samplers/0/input"},
    {"CubicKeys",
     R"({"accessors": {"#6": {"count": 1}}, "animations": {"#0": {"samplers": {"#0": {"interpolation": "CUBICSPLINE"}}}}})",
     "ANIMATION_SAMPLER_OUTPUT_ACCESSOR_INVALID_COUNT", "/animations/0/channels/0/sampler"},
    {"AnimatedMatrix", R"({"nodes": {"#3": {"matrix": [1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}}})",
     "ANIMATION_CHANNEL_TARGET_NODE_MATRIX", "/animations/0/channels/0/target"},
    {"SameTarget", R"({"animations": {"#0": {"channels": [{"sampler": 0, "target": {"node": 3, "path": "scale"}},
        {"sampler": 0, "target": {"node": 3, "path": "scale"}}]}}})",
     "ANIMATION_DUPLICATE_TARGETS", "/animations/0/channels/0/target"},
    {"CameraPlanes", R"({"cameras": {"#0": {"perspective": {"zfar": 0.05}}}})", "CAMERA_ZFAR_LEQUAL_ZNEAR",
     "/cameras/0/perspective"},
    {"CameraLens", R"({"cameras": [{"type": "orthographic"}]})", "UNDEFINED_PROPERTY", "/cameras/0"},
    {"SpotAngles", R"({"extensions": {"KHR_lights_punctual": {"lights": {"#0": {"spot": {"innerConeAngle": 1}}}}}})",
     "KHR_LIGHTS_PUNCTUAL_LIGHT_SPOT_ANGLES", "/extensions/KHR_lights_punctual/lights/0/spot/outerConeAngle", false},
    {"LightType", R"({"extensions": {"KHR_lights_punctual": {"lights": {"#0": {"type": "sun"}}}}})",
     "VALUE_NOT_IN_LIST", "/extensions/KHR_lights_punctual/lights/0/type"},
    {"Undeclared", R"({"extensionsUsed": null})", "UNDECLARED_EXTENSION", "/extensions/KHR_lights_punctual", false},
    {"Misplaced", R"({"cameras": {"#0": {"extensions": {"KHR_lights_punctual": {"light": 0}}}}})",
     "UNEXPECTED_EXTENSION_OBJECT", "/cameras/0/extensions/KHR_lights_punctual", false},
    {"ImageSource", R"({"images": [{"uri": "a.png", "bufferView": 1}]})", "ONE_OF_MISMATCH", "/images/0"},
    {"ImageFormat", R"({"images": [{"uri": "data:image/png;base64,AAAAAAAA"}]})", "IMAGE_UNRECOGNIZED_FORMAT",
     "/images/0/uri", false},
    {"BufferData", R"({"buffers": [{"uri": "data:application/octet-stream;base64,AAAA", "byteLength": 256}]})",
     "BUFFER_BYTE_LENGTH_MISMATCH", "/buffers/0/byteLength"},
    {"BufferBase64", R"({"buffers": [{"uri": "data:application/octet-stream;base64,A*A=", "byteLength": 256}]})",
     "INVALID_URI", "/buffers/0/uri"},
};

class ValidateCases : public testing::TestWithParam<Case> {};

TEST(ValidateCase, GoodDocumentHasNoFindings) {
  for (const Finding& finding : validate_gltf(good(), {})) ADD_FAILURE() << finding.text();
}

TEST(ValidateCase, AMatrixMayBeOffByRoundingInItsLastRow) {
  json document = good();
  patch(document, json::parse(R"({"nodes": {"#1": {"matrix": [1,0,0,1e-8,0,1,0,0,0,0,1,0,0,0,0,0.99999994]}}})"));
  for (const Finding& finding : validate_gltf(document, {})) ADD_FAILURE() << finding.text();
}

TEST_P(ValidateCases, NamesCodeAndPlace) {
  const Case& c = GetParam();
  json document = good();
  patch(document, json::parse(c.patch));
  bool found = false, refused = false;
  std::string all;
  for (const Finding& finding : validate_gltf(document, {})) {
    found |= finding.code == c.code && finding.path == c.path && finding.fatal == c.fatal;
    refused |= finding.fatal;
    all += finding.text() + "\n";
  }
  EXPECT_TRUE(found) << all;
  EXPECT_EQ(refused, c.fatal) << all;
}

INSTANTIATE_TEST_SUITE_P(, ValidateCases, testing::ValuesIn(cases),
                         [](const auto& info) { return std::string(info.param.name); });

// Whatever replaces whatever: the checks must not trust a type before they have looked at it.
TEST(ValidateCase, AnyValueAnywhereReturns) {
  const json values[] = {
      nullptr, true, -1, 0.5, 1e300, "x", json::array(), json::object(), json::array({json::array()}), 1u << 31};
  const json flat = good().flatten();
  std::vector<std::string> pointers;
  for (const auto& [pointer, value] : flat.items())
    for (json::json_pointer p(pointer); !p.empty(); p = p.parent_pointer()) pointers.push_back(p.to_string());
  for (const std::string& pointer : pointers)
    for (const json& value : values) {
      json document = good();
      document[json::json_pointer(pointer)] = value;
      validate_gltf(document, {});
    }
}

TEST(ValidateCase, ManyWarningsAreBounded) {
  json document = good();
  for (int i = 0; i < 5000; ++i) document["odd" + std::to_string(i)] = i;
  document["nodes"][0]["mesh"] = 77;
  const std::vector<Finding> findings = validate_gltf(document, {});
  EXPECT_LT(findings.size(), 400u);
  EXPECT_TRUE(std::any_of(findings.begin(), findings.end(), [](const Finding& f) { return f.fatal; }));
}

TEST(ValidateCase, LongChainsOfNodesAreQuick) {
  constexpr int n = 200000;
  json document = {{"asset", {{"version", "2.0"}}}, {"scenes", {{{"nodes", {0}}}}}, {"nodes", json::array()}};
  for (int i = 0; i < n; ++i) document["nodes"].push_back(i + 1 < n ? json{{"children", {i + 1}}} : json::object());
  EXPECT_TRUE(validate_gltf(document, {}).empty());
}

}  // namespace
}  // namespace candela
