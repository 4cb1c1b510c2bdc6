#pragma once
#include <cstring>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "gltf/gltf.h"

namespace candela::test {

using Json = nlohmann::json;

// Writes small glTF files for tests: accessors go to one buffer, and the whole becomes a .glb.
struct GltfBuilder {
  Json json = {
      {"asset", {{"version", "2.0"}}}, {"scene", 0}, {"scenes", {{{"nodes", {0}}}}}, {"nodes", {{{"mesh", 0}}}}};
  std::vector<std::byte> binary;

  template <class T>
  static constexpr int component_type() {
    if constexpr (std::is_same_v<T, int8_t>) return 5120;
    if constexpr (std::is_same_v<T, uint8_t>) return 5121;
    if constexpr (std::is_same_v<T, int16_t>) return 5122;
    if constexpr (std::is_same_v<T, uint16_t>) return 5123;
    if constexpr (std::is_same_v<T, uint32_t>) return 5125;
    return 5126;
  }
  static int components(const std::string& type) {
    return type == "SCALAR" ? 1 : type == "MAT4" ? 16 : type.back() - '0';
  }

  template <class T>
  int view(const std::vector<T>& values) {
    binary.resize((binary.size() + 3) / 4 * 4);
    json["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", values.size() * sizeof(T)}});
    const size_t at = binary.size();
    binary.resize(at + values.size() * sizeof(T));
    std::memcpy(binary.data() + at, values.data(), values.size() * sizeof(T));
    return int(json["bufferViews"].size()) - 1;
  }

  template <class T>
  int accessor(const std::string& type, const std::vector<T>& values, bool normalized = false) {
    Json a = {{"bufferView", view(values)},
              {"componentType", component_type<T>()},
              {"type", type},
              {"count", values.size() / size_t(components(type))}};
    if (normalized) a["normalized"] = true;
    if (std::is_same_v<T, float> && (type == "VEC3" || type == "SCALAR")) {
      const int n = components(type);
      std::vector<T> low(values.begin(), values.begin() + n), high = low;
      for (size_t i = 0; i < values.size(); ++i) {
        low[i % size_t(n)] = std::min(low[i % size_t(n)], values[i]);
        high[i % size_t(n)] = std::max(high[i % size_t(n)], values[i]);
      }
      a["min"] = low;
      a["max"] = high;
    }
    json["accessors"].push_back(a);
    return int(json["accessors"].size()) - 1;
  }

  // Adds a mesh of one primitive.
  Json& primitive(const Json& attributes, int mode = 4) {
    json["meshes"].push_back({{"primitives", {{{"attributes", attributes}, {"mode", mode}}}}});
    return json["meshes"].back()["primitives"][0];
  }
  void triangle() { primitive({{"POSITION", accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0})}}); }
  void use(const std::string& extension, bool required = false) {
    json["extensionsUsed"].push_back(extension);
    if (required) json["extensionsRequired"].push_back(extension);
  }

  std::vector<std::byte> glb() const {
    Json whole = json;
    std::vector<std::byte> bin = binary;
    bin.resize((bin.size() + 3) / 4 * 4);
    if (!bin.empty() && !whole.contains("buffers")) whole["buffers"] = {{{"byteLength", bin.size()}}};
    std::string text = whole.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::vector<std::byte> out;
    const auto word = [&](uint32_t v) {
      const std::byte* p = reinterpret_cast<const std::byte*>(&v);
      out.insert(out.end(), p, p + 4);
    };
    word(0x46546c67);
    word(2);
    word(uint32_t(12 + 8 + text.size() + (bin.empty() ? 0 : 8 + bin.size())));
    word(uint32_t(text.size()));
    word(0x4e4f534a);
    const std::byte* p = reinterpret_cast<const std::byte*>(text.data());
    out.insert(out.end(), p, p + text.size());
    if (!bin.empty()) {
      word(uint32_t(bin.size()));
      word(0x004e4942);
      out.insert(out.end(), bin.begin(), bin.end());
    }
    return out;
  }
  Expected<Scene> load(const LoadOptions& options = {}) const {
    return load_gltf_from_memory(glb(), "test.glb", "", options);
  }
};

// A 1x1 PNG: enough for loading, which never decodes.
inline std::string png_uri() {
  return "data:image/"
         "png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg==";
}

inline bool mentions(const std::vector<std::string>& lines, const std::string& what) {
  for (const std::string& line : lines)
    if (line.find(what) != std::string::npos) return true;
  return false;
}

}  // namespace candela::test
