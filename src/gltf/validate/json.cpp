#include <cmath>
#include <nlohmann/json.hpp>

#include "gltf/validate/internal.h"
#include "gltf/validate/validate.h"

namespace candela {
namespace {

using nlohmann::json;

// No glTF nests deeper than a few dozen levels; later recursive readers of the document rely on this bound.
constexpr size_t deepest_nesting = 128;

// Builds the document while the parser runs and knows where in it the parser is, so that errors have a JSON path.
class DocumentBuilder : public nlohmann::json_sax<json> {
 public:
  bool null() override { return put(json()); }
  bool boolean(bool value) override { return put(json(value)); }
  bool number_integer(int64_t value) override { return put(json(value)); }
  bool number_unsigned(uint64_t value) override { return put(json(value)); }
  bool number_float(double value, const std::string&) override {
    const bool exact_integer = std::trunc(value) == value && std::abs(value) < 9007199254740992.0;
    if (!exact_integer) return put(json(value));
    return value < 0 ? put(json(int64_t(value))) : put(json(uint64_t(value)));
  }
  bool string(std::string& value) override { return put(json(std::move(value))); }
  bool binary(json::binary_t&) override { return false; }
  bool start_object(size_t) override { return open(json::object()); }
  bool start_array(size_t) override { return open(json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }

  bool key(std::string& name) override {
    if (open_.back()->contains(name)) {
      key_ = name;
      return stop("INVALID_JSON", path(), fmt::format("the key '{}' occurs twice in one object", name.substr(0, 60)));
    }
    key_ = std::move(name);
    return true;
  }

  bool parse_error(size_t position, const std::string& token, const json::exception& error) override {
    if (error.id == 406)
      return stop("VALUE_NOT_IN_RANGE", path(), fmt::format("number {} is out of range", token.substr(0, 40)));
    return stop("INVALID_JSON", "", fmt::format("invalid JSON at byte {}: {}", position, reason(error.what())));
  }

  json take() { return std::move(root_); }
  const Finding& error() const { return error_; }

 private:
  // nlohmann's text without its own prefix and without echoing the input, which may be binary.
  static std::string reason(std::string_view what) {
    if (const auto colon = what.find(": "); colon != std::string_view::npos) what.remove_prefix(colon + 2);
    if (const auto echo = what.find("; last read"); echo != std::string_view::npos) what = what.substr(0, echo);
    std::string printable;
    for (const char c : what.substr(0, 160)) printable += c >= ' ' && c < 127 ? c : '?';
    return printable;
  }

  bool stop(std::string_view code, std::string path, std::string message) {
    error_ = {true, std::string(code), std::move(path), std::move(message)};
    return false;
  }

  std::string path() const {
    std::string text;
    for (size_t i = 0; i < open_.size(); ++i) {
      if (open_[i]->is_array())
        text += "/" + std::to_string(open_[i]->size() - (i + 1 < open_.size() ? 1 : 0));
      else
        text += "/" + validation::pointer_token(i + 1 < open_.size() ? keys_[i + 1] : key_);
    }
    return text;
  }

  json* put(json value) {
    if (open_.empty()) {
      root_ = std::move(value);
      return &root_;
    }
    json& parent = *open_.back();
    if (parent.is_array()) return &parent.emplace_back(std::move(value));
    return &(parent[key_] = std::move(value));
  }

  bool open(json value) {
    if (open_.size() >= deepest_nesting)
      return stop("INVALID_JSON", "", fmt::format("objects and arrays nest deeper than {} levels", deepest_nesting));
    json* placed = put(std::move(value));
    keys_.push_back(key_);
    open_.push_back(placed);
    return true;
  }

  bool close() {
    open_.pop_back();
    key_ = std::move(keys_.back());
    keys_.pop_back();
    return true;
  }

  json root_;
  std::vector<json*> open_;  // the containers around the parser; a container grows only while it is the innermost one
  std::vector<std::string> keys_;  // the key under which open_[i] stands in its parent
  std::string key_;
  Finding error_;
};

}  // namespace

Expected<json> parse_gltf_json(std::span<const std::byte> bytes, const std::string& name) {
  const char* first = reinterpret_cast<const char*>(bytes.data());
  const std::string_view text(first, bytes.size());
  if (text.starts_with("\xEF\xBB\xBF"))
    return fail(ErrorKind::input, name,
                "the JSON starts with a byte order mark, which glTF forbids; remove it (INVALID_JSON)");
  DocumentBuilder builder;
  if (json::sax_parse(text.begin(), text.end(), &builder)) return builder.take();
  const Finding& error = builder.error();
  return fail(ErrorKind::input, error.path.empty() ? name : name + ": " + error.path, "{} ({})", error.message,
              error.code);
}

}  // namespace candela
