#include "scene/light_layers.h"

namespace candela {

bool matches(std::string_view name, std::string_view pattern) {
  if (pattern.empty()) return name.empty();
  if (pattern.front() != '*')
    return !name.empty() && name.front() == pattern.front() && matches(name.substr(1), pattern.substr(1));
  for (size_t taken = 0; taken <= name.size(); ++taken)
    if (matches(name.substr(taken), pattern.substr(1))) return true;
  return false;
}

}  // namespace candela
