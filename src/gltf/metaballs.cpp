#include "gltf/metaballs.h"

#include <numeric>

#include "scene/metaballs.h"

namespace candela::gltf {
namespace {

// Strengths beyond it would leave sums of floats without digits.
constexpr double most_strength = 1e6;

class MetaballReader {
 public:
  MetaballReader(const Document& document, const Scene& scene, int node)
      : document_(document),
        scene_(scene),
        node_(node),
        path_(fmt::format("/nodes/{}/extensions/CANDELA_metaballs", node)) {}

  Metaballs read(const Json& json) const {
    Metaballs body;
    body.node = node_;
    body.threshold = ranged(json, "threshold", body.threshold, path_, 0, most_strength);
    const Json* balls = member(json, "balls");
    if (!balls || !balls->is_array() || balls->empty())
      document_.refuse(path_, "'balls' is required and not empty (UNDEFINED_PROPERTY)");
    if (balls->size() > most_metaballs)
      document_.refuse(path_ + "/balls", "{} balls, and a body has at most {} (VALUE_NOT_IN_RANGE)", balls->size(),
                       most_metaballs);
    const float radius = positive(json, "radius", 1, path_);
    const float strength = ranged(json, "strength", 1, path_, -most_strength, most_strength);
    for (size_t b = 0; b < balls->size(); ++b)
      body.balls.push_back(ball((*balls)[b], fmt::format("{}/balls/{}", path_, b), radius, strength));
    body.cell_m = positive(json, "cell", default_metaball_cell_m(body), path_);
    if (const Json* noise = member(json, "noise")) {
      const std::string at = path_ + "/noise";
      body.noise_amplitude = ranged(*noise, "amplitude", 0, at, 0, 0.99);
      body.noise_frequency_per_m = positive(*noise, "frequency", 1, at);
    }
    return body;
  }
  const std::string& path() const { return path_; }

 private:
  Metaball ball(const Json& json, const std::string& at, float radius, float strength) const {
    Metaball out;
    out.node = index_of(document_, json, "node", scene_.nodes.size(), at);
    if (out.node < 0) document_.refuse(at, "'node' is required (UNDEFINED_PROPERTY)");
    int above = scene_.nodes[size_t(out.node)].parent;
    while (above >= 0 && above != node_) above = scene_.nodes[size_t(above)].parent;
    if (above < 0)
      document_.refuse(at + "/node", "node {} is not below node {}, whose ball it is to be (UNRESOLVED_REFERENCE)",
                       out.node, node_);
    out.radius_m = positive(json, "radius", radius, at);
    out.strength = ranged(json, "strength", strength, at, -most_strength, most_strength);
    return out;
  }
  float ranged(const Json& json, const char* key, double otherwise, const std::string& at, double lowest,
               double highest) const {
    const double value = number(document_, json, key, otherwise, at);
    if (!(value >= lowest && value <= highest))
      document_.refuse(at + "/" + key, "{} does not lie between {} and {} (VALUE_NOT_IN_RANGE)", value, lowest,
                       highest);
    return float(value);
  }
  float positive(const Json& json, const char* key, double otherwise, const std::string& at) const {
    const double value = number(document_, json, key, otherwise, at);
    if (!(float(value) > 0) || !(value < 1e15))
      document_.refuse(at + "/" + key, "{} must be greater than 0 and below 1e15 (VALUE_NOT_IN_RANGE)", value);
    return float(value);
  }

  const Document& document_;
  const Scene& scene_;
  int node_;
  std::string path_;
};

// What the body is drawn as: no vertices of its own, and indices that count those of one chunk.
MeshSection chunk_section(const Metaballs& body, int number, int material, std::string path) {
  MeshSection section;
  section.place = std::move(path);
  section.material = material;
  section.metaballs = number;
  section.index.resize(3 * size_t(metaball_chunk_triangles));
  std::iota(section.index.begin(), section.index.end(), 0u);
  float reach_m = 0;
  for (const Metaball& ball : body.balls) reach_m = std::max(reach_m, ball.radius_m);
  section.bounds = {glm::vec3(-reach_m), glm::vec3(reach_m)};
  return section;
}

}  // namespace

void import_metaballs(Document& document, Scene& scene) {
  for (size_t n = 0; n < scene.nodes.size(); ++n) {
    const Json& json = document.json["nodes"][n];
    const Json* extended = extension(json, "CANDELA_metaballs");
    if (!extended) continue;
    const MetaballReader reader(document, scene, int(n));
    if (scene.nodes[n].mesh >= 0)
      document.refuse(reader.path(), "the node has a mesh too; put one of them on a child (VALUE_NOT_IN_LIST)");
    Metaballs body = reader.read(*extended);
    const int material = index_of(document, *extended, "material", scene.materials.size(), reader.path());
    document.charge(3 * size_t(metaball_chunk_triangles), sizeof(uint32_t), reader.path());
    Mesh mesh;
    mesh.name = scene.nodes[n].name;
    mesh.sections.push_back(chunk_section(body, int(scene.metaballs.size()), material, reader.path()));
    scene.nodes[n].mesh = int(scene.meshes.size());
    scene.meshes.push_back(std::move(mesh));
    scene.metaballs.push_back(std::move(body));
  }
}

}  // namespace candela::gltf
