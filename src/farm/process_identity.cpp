#include "farm/process_identity.h"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace candela {
namespace fs = std::filesystem;
namespace {

std::string host_name() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

std::string boot_name() {
  std::string boot;
  std::ifstream("/proc/sys/kernel/random/boot_id") >> boot;
  std::error_code failed;
  const std::string space = fs::read_symlink("/proc/self/ns/pid", failed).string();
  return boot.empty() || failed ? "" : boot + "/" + space;
}

// Empty: there is no such process, or it has ended and its exit status was not read.
std::string start_of(int process) {
  std::ifstream file(fmt::format("/proc/{}/stat", process));
  std::string line;
  std::getline(file, line);
  const size_t name_end = line.rfind(')');  // the name may hold anything
  if (name_end == std::string::npos) return "";
  std::istringstream fields(line.substr(name_end + 1));
  std::string field, start;
  constexpr int state = 3, start_time = 22;  // as proc(5) counts them
  for (int i = state; i <= start_time && fields >> field; ++i) {
    if (i == state && (field == "Z" || field == "X")) return "";
    if (i == start_time) start = field;
  }
  return start;
}

}  // namespace

ProcessIdentity this_process() { return {host_name(), boot_name(), getpid(), start_of(getpid())}; }

Life life_of(const ProcessIdentity& process) {
  const ProcessIdentity here = this_process();
  const bool known = !process.boot.empty() && !process.start.empty() && process.process > 0;
  if (!known || process.host != here.host || process.boot != here.boot) return Life::unknown;
  return start_of(process.process) == process.start ? Life::alive : Life::gone;
}

}  // namespace candela
