#include "reference/terms.h"

namespace candela::reference {

std::string_view name_of(Term term) {
  static constexpr std::string_view names[term_count] = {
      "direct_sun", "direct_point", "direct_spot", "ambient_diffuse", "ambient_specular",
      "emission",   "background",   "reflections", "indirect",        "volumetric"};
  return names[size_t(term)];
}

Term direct_term(LightType type) {
  return type == LightType::directional ? Term::direct_sun
         : type == LightType::point     ? Term::direct_point
                                        : Term::direct_spot;
}

}  // namespace candela::reference
