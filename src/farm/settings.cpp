#include "farm/quote.h"
#include "farm/writers.h"

namespace candela {

std::string path_settings(const FarmJob& job, std::string_view end) {
  const std::filesystem::path work = job.work_from_folder();
  return fmt::format("work={}{}{}candela=${{CANDELA_PROGRAM:-{}}}{}scene=${{CANDELA_SCENE:-{}}}{}",
                     work.is_absolute() ? "" : "$folder/", shell_quoted(work.string()), end, shell_quoted(job.program),
                     end, shell_quoted(job.arguments.front()), end);
}

std::span<const std::string> words_after_scene(const FarmJob& job) { return std::span(job.arguments).subspan(1); }

}  // namespace candela
