#include "base/file_watch.h"

#include <poll.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "base/file_uses.h"

namespace candela {
namespace fs = std::filesystem;
namespace {

constexpr uint32_t wanted_events = IN_CLOSE_WRITE | IN_MODIFY | IN_CREATE | IN_DELETE | IN_MOVED_FROM | IN_MOVED_TO |
                                   IN_ATTRIB | IN_DELETE_SELF | IN_MOVE_SELF | IN_ONLYDIR;

fs::path folder_holding(const fs::path& file) {
  return file.parent_path().empty() ? fs::path(".") : file.parent_path();
}

}  // namespace

Expected<FileWatch> FileWatch::open() {
  FileWatch watch;
  watch.file_ = inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
  if (watch.file_ < 0)
    return fail(ErrorKind::input, "", "files cannot be watched: {} (fs.inotify.max_user_instances)",
                std::strerror(errno));
  return watch;
}
FileWatch::FileWatch(FileWatch&& other) noexcept
    : file_(std::exchange(other.file_, -1)), folders_(std::move(other.folders_)) {}
FileWatch& FileWatch::operator=(FileWatch&& other) noexcept {
  std::swap(file_, other.file_);
  std::swap(folders_, other.folders_);
  return *this;
}
FileWatch::~FileWatch() {
  if (file_ >= 0) close(file_);
}

void FileWatch::add(const fs::path& folder) {
  Folder& f = folders_[folder];
  if (f.watch < 0) f.watch = inotify_add_watch(file_, folder.c_str(), wanted_events);
}

void FileWatch::set(const std::vector<fs::path>& files, const std::vector<fs::path>& folders) {
  for (auto& [path, folder] : folders_) folder.names.clear(), folder.all = false;
  for (const fs::path& file : files)
    for (const fs::path& path : {file, links_followed(file)})
      if (!path.empty()) folders_[folder_holding(path)].names.insert(path.filename().string());
  for (const fs::path& folder : folders) folders_[folder].all = true;
  for (auto at = folders_.begin(); at != folders_.end();) {
    const bool used = at->second.all || !at->second.names.empty();
    if (!used && at->second.watch >= 0) {
      // Two paths of one folder share its watch.
      bool shared = false;
      for (const auto& [path, other] : folders_)
        shared |= path != at->first && other.watch == at->second.watch && (other.all || !other.names.empty());
      if (!shared) inotify_rm_watch(file_, at->second.watch);
    }
    at = used ? std::next(at) : folders_.erase(at);
  }
  for (auto& [path, folder] : folders_) add(path);
}

bool FileWatch::find_missing() {
  bool found = false;
  for (auto& [path, folder] : folders_) {
    if (folder.watch >= 0) continue;
    add(path);
    found |= folder.watch >= 0;
  }
  return found;
}

bool FileWatch::read_events(bool any) {
  alignas(inotify_event) std::array<char, 16384> buffer;
  bool matters = false;
  for (ssize_t size; (size = read(file_, buffer.data(), buffer.size())) > 0;)
    for (ssize_t at = 0; at < size;) {
      const auto* event = reinterpret_cast<const inotify_event*>(buffer.data() + at);
      at += ssize_t(sizeof(inotify_event) + event->len);
      if (event->mask & IN_Q_OVERFLOW) matters = true;
      for (auto& [path, folder] : folders_) {
        if (folder.watch != event->wd) continue;
        const bool gone = event->mask & (IN_IGNORED | IN_DELETE_SELF | IN_MOVE_SELF);
        if (gone) {
          if (event->mask & IN_MOVE_SELF) inotify_rm_watch(file_, folder.watch);
          folder.watch = -1;  // another may take its name
        }
        matters |= gone || any || folder.all || (event->len > 0 && folder.names.contains(event->name));
      }
    }
  return matters;
}

bool FileWatch::wait(int milliseconds, bool any) {
  pollfd ready{file_, POLLIN, 0};
  return poll(&ready, 1, milliseconds) > 0 && read_events(any);
}

}  // namespace candela
