#include "base/json.h"

#include <cmath>

#include "base/check.h"
#include "base/files.h"

namespace candela {
namespace {

// Builds the document while the parser runs and knows where in it the parser is, so that errors have a path.
template <class Json>
class DocumentBuilder : public nlohmann::json_sax<Json> {
 public:
  explicit DocumentBuilder(JsonDialect dialect) : dialect_(dialect) {}

  bool null() override { return put(Json()); }
  bool boolean(bool value) override { return put(Json(value)); }
  bool number_integer(int64_t value) override { return put(Json(value)); }
  bool number_unsigned(uint64_t value) override { return put(Json(value)); }
  bool number_float(double value, const std::string&) override {
    const bool whole =
        dialect_ == JsonDialect::gltf && std::trunc(value) == value && std::abs(value) < 9007199254740992.0;
    if (!whole) return put(Json(value));
    return value < 0 ? put(Json(int64_t(value))) : put(Json(uint64_t(value)));
  }
  bool string(std::string& value) override { return put(Json(std::move(value))); }
  bool binary(typename Json::binary_t&) override { return false; }
  bool start_object(size_t) override { return open(Json::object()); }
  bool start_array(size_t) override { return open(Json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }

  bool key(std::string& name) override {
    if (passing_over_) return true;
    if (dialect_ == JsonDialect::gltf && name == "extras") return passing_over_ = true;
    const Json& object = *open_.back();
    if (std::is_same_v<Json, nlohmann::ordered_json> && object.size() >= most_ordered_members)
      return stop(path(), fmt::format("an object has more than {} members", most_ordered_members));
    const bool repeated = object.contains(name);
    key_ = std::move(name);
    return !repeated || stop(path(), fmt::format("the key '{}' occurs twice in one object", key_.substr(0, 60)));
  }

  bool parse_error(size_t position, const std::string& token, const typename Json::exception& error) override {
    fault_.number_out_of_range = error.id == 406;
    if (fault_.number_out_of_range) return stop(path(), fmt::format("number {} is out of range", token.substr(0, 40)));
    return stop("", fmt::format("invalid JSON at byte {}: {}", position, reason(error.what())));
  }

  Json take() { return std::move(root_); }
  const JsonFault& fault() const { return fault_; }

 private:
  // nlohmann's text without its own prefix and without echoing the input, which may be binary.
  static std::string reason(std::string_view what) {
    if (const auto colon = what.find(": "); colon != std::string_view::npos) what.remove_prefix(colon + 2);
    if (const auto echo = what.find("; last read"); echo != std::string_view::npos) what = what.substr(0, echo);
    std::string printable;
    for (const char c : what.substr(0, 160)) printable += c >= ' ' && c < 127 ? c : '?';
    return printable;
  }

  bool stop(std::string path, std::string message) {
    fault_.path = std::move(path), fault_.message = std::move(message);
    return false;
  }

  std::string path() const {
    std::string text;
    for (size_t i = 0; i < open_.size(); ++i) {
      if (open_[i]->is_array())
        text += "/" + std::to_string(open_[i]->size() - (i + 1 < open_.size() ? 1 : 0));
      else
        text += "/" + pointer_token(i + 1 < open_.size() ? keys_[i + 1] : key_);
    }
    return text;
  }

  Json* put(Json value) {
    if (passing_over_) {
      if (depth_passed_over_ == 0) passing_over_ = false;  // a value without depth was all there was
      return &root_;
    }
    if (open_.empty()) {
      root_ = std::move(value);
      return &root_;
    }
    Json& parent = *open_.back();
    if (parent.is_array()) return &parent.emplace_back(std::move(value));
    return &(parent[key_] = std::move(value));
  }

  bool open(Json value) {
    if (passing_over_) {
      ++depth_passed_over_;
      return true;
    }
    if (open_.size() >= deepest_json)
      return stop("", fmt::format("objects and arrays nest deeper than {} levels", deepest_json));
    Json* placed = put(std::move(value));
    keys_.push_back(key_);
    open_.push_back(placed);
    return true;
  }

  bool close() {
    if (passing_over_) {
      passing_over_ = --depth_passed_over_ > 0;
      return true;
    }
    open_.pop_back();
    key_ = std::move(keys_.back());
    keys_.pop_back();
    return true;
  }

  JsonDialect dialect_;
  Json root_;
  std::vector<Json*> open_;  // the containers around the parser; a container grows only while it is the innermost one
  std::vector<std::string> keys_;  // the key under which open_[i] stands in its parent
  std::string key_;
  bool passing_over_ = false;  // the value of `extras`
  size_t depth_passed_over_ = 0;
  JsonFault fault_;
};

}  // namespace

template <class Json>
std::expected<Json, JsonFault> parse_json(std::string_view text, JsonDialect dialect) {
  DocumentBuilder<Json> builder(dialect);
  if (Json::sax_parse(text.begin(), text.end(), &builder)) return builder.take();
  return std::unexpected(builder.fault());
}
template std::expected<nlohmann::json, JsonFault> parse_json(std::string_view, JsonDialect);
template std::expected<nlohmann::ordered_json, JsonFault> parse_json(std::string_view, JsonDialect);

Expected<nlohmann::ordered_json> read_json(std::string_view text, const std::string& place) {
  auto json = parse_json<nlohmann::ordered_json>(text);
  if (json) return std::move(*json);
  const JsonFault& fault = json.error();
  const std::string separator = place.empty() || fault.path.empty() ? "" : ": ";
  return std::unexpected(Error{ErrorKind::input, fault.message, place + separator + fault.path});
}

Expected<nlohmann::ordered_json> read_json_file(const std::filesystem::path& file) {
  const auto bytes = read_file(file);
  if (!bytes) return std::unexpected(bytes.error());
  return read_json({reinterpret_cast<const char*>(bytes->data()), bytes->size()}, file.string());
}

nlohmann::ordered_json own_json(std::string_view text) {
  auto json = parse_json<nlohmann::ordered_json>(text);
  CHECK_MSG(json.has_value(), json ? "" : json.error().message);
  return std::move(*json);
}

std::string pointer_token(std::string_view key) {
  std::string token;
  for (const char c : key) {
    if (c == '~')
      token += "~0";
    else if (c == '/')
      token += "~1";
    else
      token += c;
  }
  return token;
}

}  // namespace candela
