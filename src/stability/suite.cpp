#include <set>

#include "base/files.h"
#include "bench/suite_file.h"
#include "job/frame_choices.h"
#include "stability/stability.h"
#include "techniques/technique.h"

namespace candela {
using namespace suite_file;
namespace {

constexpr const char* built_in = "stability";

std::vector<std::string> techniques_or_auto() {
  std::vector<std::string> names = technique_names();
  names.emplace_back(auto_technique);
  return names;
}

// A text that is one of `names`.
auto one_of(const char* what, std::vector<std::string> names) {
  return [what, names = std::move(names)](const Json& j, const SuitePlace& at) -> Expected<std::string> {
    auto text = text_of(j, at);
    if (text && std::find(names.begin(), names.end(), *text) == names.end())
      return fail(ErrorKind::input, at.at, "{}", unknown_name(what, *text, names));
    return text;
  };
}

std::vector<std::string> families() {
  std::vector<std::string> names;
  for (const StabilityRecipe& recipe : stability_recipes())
    if (std::find(names.begin(), names.end(), recipe.family) == names.end()) names.push_back(recipe.family);
  return names;
}

template <class T, class Read>
auto list_into(std::vector<T> StabilityOptions::*member, Read read) {
  return [member, read](const Json& j, const SuitePlace& at, StabilityOptions& o) {
    return read_list(j, at, o.*member, read);
  };
}

Expected<void> text_alone(const Json& j, const SuitePlace& at, StabilityOptions&) {
  std::string text;
  return read_text(j, at, text);
}

Expected<void> read_large(const Json& j, const SuitePlace& at, StabilityOptions& o) {
  if (!j.is_boolean()) return at.wrong("is neither true nor false");
  o.large = j.get<bool>();
  return {};
}

Readers<StabilityOptions> readers() {
  return {{"suite",
           [](const Json& j, const SuitePlace& at, StabilityOptions&) -> Expected<void> {
             const auto name = one_of("built-in suite of a file", {built_in})(j, at);
             return name ? Expected<void>() : std::unexpected(name.error());
           }},
          {"name", text_alone},
          {"description", text_alone},
          {"families", list_into(&StabilityOptions::families, one_of("family", families()))},
          {"only", list_into(&StabilityOptions::only, text_of)},
          {"sizes", list_into(&StabilityOptions::sizes, size_of)},
          {"techniques", list_into(&StabilityOptions::techniques, one_of("technique", techniques_or_auto()))},
          {"seed", [](const Json& j, const SuitePlace& at,
                      StabilityOptions& o) { return read_whole(j, at, uint64_t(0), o.seed); }},
          {"large", read_large}};
}

}  // namespace

bool names_built_in_suite(const std::filesystem::path& file) {
  const auto j = read_json_file(file);
  return j && j->is_object() && j->contains("suite");
}

Expected<StabilityOptions> stability_suite_from_json(const std::string& text, const std::string& place) {
  const auto j = read_json(text, place);
  if (!j) return std::unexpected(j.error());
  if (!j->is_object()) return fail(ErrorKind::input, place, "is not a JSON object");
  StabilityOptions options;
  if (auto read = read_keys(*j, SuitePlace{{}, {}, place + ": "}, readers(), options); !read)
    return std::unexpected(read.error());
  if (std::set(options.sizes.begin(), options.sizes.end()).size() != options.sizes.size())
    return fail(ErrorKind::input, place + ": /sizes", "a size is given twice");
  return options;
}

Expected<StabilityOptions> read_stability_suite(const std::filesystem::path& file) {
  const auto bytes = read_file(file);
  if (!bytes) return std::unexpected(bytes.error());
  return stability_suite_from_json(std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size()),
                                   file.string());
}

}  // namespace candela
