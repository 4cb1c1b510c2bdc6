#pragma once
#include <string>

namespace candela {

// Names a process among all that ever ran: numbers of processes come again, so the boot and the start belong to it.
struct ProcessIdentity {
  std::string host;
  std::string boot;  // the boot and the space in which process numbers count; empty: unknown
  int process = 0;
  std::string start;  // in the kernel's ticks since the boot; empty: unknown
};
ProcessIdentity this_process();

enum class Life { alive, gone, unknown };  // unknown: of another host or boot, or with parts that are not known
Life life_of(const ProcessIdentity& process);

}  // namespace candela
