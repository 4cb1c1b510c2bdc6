#include "job/dump_request.h"

#include <charconv>

#include "base/text.h"
#include "job/frame_choices.h"

namespace candela {

std::string DumpRequest::text() const {
  return mip == 0 && layer == 0 ? name : fmt::format("{}[{},{}]", name, mip, layer);
}

Expected<DumpRequest> parse_dump(const std::string& text, const std::string& option) {
  DumpRequest request;
  request.option = option;
  const size_t bracket = text.find('[');
  request.name = text.substr(0, bracket);
  const size_t point = request.name.find('.');
  bool fine = point != std::string::npos && point > 0 && point + 1 < request.name.size();
  if (bracket != std::string::npos) {
    const auto number = [&](std::string_view digits, uint32_t& value) {
      const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
      return error == std::errc() && end == digits.data() + digits.size();
    };
    const size_t comma = text.find(',', bracket);
    fine = fine && text.back() == ']' && comma != std::string::npos &&
           number(std::string_view(text).substr(bracket + 1, comma - bracket - 1), request.mip) &&
           number(std::string_view(text).substr(comma + 1, text.size() - comma - 2), request.layer);
  }
  if (!fine)
    return fail(ErrorKind::usage, option, "'{}' is not PASS.IMAGE or PASS.IMAGE[mip,layer], \"resolve.resolved[0,0]\"",
                text);
  return request;
}

std::optional<DumpRequest> image_of_view(const std::string& view) {
  const std::vector<std::string> views = view_names();
  if (!view.starts_with(image_view_prefix) || std::find(views.begin(), views.end(), view) != views.end()) return {};
  auto request = parse_dump(view.substr(image_view_prefix.size()), "--view");
  if (!request) return {};
  return *request;
}

}  // namespace candela
