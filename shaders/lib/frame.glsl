// The frame's constants, as `frame`. A block of uniforms: llvmpipe loads it once for all lanes, where it gathers
// storage buffers lane by lane, and GPUs keep it in a cache of its own.
#include "shared/scene.h"
layout(set = 1, binding = 2, scalar) uniform FrameBlock { FrameConstants frame; };
