#pragma once
#include "graph/handle.h"

namespace candela {

// Which lights are drawn as volumes: of each list of shared/light_volumes.h a draw command, and its lights. Not a pass.
struct LightVolumes {
  BufferHandle draws, lists;
};

}  // namespace candela
