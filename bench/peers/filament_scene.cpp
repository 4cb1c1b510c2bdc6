#include "filament_scene.h"

#include <filament/Box.h>
#include <filament/IndexBuffer.h>
#include <filament/LightManager.h>
#include <filament/RenderableManager.h>
#include <filament/TextureSampler.h>
#include <filament/TransformManager.h>
#include <filament/VertexBuffer.h>
#include <geometry/SurfaceOrientation.h>
#include <utils/EntityManager.h>

#include <algorithm>
#include <map>

#include "scene/scene_images.h"

namespace candela::peers {
namespace {

using filament::Engine;
using filament::math::float2, filament::math::float3, filament::math::float4, filament::math::mat4f,
    filament::math::short4;

constexpr unsigned char lit_package[] = {
#include "lit.inc"
};
constexpr unsigned char lit_emissive_package[] = {
#include "lit_emissive.inc"
};

float3 of(glm::vec3 v) { return {v.x, v.y, v.z}; }

// Filament reads the memory later, on its own thread: a copy that it frees when it has.
template <class Descriptor, class T, class... More>
Descriptor copied(const std::vector<T>& values, More... more) {
  auto* copy = new std::vector<T>(values);
  return Descriptor(
      copy->data(), copy->size() * sizeof(T), more...,
      [](void*, size_t, void* user) { delete static_cast<std::vector<T>*>(user); }, copy);
}
template <class T>
filament::VertexBuffer::BufferDescriptor buffer_of(const std::vector<T>& values) {
  return copied<filament::VertexBuffer::BufferDescriptor>(values);
}

struct Geometry {
  filament::VertexBuffer* vertices;
  filament::IndexBuffer* indices;
};

Expected<Geometry> make_geometry(Engine& engine, const MeshSection& s) {
  if (s.topology != Topology::triangles || s.normal.empty() || !s.morph.empty() || !s.joints0.empty())
    return fail(ErrorKind::input, s.place, "this comparison takes rigid triangles with normals");
  using filament::VertexAttribute, filament::VertexBuffer;
  const size_t count = s.position.size();
  std::vector<short4> frames(count);
  auto* orientation = filament::geometry::SurfaceOrientation::Builder()
                          .vertexCount(count)
                          .normals(reinterpret_cast<const float3*>(s.normal.data()))
                          .build();
  orientation->getQuats(frames.data(), count);
  delete orientation;
  Geometry g;
  g.vertices = VertexBuffer::Builder()
                   .vertexCount(uint32_t(count))
                   .bufferCount(4)
                   .attribute(VertexAttribute::POSITION, 0, VertexBuffer::AttributeType::FLOAT3)
                   .attribute(VertexAttribute::TANGENTS, 1, VertexBuffer::AttributeType::SHORT4)
                   .normalized(VertexAttribute::TANGENTS)
                   .attribute(VertexAttribute::COLOR, 2, VertexBuffer::AttributeType::FLOAT4)
                   .attribute(VertexAttribute::UV0, 3, VertexBuffer::AttributeType::FLOAT2)
                   .build(engine);
  g.vertices->setBufferAt(engine, 0, buffer_of(s.position));
  g.vertices->setBufferAt(engine, 1, buffer_of(frames));
  g.vertices->setBufferAt(engine, 2,
                          buffer_of(s.color.empty() ? std::vector<glm::vec4>(count, glm::vec4(1)) : s.color));
  g.vertices->setBufferAt(engine, 3, buffer_of(s.uv0.empty() ? std::vector<glm::vec2>(count) : s.uv0));
  g.indices = filament::IndexBuffer::Builder().indexCount(uint32_t(s.index.size())).build(engine);
  g.indices->setBuffer(engine, buffer_of(s.index));
  return g;
}

filament::TextureSampler sampler_of(const Sampler& s) {
  using filament::TextureSampler;
  const auto wrap = [](Wrap w) {
    return w == Wrap::repeat  ? TextureSampler::WrapMode::REPEAT
           : w == Wrap::clamp ? TextureSampler::WrapMode::CLAMP_TO_EDGE
                              : TextureSampler::WrapMode::MIRRORED_REPEAT;
  };
  using Min = TextureSampler::MinFilter;
  const bool linear = s.min == Filter::linear, linear_mip = s.mip == Filter::linear;
  const Min min = !s.mipmaps   ? (linear ? Min::LINEAR : Min::NEAREST)
                  : linear_mip ? (linear ? Min::LINEAR_MIPMAP_LINEAR : Min::NEAREST_MIPMAP_LINEAR)
                               : (linear ? Min::LINEAR_MIPMAP_NEAREST : Min::NEAREST_MIPMAP_NEAREST);
  TextureSampler out;
  out.setMinFilter(min);
  out.setMagFilter(s.mag == Filter::linear ? TextureSampler::MagFilter::LINEAR : TextureSampler::MagFilter::NEAREST);
  out.setWrapModeS(wrap(s.wrap_u));
  out.setWrapModeT(wrap(s.wrap_v));
  return out;
}

Expected<filament::Texture*> make_texture(Engine& engine, const Scene& scene, int image) {
  const auto stored = decode_scene_image(scene, image);
  if (!stored) return std::unexpected(stored.error());
  if (!stored->warnings.empty()) return fail(ErrorKind::input, scene.path, "{}", stored->warnings.front());
  const DecodedImage* const decoded = &stored->image;
  if (decoded->format != DecodedImage::Format::rgba8)
    return fail(ErrorKind::input, scene.path, "image {} has more than 8 bits", image);
  using filament::Texture;
  Texture* texture = Texture::Builder()
                         .width(uint32_t(decoded->width))
                         .height(uint32_t(decoded->height))
                         .levels(0xff)
                         .format(Texture::InternalFormat::SRGB8_A8)
                         .build(engine);
  texture->setImage(
      engine, 0, copied<Texture::PixelBufferDescriptor>(decoded->pixels, Texture::Format::RGBA, Texture::Type::UBYTE));
  texture->generateMipmaps(engine);
  return texture;
}

Expected<std::vector<filament::MaterialInstance*>> make_materials(Engine& engine, const Scene& scene,
                                                                  const Pose& pose) {
  using filament::Material;
  Material* lit = Material::Builder().package(lit_package, sizeof lit_package).build(engine);
  Material* emissive = Material::Builder().package(lit_emissive_package, sizeof lit_emissive_package).build(engine);
  std::vector<filament::MaterialInstance*> out;
  for (const candela::Material& m : pose.materials) {
    if (m.alpha_mode != AlphaMode::opaque || m.unlit || m.base_color_texture || m.orm_texture || m.occlusion_texture ||
        m.normal_texture || m.specular_texture || m.specular_color_texture)
      return fail(ErrorKind::input, scene.path,
                  "material '{}': this comparison takes opaque factors and an emissive texture", m.name);
    filament::MaterialInstance* instance = (m.emissive_texture ? emissive : lit)->createInstance();
    if (m.double_sided) instance->setDoubleSided(true);
    instance->setParameter("baseColor", float4{m.base_color.x, m.base_color.y, m.base_color.z, m.base_color.w});
    instance->setParameter("metallic", m.metallic);
    instance->setParameter("roughness", m.roughness);
    if (m.emissive_texture) {
      const auto texture = make_texture(engine, scene, m.emissive_texture.image);
      if (!texture) return std::unexpected(texture.error());
      instance->setParameter("emissive", of(m.emissive * m.emissive_strength));
      instance->setParameter("emissiveMap", *texture, sampler_of(scene.samplers[size_t(m.emissive_texture.sampler)]));
    }
    out.push_back(instance);
  }
  return out;
}

// Filament draws no light that reaches everything: a thousand metres stand for it.
float reach_of(const LightItem& light) { return std::min(light.range_m, 1000.0f); }

utils::Entity make_light(Engine& engine, const LightItem& light, bool casts_shadows) {
  using filament::LightManager;
  const utils::Entity entity = utils::EntityManager::get().create();
  const bool spot = light.type == LightType::spot;
  LightManager::Builder builder(spot ? LightManager::Type::SPOT : LightManager::Type::POINT);
  builder.falloff(reach_of(light)).castShadows(casts_shadows);
  if (spot) builder.spotLightCone(light.inner_cone_rad, light.outer_cone_rad);
  builder.build(engine, entity);
  return entity;
}

}  // namespace

mat4f filament_matrix(const glm::mat4& matrix) {
  mat4f out;
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) out[size_t(column)][size_t(row)] = matrix[column][row];
  return out;
}

Expected<FilamentScene> FilamentScene::make(Engine& engine, const candela::Scene& scene, const Pose& pose,
                                            const FrameData& frame, int shadowed) {
  FilamentScene out;
  out.scene_ = engine.createScene();
  const auto materials = make_materials(engine, scene, pose);
  if (!materials) return std::unexpected(materials.error());
  std::map<std::pair<uint32_t, uint32_t>, Geometry> geometries;
  for (const DrawItem& item : frame.items) {
    const MeshSection& section = scene.meshes[item.mesh].sections[item.section];
    if (item.material < 0 || item.mirrored)
      return fail(ErrorKind::input, section.place, "this comparison takes unmirrored items with a material");
    if (!geometries.contains({item.mesh, item.section})) {
      const auto made = make_geometry(engine, section);
      if (!made) return std::unexpected(made.error());
      geometries[{item.mesh, item.section}] = *made;
    }
    const Geometry& g = geometries[{item.mesh, item.section}];
    const utils::Entity entity = utils::EntityManager::get().create();
    filament::Box box;
    box.set(of(glm::vec3(section.bounds.min)), of(glm::vec3(section.bounds.max)));
    filament::RenderableManager::Builder(1)
        .boundingBox(box)
        .geometry(0, filament::RenderableManager::PrimitiveType::TRIANGLES, g.vertices, g.indices)
        .material(0, (*materials)[size_t(item.material)])
        .castShadows(shadowed > 0)
        .receiveShadows(shadowed > 0)
        .build(engine, entity);
    engine.getTransformManager().create(entity);
    out.scene_->addEntity(entity);
    out.items_.push_back(entity);
    out.placed_.push_back(glm::mat4(0));
  }
  std::vector<float> spots;  // squared distances from the camera
  for (const LightItem& light : frame.lights)
    if (light.type == LightType::spot) spots.push_back(glm::dot(light.position, light.position));
  std::ranges::sort(spots);
  for (const LightItem& light : frame.lights) {
    if (light.type == LightType::directional)
      return fail(ErrorKind::input, scene.path, "this comparison takes point and spot lights");
    const bool casts = light.type == LightType::spot && shadowed > 0 && !spots.empty() &&
                       glm::dot(light.position, light.position) <= spots[std::min(size_t(shadowed), spots.size()) - 1];
    out.lights_.push_back(make_light(engine, light, casts));
    out.scene_->addEntity(out.lights_.back());
  }
  if (auto moved = out.move(engine, frame); !moved) return std::unexpected(moved.error());
  return out;
}

Expected<void> FilamentScene::move(Engine& engine, const FrameData& frame) {
  if (frame.items.size() != items_.size() || frame.lights.size() != lights_.size())
    return fail(ErrorKind::input, "", "items or lights come and go; this comparison takes scenes where they only move");
  auto& transforms = engine.getTransformManager();
  for (size_t i = 0; i < items_.size(); ++i) {
    const glm::mat4& now = frame.relative_from_local[frame.items[i].transform];
    if (now == placed_[i]) continue;
    placed_[i] = now;
    transforms.setTransform(transforms.getInstance(items_[i]), filament_matrix(now));
  }
  auto& lights = engine.getLightManager();
  for (size_t i = 0; i < lights_.size(); ++i) {
    const LightItem& light = frame.lights[i];
    const auto instance = lights.getInstance(lights_[i]);
    const float brightest = std::max({light.intensity.x, light.intensity.y, light.intensity.z});
    lights.setPosition(instance, of(light.position));
    if (light.type == LightType::spot) lights.setDirection(instance, of(light.direction));
    lights.setColor(instance, of(light.intensity / brightest));
    lights.setIntensityCandela(instance, brightest);
  }
  return {};
}

}  // namespace candela::peers
