#pragma once
#include <chrono>
#include <cstdio>
#include <functional>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "base/error.h"

// A measured program renders a frame whenever a line on its standard input asks for one, so that a driver can take one
// frame of each program in turn (lights.py) and whatever slows the machine down slows all of them. One line of JSON
// answers each line:
//   frame SECONDS   renders the scene at that time; {"ms": wall time until the pixels lie in host memory, ...}
//   save FILE.png   writes the last frame
namespace candela::peers {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;
inline double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

struct FrameServer {
  Json about;                                          // the first line: device, driver, version
  std::function<Expected<Json>(double time_s)> frame;  // the answer, without "ms"
  std::function<Expected<void>(const std::string& file)> save;

  // The exit code.
  int run() {
    std::cout << about.dump() << std::endl;
    for (std::string line; std::getline(std::cin, line);) {
      std::istringstream words(line);
      std::string command, argument;
      words >> command >> argument;
      Expected<Json> answer = Json::object();
      if (command == "frame") {
        const auto start = Clock::now();
        answer = frame(std::stod(argument));
        const double ms = ms_since(start);
        if (answer) (*answer)["ms"] = ms;
      } else if (command == "save") {
        if (auto saved = save(argument); !saved) answer = std::unexpected(saved.error());
      } else {
        answer = fail(ErrorKind::usage, "", "'{}' is neither frame nor save", command);
      }
      if (!answer) {
        std::fprintf(stderr, "%s\n", answer.error().text().c_str());
        return int(answer.error().kind);
      }
      std::cout << answer->dump() << std::endl;
    }
    return 0;
  }
};

}  // namespace candela::peers
