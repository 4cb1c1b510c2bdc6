// What the scene's visible materials use, as specialization constants: an absent feature leaves neither branch nor
// fetch in the shader. Ids and names are those of passes/shared/features.cpp.
layout(constant_id = 0) const int HAS_BASE_TEXTURE = 0;
layout(constant_id = 1) const int HAS_ORM_TEXTURE = 0;
layout(constant_id = 2) const int HAS_OCCLUSION_TEXTURE = 0;
layout(constant_id = 3) const int HAS_NORMAL_TEXTURE = 0;
layout(constant_id = 4) const int HAS_EMISSIVE_TEXTURE = 0;
layout(constant_id = 5) const int HAS_SPECULAR_TEXTURE = 0;
layout(constant_id = 6) const int HAS_VERTEX_COLOR = 0;
layout(constant_id = 7) const int HAS_UV1 = 0;
layout(constant_id = 8) const int HAS_TEXTURE_TRANSFORM = 0;
layout(constant_id = 9) const int HAS_LIGHTS = 0;
layout(constant_id = 10) const int HAS_AMBIENT = 0;
layout(constant_id = 11) const int IS_MASKED = 0;
layout(constant_id = 12) const int IS_UNLIT = 0;
layout(constant_id = 14) const int IS_SUBSAMPLE = 0;       // one of several samples of a supersampled frame
layout(constant_id = 15) const int HAS_SUN_SHADOWS = 0;    // of suns: 1 of some, from maps; 2 traced; + 4 soft
layout(constant_id = 16) const int HAS_OCCLUSION = 0;      // its texels' shape (shared/occlusion.h); below 0: traced
layout(constant_id = 13) const int HAS_TEXTURES = 0;       // any of the above: UVs are passed on
layout(constant_id = 17) const int IBL_LIGHT = 0;          // of reflections of a sky image; 0: spherical harmonics
const float smooth_roughness = 0.0992;                     // scene/survey.h
const int IBL_METHOD = IBL_LIGHT & 255, MIRROR_TAPS = IBL_LIGHT >> 8;  // what smooth surfaces mirror; 0: as rough ones
layout(constant_id = 18) const int HAS_SKY_IRRADIANCE = 0; // a map of the sky's diffuse light
const int ibl_split = 1, ibl_lobe = 2, ibl_sampled = 3;
layout(constant_id = 19) const int HAS_LAMP_SHADOWS = 0;   // the same of point and spot lights
layout(constant_id = 20) const int RAY_STACK = 1;          // of traced light: entries (lib/trace.glsl)
layout(constant_id = 21) const int RAYS_MEET_BLENDED = 0;  // something lets a part of their light through
layout(constant_id = 22) const int PROBE_COUNT = 0;        // reflection probes of the frame
layout(constant_id = 23) const int LOBES = 0;              // of materials (shared/lobes.h), only with LOBED
layout(constant_id = 24) const int LOBE_TEXTURES = 0;      // those that have textures
layout(constant_id = 25) const int HAS_EMISSION = 0;
layout(constant_id = 26) const int BLINN_PHONG = 0;        // some have that lobe
layout(constant_id = 27) const int SPECULAR_AA = 0;        // passes/surfaces/surface_knobs.h
layout(constant_id = 29) const int LIGHT_VOXELS = 0;       // only with VOXELS: whose shadows they know; and how
const int voxels_of_suns = 1, voxels_of_lamps = 2, voxels_halve = 4;
const int specular_aa_normals = 1, specular_aa_maps = 2;
const int lobe_clearcoat = 1, lobe_sheen = 2, lobe_iridescence = 4, lobe_anisotropy = 8, lobe_diffuse_transmission = 32,
    lobe_scattering = 64;
const bool HAS_COAT = (LOBES & lobe_clearcoat) != 0, HAS_SHEEN = (LOBES & lobe_sheen) != 0;
const bool HAS_FILM = (LOBES & lobe_iridescence) != 0, HAS_ANISOTROPY = (LOBES & lobe_anisotropy) != 0;
const bool HAS_PASSING = (LOBES & (lobe_diffuse_transmission | lobe_scattering)) != 0;
const int LOBES_WITH_TANGENTS = (LOBES & lobe_anisotropy) | (LOBE_TEXTURES & lobe_clearcoat);
const bool HAS_TANGENT = HAS_NORMAL_TEXTURE != 0 || LOBES_WITH_TANGENTS != 0;
const int shadows_traced = 2, shadows_soft = 4, occlusion_traced_bent = -2;
const bool SUNS_TRACED = (HAS_SUN_SHADOWS & shadows_traced) != 0, SUNS_SOFT = (HAS_SUN_SHADOWS & shadows_soft) != 0;
const bool LAMPS_TRACED = (HAS_LAMP_SHADOWS & shadows_traced) != 0, LAMPS_SOFT = (HAS_LAMP_SHADOWS & shadows_soft) != 0;
const bool OCCLUSION_IS_BENT =
    HAS_OCCLUSION < 0 ? HAS_OCCLUSION == occlusion_traced_bent : (HAS_OCCLUSION >> 16 & 1) != 0;
const bool HAS_SHADOWS = HAS_SUN_SHADOWS != 0 || HAS_LAMP_SHADOWS != 0;
