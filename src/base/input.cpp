#include "base/input.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <map>
#include <mutex>
#include <set>

#include "base/file_uses.h"

namespace candela {
namespace fs = std::filesystem;
namespace {

InputRules& rules() {
  static InputRules of_the_process;
  return of_the_process;
}

bool lies_below(const fs::path& file, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first == folder.end();
}

// Links resolved; of what is not there, as far as it is. Empty: a loop of links, a folder that may not be read.
fs::path resolved(const fs::path& path) {
  std::error_code failed;
  fs::path real = fs::weakly_canonical(fs::absolute(path.empty() ? fs::path(".") : path, failed), failed);
  if (failed) return {};
  return real.has_filename() ? real : real.parent_path();
}

// Files that other files name, and the folders of these, links resolved.
struct Named {
  std::mutex mutex;
  std::map<fs::path, std::set<fs::path>> homes;
};
Named& named() {
  static Named of_the_process;
  return of_the_process;
}

Expected<void> check_place(const fs::path& real, const fs::path& home) {
  const auto holds = [&](const fs::path& allowed) { return lies_below(real, resolved(allowed)); };
  if (!home.empty() &&
      (lies_below(real, home) || std::any_of(rules().allowed_folders.begin(), rules().allowed_folders.end(), holds)))
    return {};
  return fail(ErrorKind::input, "",
              "{} lies outside {}: a file may name only files below its own folder (--allow-path DIR allows another "
              "folder)",
              real.string(), home.string());
}

}  // namespace

const InputRules& input_rules() { return rules(); }
void set_input_rules(InputRules given) { rules() = std::move(given); }

Expected<void> check_named_file(const fs::path& file, const fs::path& folder, const fs::path& namer) {
  const fs::path real = resolved(file), home = resolved(folder);
  if (real.empty()) return fail(ErrorKind::input, "", "{} cannot be followed to a file", file.string());
  if (auto allowed = check_place(real, home); !allowed) return allowed;
  std::error_code failed;
  if (fs::exists(real, failed) && !fs::is_regular_file(real, failed))
    return fail(ErrorKind::input, "", "{} is no regular file, and others are not read", real.string());
  note_read({namer.string(), file});
  const std::scoped_lock lock(named().mutex);
  std::set<fs::path> homes = {home};
  if (const auto of_namer = named().homes.find(namer); of_namer != named().homes.end())
    homes.insert(of_namer->second.begin(), of_namer->second.end());
  named().homes[file].merge(homes);
  return {};
}

Expected<void> check_opened_file(int descriptor, const fs::path& file) {
  std::set<fs::path> homes;
  {
    const std::scoped_lock lock(named().mutex);
    const auto found = named().homes.find(file);
    if (found == named().homes.end()) return {};
    homes = found->second;
  }
  std::error_code failed;
  const fs::path real = fs::read_symlink(fmt::format("/proc/self/fd/{}", descriptor), failed);
  if (failed) return fail(ErrorKind::input, file.string(), "cannot be followed to a file: {}", failed.message());
  for (const fs::path& home : homes)
    if (auto allowed = check_place(real, home); !allowed)
      return fail(ErrorKind::input, file.string(), "{}", allowed.error().message);
  return {};
}

Expected<void> check_regular_file(const fs::path& file) {
  note_read({"", file});
  if (access(file.c_str(), R_OK) != 0)
    return fail(ErrorKind::input, file.string(), "cannot open: {}", std::strerror(errno));
  std::error_code failed;
  if (!fs::is_regular_file(file, failed))
    return fail(ErrorKind::input, file.string(), "is a folder, FIFO or device, not a regular file");
  return {};
}

Expected<void> charge_decoded(uint64_t& sum_bytes, uint64_t bytes, const std::string& place) {
  const uint64_t budget = rules().decode_budget_bytes;
  const auto mib = [](uint64_t b) { return (b + (1 << 20) - 1) >> 20; };
  sum_bytes += bytes;
  if (sum_bytes <= budget) return {};
  return fail(ErrorKind::input, place,
              "decoded it takes {} MiB and the sum of textures, sky and meshes is {} MiB, more than the budget of {} "
              "MiB (--decode-budget-mb sets another)",
              mib(bytes), mib(sum_bytes), mib(budget));
}

}  // namespace candela
