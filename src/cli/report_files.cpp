#include "cli/report_files.h"

#include <filesystem>

#include "base/file_uses.h"
#include "base/files.h"
#include "base/log.h"
#include "cli/build_info.h"
#include "render/frame_names.h"
#include "report/gnuplot.h"
#include "report/page.h"

namespace candela::cli {
namespace fs = std::filesystem;

Expected<void> prepare_report(const std::string& folder) {
  if (folder.empty()) return {};
  for (const char* file : {"index.html", "figures/01.svg"})
    if (auto ready = prepare_output(fs::path(folder) / file); !ready) return ready;
  return {};
}

Expected<void> write_report(const std::string& folder, const std::vector<std::pair<std::string, std::string>>& files,
                            const std::function<std::string(Figures&)>& page) {
  if (folder.empty()) return {};
  Figures figures(has_gnuplot());
  const std::string html = page(figures);
  if (!figures.draws())
    log::warning("gnuplot is not on PATH (apt install gnuplot-nox): the report has tables and no figures");
  const auto write = [&](const fs::path& file, const std::string& bytes) {
    return write_file_atomically(fs::path(folder) / file, std::string_view(bytes));
  };
  std::vector<NamedFile> named = {{"--report", fs::path(folder) / "index.html"}};
  for (const auto& [name, bytes] : figures.files()) named.push_back({"--report", fs::path(folder) / "figures" / name});
  for (const auto& [name, bytes] : files) named.push_back({"--report", fs::path(folder) / name});
  if (auto fine = declare_outputs(named); !fine) return fine;
  for (const auto& [name, bytes] : figures.files())
    if (auto written = write(fs::path("figures") / name, bytes); !written) return written;
  for (const auto& [name, bytes] : files)
    if (auto written = write(name, bytes); !written) return written;
  return write("index.html", html);
}

std::string this_program() { return program_text(CANDELA_VERSION, source_version); }

}  // namespace candela::cli
