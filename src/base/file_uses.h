#pragma once
#include <compare>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "base/error.h"

// What a run reads and what it is going to write, so that nothing that was read is overwritten and no two outputs are
// one file. Of the whole process, as base/input.h: read_file() notes what it reads, commands what they write.
namespace candela {

// The file that a path means, through all links: its device and inode. Of one that is not there yet those of the
// nearest folder that is, and the rest of its path.
struct FileIdentity {
  uint64_t device = 0, inode = 0;
  std::string rest;
  auto operator<=>(const FileIdentity&) const = default;
};
// Nothing for what is no regular file (a device, pipe or folder, which loses nothing) and for loops of links.
std::optional<FileIdentity> file_identity(const std::filesystem::path& path);

// The absolute path without links, also where the last of them leads to what is not there. Empty: a loop.
std::filesystem::path links_followed(const std::filesystem::path& path);

// A file and the option that names it, as messages say it: "--timings", "SCENE".
struct NamedFile {
  std::string option;
  std::filesystem::path file;
};

void note_read(const NamedFile& input);                             // also one that is not there
void note_read(int descriptor, const std::filesystem::path& file);  // whoever named it
void note_written(int descriptor);                                  // by this process: it may be read again
// Before any of them is opened. An error (usage) where one is a file that was noted as read, or another output; an
// output that was declared before, by the same option and path, may be declared again.
Expected<void> declare_outputs(std::span<const NamedFile> outputs);
// The same of more files than can be listed: those whose absolute path without links `holds` says.
Expected<void> declare_outputs(const std::string& option, std::function<bool(const std::filesystem::path& file)> holds);
// That no declared output is a file that was read since, as the textures of a scene.
Expected<void> check_outputs();
// The same of one file, which may be no declared one.
Expected<void> check_output(const std::filesystem::path& output);
void forget_file_uses();

}  // namespace candela
