#include "gltf/validate/schema.h"

#include <cmath>
#include <unordered_set>

namespace candela::validation {
namespace {

// A JSON pointer as a chain of stack frames: turned into text only when there is something to report.
struct Path {
  const Path* parent = nullptr;
  std::string_view key;
  size_t index = 0;
  bool is_index = false;
  std::string str() const {
    if (!parent) return "";
    return parent->str() + "/" + (is_index ? std::to_string(index) : pointer_token(key));
  }
};

std::string excerpt(const Json& value) {
  if (value.is_structured())
    return value.is_array() ? (value.empty() ? "[]" : "[...]") : (value.empty() ? "{}" : "{...}");
  if (value.is_string()) return "'" + value.get_ref<const std::string&>().substr(0, 60) + "'";
  return value.dump();
}

class SchemaChecker {
 public:
  SchemaChecker(const Json& root, Findings& findings) : findings_(findings) {
    for (const char* list : {"extensionsUsed", "extensionsRequired"})
      if (const auto found = root.find(list); found != root.end() && found->is_array())
        for (const Json& name : *found)
          if (name.is_string()) declared_.insert(name.get_ref<const std::string&>());
  }

  void object(const Json& value, const ObjectSchema& schema, const Path& path) {
    for (const Property& property : schema.properties)
      if (property.required && !value.contains(property.name))
        findings_.fatal("UNDEFINED_PROPERTY", path.parent ? path.str() : "/", "property '{}' must be defined",
                        property.name);
    for (const auto& [key, item] : value.items()) {
      const Path at{&path, key};
      if (key == "extras") continue;
      if (key == "extensions") {
        extensions(item, schema, at);
        continue;
      }
      const auto found = std::find_if(schema.properties.begin(), schema.properties.end(),
                                      [&](const Property& p) { return p.name == key; });
      if (found == schema.properties.end())
        findings_.warning("UNEXPECTED_PROPERTY", at.str(), "unexpected property, ignored");
      else
        property(item, *found, at);
    }
  }

 private:
  void extensions(const Json& value, const ObjectSchema& schema, const Path& path) {
    if (!value.is_object()) return type_mismatch(value, "object", Harm::fatal, path);
    for (const auto& [name, item] : value.items()) {
      const Path at{&path, name};
      if (!item.is_object()) {
        type_mismatch(item, "object", Harm::fatal, at);
        continue;
      }
      if (!declared_.contains(name))
        findings_.warning("UNDECLARED_EXTENSION", at.str(), "extension is not declared in extensionsUsed");
      extension_object(name, item, schema, at);
    }
  }

  void extension_object(const std::string& name, const Json& value, const ObjectSchema& schema, const Path& path) {
    bool known = false;
    for (const ExtensionSchema& entry : extension_schemas()) {
      if (entry.extension != name) continue;
      known = true;
      if (entry.place != schema.name) continue;
      if (entry.object) object(value, *entry.object, path);
      return;
    }
    if (known)
      findings_.warning("UNEXPECTED_EXTENSION_OBJECT", path.str(), "unexpected location for this extension, ignored");
  }

  void type_mismatch(const Json& value, std::string_view wanted, Harm harm, const Path& path, bool element = false) {
    findings_.add(harm, element ? "ARRAY_TYPE_MISMATCH" : "TYPE_MISMATCH", path.str(),
                  fmt::format("{} {} is not a {}", element ? "array element" : "value", excerpt(value), wanted));
  }

  void property(const Json& value, const Property& p, const Path& path) {
    switch (p.shape) {
      case Shape::any:
        return;
      case Shape::boolean:
        if (!value.is_boolean()) type_mismatch(value, "boolean", p.wrong_type, path);
        return;
      case Shape::integer:
        return integer_value(value, p, path);
      case Shape::number:
        return number_value(value, p, path);
      case Shape::string:
        return string_value(value, p, path);
      case Shape::index:
        return index_value(value, p.wrong_type, path);
      case Shape::object:
        if (!value.is_object()) return type_mismatch(value, "object", p.wrong_type, path);
        return object(value, *p.object, path);
      case Shape::index_map:
        return index_map(value, p, path);
      default:
        return array(value, p, path);
    }
  }

  void integer_value(const Json& value, const Property& p, const Path& path) {
    if (!is_whole(value)) return type_mismatch(value, "integer", p.wrong_type, path);
    const int64_t n = whole(value);
    if (!p.values.empty() && std::find(p.values.begin(), p.values.end(), n) == p.values.end())
      return findings_.add(p.unlisted, "VALUE_NOT_IN_LIST", path.str(),
                           fmt::format("{} is not one of ({})", n, fmt::join(p.values, ", ")));
    if (double(n) < p.lowest || double(n) > p.highest)
      findings_.add(p.outside, "VALUE_NOT_IN_RANGE", path.str(), fmt::format("value {} is out of range", n));
    else if (n % p.multiple_of != 0)
      findings_.fatal("VALUE_MULTIPLE_OF", path.str(), "value {} is not a multiple of {}", n, p.multiple_of);
  }

  // Values that miss the range by float rounding alone (1.0000001) are no reason to refuse a file.
  void number_value(const Json& value, const Property& p, const Path& path, bool element = false) {
    if (!value.is_number()) return type_mismatch(value, "number", p.wrong_type, element ? *path.parent : path, element);
    const double x = value.get<double>();
    const double largest = std::numeric_limits<float>::max();
    const bool representable = std::abs(x) <= largest;
    if (representable && x <= p.highest && (p.above_lowest ? x > p.lowest : x >= p.lowest)) return;
    const bool rounding = representable && !p.above_lowest && x <= p.highest + 1e-5 && x >= p.lowest - 1e-5;
    const Harm harm = !representable ? p.wrong_type : rounding ? Harm::warning : p.outside;
    findings_.add(harm, "VALUE_NOT_IN_RANGE", path.str(), fmt::format("value {} is out of range", x));
  }

  void string_value(const Json& value, const Property& p, const Path& path) {
    if (!value.is_string()) return type_mismatch(value, "string", p.wrong_type, path);
    const std::string& s = value.get_ref<const std::string&>();
    if (!p.names.empty() && std::find(p.names.begin(), p.names.end(), s) == p.names.end())
      findings_.add(p.unlisted, "VALUE_NOT_IN_LIST", path.str(),
                    fmt::format("{} is not one of ('{}')", excerpt(value), fmt::join(p.names, "', '")));
  }

  void index_value(const Json& value, Harm harm, const Path& path) {
    if (!is_whole(value)) return type_mismatch(value, "integer", harm, path);
    const int64_t n = whole(value);
    if (n < 0 || n > std::numeric_limits<int32_t>::max())
      findings_.add(harm, "INVALID_INDEX", path.str(),
                    fmt::format("index {} must be a non-negative integer below 2^31", n));
  }

  void index_map(const Json& value, const Property& p, const Path& path) {
    if (!value.is_object()) return type_mismatch(value, "object", p.wrong_type, path);
    if (value.empty()) findings_.add(p.empty, "EMPTY_ENTITY", path.str(), "entity cannot be empty");
    for (const auto& [key, item] : value.items()) index_value(item, Harm::fatal, Path{&path, key});
  }

  void array(const Json& value, const Property& p, const Path& path) {
    if (!value.is_array()) return type_mismatch(value, "array", p.wrong_type, path);
    if (value.empty()) return findings_.add(p.empty, "EMPTY_ENTITY", path.str(), "entity cannot be empty");
    if (!p.lengths.empty() && std::find(p.lengths.begin(), p.lengths.end(), value.size()) == p.lengths.end())
      return findings_.add(
          p.wrong_type, "ARRAY_LENGTH_NOT_IN_LIST", path.str(),
          fmt::format("array of {} elements, must have {}", value.size(), fmt::join(p.lengths, " or ")));
    for (size_t i = 0; i < value.size(); ++i) element(value[i], p, Path{&path, {}, i, true});
    if (p.unique) duplicates(value, p, path);
  }

  void element(const Json& value, const Property& p, const Path& path) {
    switch (p.shape) {
      case Shape::numbers:
        return number_value(value, p, path, true);
      case Shape::strings:
        if (!value.is_string()) type_mismatch(value, "string", p.wrong_type, *path.parent, true);
        return;
      case Shape::indices:
        if (!is_whole(value)) return type_mismatch(value, "integer", p.wrong_type, *path.parent, true);
        return index_value(value, p.wrong_type, path);
      case Shape::index_maps:
        if (!value.is_object()) return type_mismatch(value, "object", p.wrong_type, *path.parent, true);
        return index_map(value, p, path);
      default:
        if (!value.is_object()) return type_mismatch(value, "object", p.wrong_type, *path.parent, true);
        return object(value, *p.object, path);
    }
  }

  void duplicates(const Json& value, const Property& p, const Path& path) {
    std::unordered_set<std::string> seen;
    for (size_t i = 0; i < value.size(); ++i)
      if (!seen.insert(is_whole(value[i]) ? std::to_string(whole(value[i])) : excerpt(value[i])).second)
        findings_.add(p.repeated, "DUPLICATE_ELEMENTS", Path{&path, {}, i, true}.str(), "the element occurs twice");
  }

  Findings& findings_;
  std::unordered_set<std::string> declared_;
};

}  // namespace

void check_schema(const Json& root, Findings& findings) {
  if (!root.is_object()) return findings.fatal("TYPE_MISMATCH", "", "the document {} is not an object", excerpt(root));
  SchemaChecker(root, findings).object(root, root_schema(), Path{});
}

}  // namespace candela::validation
