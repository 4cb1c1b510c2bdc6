#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "base/error.h"

namespace CLI {
class App;
}

namespace candela::cli {

// What a command does with the files that an option names.
enum class FileUse : uint8_t {
  neither,          // only the ending of the name matters
  read,             //
  scene,            // read, and the look file beside it
  sky,              // read: an image, or six
  path,             // read: FILE,times=FILE, a name before it or not
  instances,        // read: NODE=FILE
  pattern_read,     // read: a file, a folder or a pattern
  read_folder,      // all that is in it
  searched_folder,  // files in it are read where other files name them
  written,          // "-" is stdout
  pattern,          // written, under a name that may hold places for the frame's number
  dump,             // written: PASS.IMAGE=FILE
  written_folder,   // files of fixed names in it, and others that are declared when they are known
};
// Of a command ("check" of `golden check`) and an option ("--look") or positional ("scene"); nothing for options that
// name no files. tests/unit/cli_file_options.cpp asks for every option of the parser.
std::optional<FileUse> file_use(const std::string& command, const std::string& option);

// Notes what the options given name for reading, and declares what they name for writing (base/file_uses.h): before
// anything is opened, by whatever way the options came. Error (usage): an output is an input, or another output.
Expected<void> check_file_options(const CLI::App& command);

}  // namespace candela::cli
