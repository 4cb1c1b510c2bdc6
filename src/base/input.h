#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"

// What the program takes in, as rules of the whole process (docs/using/inputs.md). The command line sets them once,
// before anything is read; none of them changes a picture.
namespace candela {

struct InputRules {
  std::vector<std::filesystem::path> allowed_folders;           // beside the folder of the file that names another
  uint64_t decode_budget_bytes = uint64_t(4096) * 1024 * 1024;  // textures, sky and meshes of a scene together
};
const InputRules& input_rules();
void set_input_rules(InputRules rules);

// A file that another file, `namer`, names (a texture, the scene of a suite) must lie, links resolved, below `folder`
// or an allowed folder, and be a regular file where it is there at all. The error (input) says which rule it breaks;
// its place is empty. Whether it lies there, and where the namer had to lie, is seen again when read_file() has opened
// it under this path, for links may have changed in between. It is noted as read (base/file_uses.h).
Expected<void> check_named_file(const std::filesystem::path& file, const std::filesystem::path& folder,
                                const std::filesystem::path& namer = {});
// That of what was opened: `descriptor` of `file`. Files that no file named are free.
Expected<void> check_opened_file(int descriptor, const std::filesystem::path& file);

// A file that another program is going to read: there, regular and readable. Errors (input) name it.
Expected<void> check_regular_file(const std::filesystem::path& file);

// Adds what `place` takes decoded to the sum of its scene, before it is decoded. Error (input): over the budget.
Expected<void> charge_decoded(uint64_t& sum_bytes, uint64_t bytes, const std::string& place);

}  // namespace candela
