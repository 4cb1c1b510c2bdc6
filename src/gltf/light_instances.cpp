#include "gltf/light_instances.h"

#include "gltf/accessors.h"

#include "base/names.h"

namespace candela::gltf {
namespace {

class Reader {
 public:
  Reader(Document& document, const Json& attributes, const Light& light, std::string path)
      : document_(document), attributes_(attributes), light_(light), path_(std::move(path)) {}

  // Empty where the attribute is absent.
  template <class V>
  std::vector<V> vectors(const char* key) {
    std::vector<V> out;
    if (const int accessor = find(key); accessor >= 0)
      with_path(key, [&] {
        const Elements elements = elements_of(document_, accessor, at(key));
        check_count(key, elements.count);
        out = read_vectors<V>(document_, elements, {});
      });
    return out;
  }

  std::vector<float> scalars(const char* key) {
    std::vector<float> out;
    if (const int accessor = find(key); accessor >= 0)
      with_path(key, [&] {
        out = all_floats(document_, accessor, 1, at(key));
        check_count(key, out.size());
      });
    return out;
  }

  template <class... A>
  [[noreturn]] void refuse(const char* key, size_t i, fmt::format_string<A...> format, A&&... args) const {
    document_.refuse(at(key), "light {} of {}: {} (VALUE_NOT_IN_RANGE)", i, quoted_name(light_.name),
                     fmt::format(format, std::forward<A>(args)...));
  }

 private:
  std::string at(const char* key) const { return path_ + "/" + key; }
  int find(const char* key) const {
    return index_of(document_, attributes_, key, document_.model.accessors.size(), path_);
  }

  // What is wrong with an accessor is told by the attribute that uses it.
  template <class F>
  void with_path(const char* key, F&& read) {
    try {
      read();
    } catch (Failure& failure) {
      if (failure.error.kind == ErrorKind::input && !failure.error.place.ends_with(at(key))) {
        failure.error.message =
            fmt::format("lights of {}: {}: {}", quoted_name(light_.name), failure.error.place, failure.error.message);
        failure.error.place = document_.place(at(key));
      }
      throw;
    }
  }

  void check_count(const char* key, size_t count) {
    if (count_ == 0) count_ = count;
    if (count != count_) document_.refuse(at(key), "{} elements where TRANSLATION has {}", count, count_);
  }

  Document& document_;
  const Json& attributes_;
  const Light& light_;
  std::string path_;
  size_t count_ = 0;
};

void check_values(const Reader& reader, const LightInstances& l) {
  for (size_t i = 0; i < l.direction.size(); ++i)
    if (const glm::vec3 d = l.direction[i]; !(glm::dot(d, d) > 1e-12f) || !std::isfinite(glm::dot(d, d)))
      reader.refuse("DIRECTION", i, "({}, {}, {}) is no direction", d.x, d.y, d.z);
  for (size_t i = 0; i < l.color.size(); ++i)
    if (const glm::vec3 c = l.color[i]; !(c.x >= 0 && c.y >= 0 && c.z >= 0 && c.x <= 1 && c.y <= 1 && c.z <= 1))
      reader.refuse("COLOR", i, "({}, {}, {}) is no colour; each must lie in [0, 1]", c.x, c.y, c.z);
  for (size_t i = 0; i < l.intensity.size(); ++i)
    if (!(l.intensity[i] >= 0)) reader.refuse("INTENSITY", i, "{} is no intensity", l.intensity[i]);
  for (size_t i = 0; i < l.range_m.size(); ++i)
    if (!(l.range_m[i] > 0)) reader.refuse("RANGE", i, "{} is no range; it must be positive", l.range_m[i]);
  for (size_t i = 0; i < l.modulation.size(); ++i) {
    const LightModulation& m = l.modulation[i];
    if (!(m.depth >= 0 && m.depth <= 1)) reader.refuse("MODULATION", i, "the depth {} is outside [0, 1]", m.depth);
    if (!(m.period_s > 0)) reader.refuse("MODULATION", i, "{} s is no period; it must be positive", m.period_s);
  }
}

}  // namespace

std::shared_ptr<const LightInstances> read_light_instances(Document& document, const Scene& scene, const Json& node,
                                                           const std::string& node_path) {
  const Json* use = extension(node, "CANDELA_light_instances");
  if (!use) return nullptr;
  const std::string path = node_path + "/extensions/CANDELA_light_instances";
  auto out = std::make_shared<LightInstances>();
  out->light = index_of(document, *use, "light", scene.lights.size(), path);
  const Json* attributes = member(*use, "attributes");
  if (out->light < 0 || !attributes)
    document.refuse(path, "'light' and 'attributes' are required (UNDEFINED_PROPERTY)");
  Reader reader(document, *attributes, scene.lights[size_t(out->light)], path + "/attributes");
  out->translation = reader.vectors<glm::vec3>("TRANSLATION");
  out->direction = reader.vectors<glm::vec3>("DIRECTION");
  out->color = reader.vectors<glm::vec3>("COLOR");
  out->intensity = reader.scalars("INTENSITY");
  out->range_m = reader.scalars("RANGE");
  const std::vector<glm::vec3> modulation = reader.vectors<glm::vec3>("MODULATION");
  document.charge(modulation.size(), sizeof(LightModulation), path + "/attributes/MODULATION");
  out->modulation.reserve(modulation.size());
  for (const glm::vec3& m : modulation) out->modulation.push_back({m.x, m.y, m.z});
  check_values(reader, *out);
  return out;
}

}  // namespace candela::gltf
