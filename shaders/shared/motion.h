#ifndef CANDELA_SHARED_MOTION_H
#define CANDELA_SHARED_MOTION_H
#include "shared/scene.h"
SHARED_BEGIN
// Where things were at the time before, in that time's relative space; the transforms of FrameConstants::transforms
// follow, in their order.
struct Motion {
  mat4 clip_from_relative;
};
SHARED_END
#ifndef __cplusplus
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer MotionRef {
  Motion motion;
  Transform t[];
};
#endif
#endif
