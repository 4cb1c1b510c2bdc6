#include "base/file_uses.h"

#include <sys/stat.h>

#include <cerrno>
#include <deque>
#include <map>
#include <mutex>
#include <set>
#include <vector>

namespace candela {
namespace fs = std::filesystem;
namespace {

struct Declared {
  NamedFile output;
  int call = 0;  // of declare_outputs()
};

struct Uses {
  std::mutex mutex;
  std::map<FileIdentity, NamedFile> read;
  std::map<FileIdentity, Declared> written;
  struct Rule {
    std::string option;
    std::function<bool(const fs::path&)> holds;
  };
  std::vector<Rule> rules;  // outputs that are told by their names
  int calls = 0;
  std::set<FileIdentity> own;  // files that this process made
};
Uses& uses() {
  static Uses of_the_process;
  return of_the_process;
}

FileIdentity identity_of(const struct stat& info) { return {uint64_t(info.st_dev), uint64_t(info.st_ino), {}}; }

// Of a path without links whose end is not there.
std::optional<FileIdentity> identity_of_absent(const fs::path& path) {
  fs::path folder = path.parent_path(), rest = path.filename();
  struct stat info {};
  while (stat(folder.c_str(), &info) != 0) {
    if (folder == folder.root_path()) return {};
    rest = folder.filename() / rest;
    folder = folder.parent_path();
  }
  FileIdentity identity = identity_of(info);
  identity.rest = rest.string();
  return identity;
}

// Many outputs lie in one folder, whose identity is looked up once.
class Identities {
 public:
  std::optional<FileIdentity> of(const fs::path& path) {
    struct stat info {};
    if (lstat(path.c_str(), &info) == 0 || errno != ENOENT) return file_identity(path);
    const fs::path folder = path.parent_path();
    auto known = folders_.find(folder);
    if (known == folders_.end()) {
      // Of some file in it: what is not there may come to lie in a folder that is not there.
      const auto absent = identity_of_absent(links_followed(folder) / "x");
      known = folders_.emplace(folder, absent).first;
    }
    if (!known->second || path.filename() == ".." || path.filename() == ".") return file_identity(path);
    FileIdentity identity = *known->second;
    identity.rest.replace(identity.rest.size() - 1, 1, path.filename().string());
    return identity;
  }

 private:
  std::map<fs::path, std::optional<FileIdentity>> folders_;
};

std::string called(const NamedFile& output, const NamedFile& other) {
  return output.file == other.file
             ? fmt::format("'{}'", output.file.string())
             : fmt::format("'{}', the same file as '{}',", output.file.string(), other.file.string());
}

Expected<void> overwrites(const NamedFile& output, const NamedFile& input) {
  return fail(ErrorKind::usage, output.option,
              "{} is read{}, and nothing that is read is overwritten; name another file", called(output, input),
              input.option.empty() ? "" : " for " + input.option);
}

// Inodes are used again: what was read may be gone since.
bool still_there(const NamedFile& input, const FileIdentity& identity) { return file_identity(input.file) == identity; }

Expected<void> check_read(const FileIdentity& identity, const NamedFile& output) {
  const auto input = uses().read.find(identity);
  if (input == uses().read.end() || !still_there(input->second, identity)) return {};
  return overwrites(output, input->second);
}

Expected<void> check_rule(const Uses::Rule& rule, const FileIdentity& identity, const NamedFile& input) {
  if (!rule.holds(links_followed(input.file)) || !still_there(input, identity)) return {};
  return overwrites({rule.option, input.file}, input);
}

}  // namespace

fs::path links_followed(const fs::path& path) {
  std::error_code failed;
  const fs::path whole = fs::absolute(path.empty() ? fs::path(".") : path, failed);
  std::deque<fs::path> rest(whole.begin(), whole.end());
  fs::path real = whole.root_path();
  constexpr int most_links = 40;  // as the kernel's
  for (int links = 0; !rest.empty();) {
    const fs::path part = rest.front();
    rest.pop_front();
    if (part.empty() || part == "." || part == whole.root_path()) continue;
    if (part == "..") {
      real = real.parent_path();
      continue;
    }
    const fs::path target = fs::read_symlink(real / part, failed);
    if (failed) {
      real /= part;
      continue;
    }
    if (++links > most_links) return {};
    if (target.is_absolute()) real = target.root_path();
    rest.insert(rest.begin(), target.begin(), target.end());
  }
  return real;
}

std::optional<FileIdentity> file_identity(const fs::path& path) {
  struct stat info {};
  if (stat(path.c_str(), &info) == 0) return S_ISREG(info.st_mode) ? std::optional(identity_of(info)) : std::nullopt;
  if (errno != ENOENT) return {};
  const fs::path real = links_followed(path);
  if (real.empty() || !real.has_filename()) return {};
  return stat(real.c_str(), &info) == 0 && S_ISREG(info.st_mode) ? std::optional(identity_of(info))
                                                                 : identity_of_absent(real);
}

void note_read(const NamedFile& input) {
  const auto identity = file_identity(input.file);
  if (!identity) return;
  const std::scoped_lock lock(uses().mutex);
  NamedFile& noted = uses().read[*identity];
  if (noted.option.empty() || !still_there(noted, *identity)) noted = input;
}

void note_read(int descriptor, const fs::path& file) {
  struct stat info {};
  if (fstat(descriptor, &info) != 0 || !S_ISREG(info.st_mode)) return;
  const FileIdentity identity = identity_of(info);
  const std::scoped_lock lock(uses().mutex);
  if (uses().own.contains(identity)) return;
  const auto [noted, fresh] = uses().read.emplace(identity, NamedFile{"", file});
  if (!fresh && !still_there(noted->second, identity)) noted->second = {"", file};
}

void note_written(int descriptor) {
  struct stat info {};
  if (fstat(descriptor, &info) != 0) return;
  const std::scoped_lock lock(uses().mutex);
  uses().own.insert(identity_of(info));
}

Expected<void> declare_outputs(std::span<const NamedFile> outputs) {
  Identities identities;
  const std::scoped_lock lock(uses().mutex);
  auto& written = uses().written;
  const int call = ++uses().calls;
  std::vector<decltype(uses().written)::iterator> added;
  const auto refuse = [&](const Error& error) -> Expected<void> {
    for (const auto& place : added) written.erase(place);
    return std::unexpected(error);
  };
  for (const NamedFile& output : outputs) {
    const auto identity = identities.of(output.file);
    if (!identity) continue;
    if (auto fine = check_read(*identity, output); !fine) return refuse(fine.error());
    const auto [place, fresh] = written.try_emplace(*identity, Declared{output, call});
    if (fresh) {
      added.push_back(place);
      continue;
    }
    const NamedFile& other = place->second.output;
    if (place->second.call == call || other.option != output.option || other.file != output.file)
      return refuse(
          {ErrorKind::usage,
           fmt::format("{} is written twice, for {} too; name two files", called(output, other), other.option),
           output.option});
    place->second.call = call;
  }
  return {};
}

Expected<void> declare_outputs(const std::string& option, std::function<bool(const fs::path&)> holds) {
  const std::scoped_lock lock(uses().mutex);
  const Uses::Rule rule{option, std::move(holds)};
  for (const auto& [identity, input] : uses().read)
    if (auto fine = check_rule(rule, identity, input); !fine) return fine;
  for (const auto& [identity, declared] : uses().written)
    if (rule.holds(links_followed(declared.output.file)))
      return fail(ErrorKind::usage, option, "'{}' is written twice, for {} too; name two files",
                  declared.output.file.string(), declared.output.option);
  uses().rules.push_back(rule);
  return {};
}

Expected<void> check_outputs() {
  const std::scoped_lock lock(uses().mutex);
  for (const Uses::Rule& rule : uses().rules)
    for (const auto& [identity, input] : uses().read)
      if (auto fine = check_rule(rule, identity, input); !fine) return fine;
  if (uses().written.empty()) return {};
  for (const auto& [identity, input] : uses().read)
    if (const auto output = uses().written.find(identity);
        output != uses().written.end() && still_there(input, identity))
      return overwrites(output->second.output, input);
  return {};
}

Expected<void> check_output(const fs::path& output) {
  const auto identity = file_identity(output);
  if (!identity) return {};
  const std::scoped_lock lock(uses().mutex);
  const auto declared = uses().written.find(*identity);
  return check_read(*identity,
                    declared != uses().written.end() ? declared->second.output : NamedFile{output.string(), output});
}

void forget_file_uses() {
  const std::scoped_lock lock(uses().mutex);
  uses().read.clear(), uses().written.clear(), uses().rules.clear(), uses().own.clear();
}

}  // namespace candela
