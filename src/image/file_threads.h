#pragma once

namespace candela {

// Whether a file that is encoded or decoded has threads beside the one that asks for it. Bytes do not depend on it.
bool file_threads();

}  // namespace candela
