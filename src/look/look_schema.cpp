// The reader's keys as a JSON Schema.
#include "look/look_rows.h"

namespace candela {
namespace {

using look_rows::Json;

Json number_schema(const LookKey& key) {
  Json j;
  j["type"] = "number";
  if (std::isfinite(key.low)) j[key.above_low ? "exclusiveMinimum" : "minimum"] = key.low;
  if (std::isfinite(key.high)) j["maximum"] = key.high;
  return j;
}

Json list_schema(Json items, size_t least, size_t most) {
  return {{"type", "array"}, {"items", std::move(items)}, {"minItems", least}, {"maxItems", most}};
}

// The value as it stands, or keys over time.
Json over_time(const Json& value) {
  Json key = {{"type", "array"},
              {"prefixItems", Json::array({Json{{"type", "number"}}, value})},
              {"minItems", 2},
              {"maxItems", 2}};
  Json properties;
  properties["keys"] = {{"type", "array"}, {"items", std::move(key)}, {"minItems", 1}};
  properties["interpolation"] = {{"enum", {"linear", "step", "cubic"}}};
  Json keyed = {{"type", "object"}, {"properties", properties}, {"required", {"keys"}}};
  keyed["additionalProperties"] = false;
  return {{"anyOf", Json::array({value, keyed})}};
}

Json object_schema(const std::vector<LookKey>& keys);

Json schema_of(const LookKey& key) {
  switch (key.kind) {
    case LookKey::Kind::object:
      return object_schema(key.keys);
    case LookKey::Kind::objects:
      return {{"type", "array"}, {"items", object_schema(key.keys)}, {"maxItems", key.most}};
    case LookKey::Kind::number:
      return key.fixed ? number_schema(key) : over_time(number_schema(key));
    case LookKey::Kind::numbers:
      if (key.fixed) return list_schema(number_schema(key), key.least, key.most);
      return over_time(list_schema(number_schema(key), key.least, key.most));
    case LookKey::Kind::color:
      return over_time({{"anyOf", Json::array({number_schema(key), list_schema(number_schema(key), 3, 3)})}});
    case LookKey::Kind::flag:
      return {{"type", "boolean"}};
    case LookKey::Kind::texts:
      return {{"type", "array"}, {"items", {{"type", "string"}}}};
    case LookKey::Kind::text:
      if (!key.choices.empty()) return {{"enum", key.choices}};
      return {{"type", "string"}, {"minLength", 1}};
  }
  return {};
}

Json object_schema(const std::vector<LookKey>& keys) {
  Json properties = Json::object();
  for (const LookKey& key : keys) {
    Json j = {{"description", key.help}};
    j.update(schema_of(key));
    properties[key.name] = std::move(j);
  }
  return {{"type", "object"}, {"properties", std::move(properties)}, {"additionalProperties", false}};
}

}  // namespace

std::string look_schema() {
  Json j = {{"title", "candela look file"},
            {"description", "What a picture shows beside its scene (docs/using/look.md)."}};
  j.update(object_schema(look_keys()));
  return j.dump(2) + "\n";
}

}  // namespace candela
