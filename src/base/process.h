#pragma once
#include <functional>
#include <string>

namespace candela {

// To be called before anything else of the program.
// Standard streams that came closed are opened on /dev/null, the wrong way around (0 for writing, 1 and 2 for reading):
// the next file opened would otherwise get their number and log lines would land in it, while using them stays an
// error. A limit of file sizes (ulimit -f) becomes an error of write() instead of a signal that ends the program; where
// it takes the memory of a CPU driver, the program ends with a line and the exit code of the output. Where the address
// space is limited (ulimit -v), a crash of a driver that was given too little of it ends in a line and exit 6. False:
// there is no /dev/null to open.
bool prepare_process();
// Runs it on a stack of 8 MiB where the process has less than 1 MiB (ulimit -s), and gives as much to threads that are
// started later; else as it is.
int on_a_large_stack(const std::function<int()>& work);

// What the system gives no more of: "memory" (addresses, about as many as a driver with its compiler maps) or "threads"
// (about as many as a driver, TBB and OpenEXR start). Empty: there is enough of both. To be asked before a driver is
// opened: where it gets too little it crashes or waits for ever.
std::string what_runs_out();

}  // namespace candela
