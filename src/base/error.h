#pragma once
#include <fmt/format.h>

#include <expected>
#include <string>
#include <utility>

namespace candela {

// The value is the exit code of the program (docs/building/design.md, "Errors").
enum class ErrorKind : int {
  comparison = 1,
  usage = 2,
  input = 3,
  device = 4,
  output = 5,
  out_of_memory = 6,
  nonfinite = 7
};

// An error that the caller can act on. message: one line that says what is wrong and what to do next. place: file and,
// where there is one, the JSON path inside it ("scene.gltf: /materials/3/pbrMetallicRoughness/roughnessFactor"); may be
// empty.
struct Error {
  ErrorKind kind = ErrorKind::input;
  std::string message;
  std::string place;
  std::string text() const { return place.empty() ? message : place + ": " + message; }
};

template <class T>
using Expected = std::expected<T, Error>;

template <class... A>
std::unexpected<Error> fail(ErrorKind kind, std::string place, fmt::format_string<A...> format, A&&... args) {
  return std::unexpected(Error{kind, fmt::format(format, std::forward<A>(args)...), std::move(place)});
}

}  // namespace candela
