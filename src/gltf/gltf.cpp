#include "gltf/gltf.h"

#include <fmt/ranges.h>

#include "base/file_uses.h"
#include "base/files.h"
#include "gltf/animation.h"
#include "gltf/extensions.h"
#include "gltf/lights.h"
#include "gltf/materials.h"
#include "gltf/meshes.h"
#include "gltf/metaballs.h"
#include "gltf/named_files.h"
#include "gltf/nodes.h"
#include "gltf/variants.h"
#include "scene/deformation_bounds.h"
#include "scene/scene_images.h"

namespace candela {
namespace {

// The order is that of reference: what is named comes before what names it.
Scene import_scene(gltf::Document& document, const LoadOptions& options) {
  Scene scene;
  scene.path = document.name;
  scene.extensions = gltf::survey_extensions(document, options.use);
  gltf::choose_variant(document, options.variant, scene);
  gltf::import_materials(document, gltf::animated_pointers(document), options.use, scene);
  gltf::import_meshes(document, scene);
  gltf::import_cameras(document, scene);
  gltf::import_lights(document, scene);
  gltf::import_nodes(document, scene);
  gltf::import_metaballs(document, scene);
  gltf::import_skins(document, scene);
  gltf::import_animations(document, options.animated, scene);
  gltf::check_animated_lights(document, scene);
  scene.files = std::move(document.files);
  scene.warnings = std::move(document.warnings);
  return scene;
}

}  // namespace

Expected<Scene> load_gltf(const std::filesystem::path& path, const LoadOptions& options) {
  const Expected<std::vector<std::byte>> bytes = read_file(path);
  if (!bytes) return std::unexpected(bytes.error());
  Expected<Scene> scene = load_gltf_from_memory(*bytes, path.string(), path.parent_path(), options);
  if (scene) scene->files.insert(scene->files.begin(), path.string());
  return scene;
}

std::vector<std::filesystem::path> files_named_by(const std::filesystem::path& path) {
  const Expected<std::vector<std::byte>> bytes = read_file(path);
  if (!bytes) return {};
  try {
    return gltf::named_files(gltf::open_document(*bytes, path.string(), path.parent_path()));
  } catch (const std::exception&) {
  } catch (const gltf::Failure&) {
  }
  return {};
}

void note_scene_files(const std::filesystem::path& path) {
  for (const std::filesystem::path& file : files_named_by(path)) note_read({path.string(), file});
}

Expected<Scene> load_gltf_from_memory(std::span<const std::byte> bytes, const std::string& name,
                                      const std::filesystem::path& folder, const LoadOptions& options) {
  std::set<std::string> earlier;
  try {
    gltf::Document document = gltf::open_document(bytes, name, folder, options.animated);
    gltf::note_named_files(document);
    earlier = document.finding_codes;
    Scene scene = import_scene(document, options);
    prepare_deformation_bounds(scene);
    if (const auto fits = decoded_bytes(scene); !fits) return std::unexpected(fits.error());
    return scene;
  } catch (const gltf::Failure& failure) {
    Error error = failure.error;
    // The warnings are lost with the scene, and one of them may be the cause of what stopped us.
    if (!earlier.empty()) error.message += fmt::format("; also found: {}", fmt::join(earlier, ", "));
    return std::unexpected(std::move(error));
  } catch (const std::bad_alloc&) {
    return fail(ErrorKind::out_of_memory, name, "there is not enough memory to load the scene");
  } catch (const nlohmann::json::exception& e) {
    return fail(ErrorKind::input, name, "the JSON is not what glTF 2.0 says: {} (TYPE_MISMATCH)", e.what());
  }
}

}  // namespace candela
