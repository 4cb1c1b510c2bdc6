#pragma once
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "base/error.h"

namespace candela {

// Tells when files may have changed, by inotify on their folders: editors write another file and rename it over the
// old one, of which a watch on the file would see nothing. Folders that are not there are looked for again.
class FileWatch {
 public:
  static Expected<FileWatch> open();
  FileWatch(FileWatch&& other) noexcept;
  FileWatch& operator=(FileWatch&& other) noexcept;
  ~FileWatch();
  // From now on these: files by name, and all files of the folders. Links count by what they lead to as well.
  void set(const std::vector<std::filesystem::path>& files, const std::vector<std::filesystem::path>& folders);
  // Waits for an event. any: of any file in a watched folder. False: none came in that time.
  bool wait(int milliseconds, bool any);
  // What was missing and is there now counts as an event of wait().
  bool find_missing();

 private:
  FileWatch() = default;
  void add(const std::filesystem::path& folder);
  bool read_events(bool any);
  struct Folder {
    std::set<std::string> names;
    bool all = false;
    int watch = -1;  // -1: it is not there
  };
  int file_ = -1;
  std::map<std::filesystem::path, Folder> folders_;
};

}  // namespace candela
