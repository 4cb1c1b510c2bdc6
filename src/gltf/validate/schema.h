#pragma once
#include <limits>
#include <string_view>
#include <vector>

#include "gltf/validate/internal.h"

// The glTF JSON schema as tables: what each object may hold, of which type and range.
namespace candela::validation {

struct ObjectSchema;

enum class Shape : uint8_t {
  any,
  boolean,
  integer,
  number,
  string,
  index,
  object,
  index_map,  // an object whose values are indices (attributes)
  numbers,
  strings,
  indices,
  objects,
  index_maps,
};

struct Property {
  std::string_view name;
  Shape shape = Shape::any;
  const ObjectSchema* object = nullptr;  // for object and objects
  bool required = false;
  double lowest = -std::numeric_limits<double>::infinity(), highest = std::numeric_limits<double>::infinity();
  bool above_lowest = false;  // lowest itself is outside
  int64_t multiple_of = 1;
  std::vector<int64_t> values = {};          // for integers: the listed ones; empty: any
  std::vector<std::string_view> names = {};  // for strings
  std::vector<size_t> lengths = {};          // for arrays; empty: any but 0
  Harm wrong_type = Harm::fatal, unlisted = Harm::fatal, outside = Harm::fatal, empty = Harm::warning,
       repeated = Harm::warning;
  bool unique = false;
};

struct ObjectSchema {
  std::string_view name;  // where an extension object may stand: "material", "textureInfo"
  std::vector<Property> properties;
};

struct ExtensionSchema {
  std::string_view extension, place;
  const ObjectSchema* object = nullptr;  // null: allowed here, its content is not read
};

const ObjectSchema& root_schema();
const ObjectSchema& texture_info_schema();
const std::vector<ExtensionSchema>& extension_schemas();

}  // namespace candela::validation
