#include "frame/content_hash.h"

#include "base/files.h"

namespace candela {

Expected<Hash128> hash_files(const std::vector<std::string>& files, const std::string& sky, const std::string& look) {
  std::string digests;
  const auto add = [&](const std::string& file) -> Expected<void> {
    const auto bytes = read_file(file);
    if (!bytes) return std::unexpected(bytes.error());
    digests += hash128(*bytes).hex();
    return {};
  };
  for (const std::string& file : files)
    if (auto done = add(file); !done) return std::unexpected(done.error());
  for (const std::string& file : {sky, look})
    if (!file.empty())
      if (auto done = add(file); !done) return std::unexpected(done.error());
  return hash128(digests);
}

}  // namespace candela
