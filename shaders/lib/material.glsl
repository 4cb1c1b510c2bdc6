// A material's values (shared/scene.h) in 64-bit words. llvmpipe gathers words lane by lane, of either width: pairs
// halve their number. What a shader does not use of it is not read.
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer MaterialWordsRef { uint64_t w[45]; };
uvec2 material_word(MaterialWordsRef r, uint at) { return unpackUint2x32(r.w[at]); }
vec2 material_pair(MaterialWordsRef r, uint at) { return uintBitsToFloat(material_word(r, at)); }
TextureRef material_texture(MaterialWordsRef r, uint at) {
  const uvec2 image = material_word(r, at), uv_set = material_word(r, at + 1u);
  const vec2 a = material_pair(r, at + 2u), b = material_pair(r, at + 3u), c = material_pair(r, at + 4u);
  return TextureRef(image.x, image.y, uv_set.x, uv_set.y, vec3(a, b.x), vec3(b.y, c));
}
Material load_material(uint i) {
  MaterialWordsRef r = MaterialWordsRef(frame.materials + 360ul * uint64_t(i));
  Material m;
  m.base_color = vec4(material_pair(r, 0u), material_pair(r, 1u));
  const vec2 emissive_b = material_pair(r, 3u), width = material_pair(r, 4u), strength = material_pair(r, 5u);
  m.emissive = vec3(material_pair(r, 2u), emissive_b.x);
  m.alpha_cutoff = emissive_b.y;
  m.metallic = width.x;
  m.roughness = width.y;
  m.normal_scale = strength.x;
  m.occlusion_strength = strength.y;
  const vec2 specular = material_pair(r, 6u), specular_b = material_pair(r, 9u);
  m.specular = specular.x;
  m.ior_f0 = specular.y;
  const uvec2 kind = material_word(r, 7u);
  m.flags = kind.x;
  m.id = kind.y;
  m.specular_color = vec3(material_pair(r, 8u), specular_b.x);
  m.relief = floatBitsToUint(specular_b.y);
  // What no material has is not read: drivers would inline a reader for each before they drop it.
  m.base_texture.texture = m.orm_texture.texture = m.occlusion_texture.texture = m.normal_texture.texture = absent;
  m.emissive_texture.texture = m.specular_texture.texture = m.specular_color_texture.texture = absent;
  if (HAS_BASE_TEXTURE != 0) m.base_texture = material_texture(r, 10u);
  if (HAS_ORM_TEXTURE != 0) m.orm_texture = material_texture(r, 15u);
  if (HAS_OCCLUSION_TEXTURE != 0) m.occlusion_texture = material_texture(r, 20u);
  if (HAS_NORMAL_TEXTURE != 0) m.normal_texture = material_texture(r, 25u);
  if (HAS_EMISSIVE_TEXTURE != 0) m.emissive_texture = material_texture(r, 30u);
  if (HAS_SPECULAR_TEXTURE != 0) {
    m.specular_texture = material_texture(r, 35u);
    m.specular_color_texture = material_texture(r, 40u);
  }
  return m;
}
