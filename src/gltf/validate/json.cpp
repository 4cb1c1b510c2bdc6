#include "base/json.h"
#include "gltf/validate/validate.h"

namespace candela {

Expected<nlohmann::json> parse_gltf_json(std::span<const std::byte> bytes, const std::string& name) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.starts_with("\xEF\xBB\xBF"))
    return fail(ErrorKind::input, name,
                "the JSON starts with a byte order mark, which glTF forbids; remove it (INVALID_JSON)");
  auto json = parse_json<nlohmann::json>(text, JsonDialect::gltf);
  if (json) return std::move(*json);
  const JsonFault& fault = json.error();
  const size_t first = text.find_first_not_of(" \t\r\n");
  if (first != text.npos && text[first] != '{' && text[first] != '[')
    return fail(ErrorKind::input, name,
                "is not a glTF file; other formats have to be converted to .gltf or .glb first: {} (INVALID_JSON)",
                fault.message);
  return fail(ErrorKind::input, fault.path.empty() ? name : name + ": " + fault.path, "{} ({})", fault.message,
              fault.number_out_of_range ? "VALUE_NOT_IN_RANGE" : "INVALID_JSON");
}

}  // namespace candela
