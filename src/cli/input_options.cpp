#include "cli/input_options.h"

#include <CLI/CLI.hpp>

#include "base/input.h"
#include "cli/job_options.h"

namespace candela::cli {

void add_decode_budget(CLI::App& command) {
  command
      .add_option_function<uint64_t>(
          "--decode-budget-mb",
          [](const uint64_t& mib) {
            constexpr uint64_t most = uint64_t(1) << 40;
            if (mib == 0 || mib > most)
              throw CLI::ValidationError("--decode-budget-mb", fmt::format("{} is not from 1 to {}", mib, most));
            InputRules rules = input_rules();
            rules.decode_budget_bytes = mib << 20;
            set_input_rules(std::move(rules));
          },
          "MiB that the decoded textures, sky and meshes of a scene may take (4096); more is exit 3")
      ->transform(whole_number<uint64_t>())
      ->type_name("MIB");
}

void add_input_options(CLI::App& command) {
  command
      .add_option_function<std::vector<std::string>>(
          "--allow-path",
          [](const std::vector<std::string>& folders) {
            InputRules rules = input_rules();
            rules.allowed_folders.clear();
            for (const std::string& folder : folders) {
              std::error_code failed;
              if (!std::filesystem::is_directory(folder, failed))
                throw CLI::ValidationError("--allow-path", fmt::format("'{}' is not a folder", folder));
              rules.allowed_folders.emplace_back(folder);
            }
            set_input_rules(std::move(rules));
          },
          "Another folder in which scenes and suites may name files, besides their own; may be given again")
      ->allow_extra_args(false)
      ->type_name("DIR");
  add_decode_budget(command);
}

}  // namespace candela::cli
