#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace candela::test {

struct Ended {
  int code = -1;  // exit code, or 128 + signal
  std::string out, err;
};

// Runs a program to its end; the first argument is searched on PATH.
Ended run_program(std::vector<std::string> arguments, const std::string& folder = {});
// The program under test.
Ended candela(std::vector<std::string> arguments, const std::string& folder = {});

// Starts it with its outputs in two files; the process.
int start_candela(std::vector<std::string> arguments, const std::string& out, const std::string& err);
// Starts it and kills it after the time given; true when it was killed before it ended.
bool candela_killed_after(std::vector<std::string> arguments, int milliseconds, int signal);
// The same once the file is there, however long that takes; false when it ended first.
bool candela_killed_once_written(std::vector<std::string> arguments, const std::string& file, int signal);

// A fresh folder for one test, removed afterwards.
class TestFolder {
 public:
  TestFolder();
  ~TestFolder();
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;
  std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

std::string bytes_of(const std::filesystem::path& file);
std::vector<std::string> files_in(const std::filesystem::path& folder);  // names, sorted, hidden ones too
std::string scene(const std::string& name);                              // scenes/NAME/NAME.glb

}  // namespace candela::test
