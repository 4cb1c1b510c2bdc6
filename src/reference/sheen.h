#pragma once

// The sheen of cloth, KHR_materials_sheen: fibres that stand up from the surface. The "Charlie" distribution with its
// fitted shadowing, both from the extension's text (Conty Estevez and Kulla, "Production Friendly Microfacet Sheen
// BRDF", 2017), without a Fresnel term; alpha is roughness squared.
namespace candela::reference {

inline constexpr double least_sheen_roughness = 0.07;  // what is less counts as this

// White: f(l, v) (n.l), 1/sr. Cosines to the shading normal; n.l and n.v above 0.
double sheen_lobe(double n_l, double n_v, double n_h, double roughness);

// What it reflects of a uniform sky: its double integral over light directions, by rings and half as many sectors. At
// grazing angles above 1 where the fibres are straight.
double integrate_sheen(double roughness, double n_v, int rings);
// The same from a table, which the first call makes, by cubic interpolation.
double sheen_albedo(double roughness, double n_v);

}  // namespace candela::reference
