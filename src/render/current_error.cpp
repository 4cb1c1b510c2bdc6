#include "render/current_error.h"

#include <new>
#include <system_error>

#include "base/process.h"
#include "gpu/device.h"

namespace candela {

Error current_error() {
  try {
    throw;
  } catch (const gpu::GpuError& e) {
    return {e.out_of_memory() ? ErrorKind::out_of_memory : ErrorKind::device, e.what(), ""};
  } catch (const std::bad_alloc&) {
    return {ErrorKind::out_of_memory, "out of memory; a smaller --size or fewer --layers need less", ""};
  } catch (const std::filesystem::filesystem_error& e) {
    return {ErrorKind::input, e.what(), ""};
  } catch (const std::system_error& e) {
    if (e.code() == std::errc::resource_unavailable_try_again)
      return {ErrorKind::out_of_memory,
              "the system gives no more threads; raise the limit of processes (ulimit -u, the container's)", ""};
    return {ErrorKind::device, e.what(), ""};
  } catch (const std::exception& e) {  // TBB and others name refused threads in words alone
    const std::string missing = what_runs_out();
    if (missing.empty()) return {ErrorKind::device, fmt::format("unexpected: {}", e.what()), ""};
    return {ErrorKind::out_of_memory, fmt::format("the system gives no more {}: {}", missing, e.what()), ""};
  } catch (...) {
    return {ErrorKind::device, "unexpected: an exception of an unknown type", ""};
  }
}

}  // namespace candela
