#ifndef CANDELA_SHARED_CULL_H
#define CANDELA_SHARED_CULL_H
#include "shared/types.h"

SHARED_BEGIN

// One workgroup's share of a draw run: up to cull_group_size consecutive items of one run.
struct CullGroup {
  uint first_item, item_count;
  uint run;          // whose count this group adds to
  uint first_group;  // of the run: the groups from here to before this one give the offset
  uint is_last;      // of its run: writes the run's draw count
};
// As VkDrawIndexedIndirectCommand.
struct DrawCommand {
  uint index_count, instance_count, first_index;
  int vertex_offset;
  uint first_instance;
};
struct CullPush {
  uint64_t groups, survivors, commands, counts;
  uint culling;  // 0: everything is kept
  uint group_count;
};

SHARED_END

#ifdef __cplusplus
namespace candela::shared {
inline constexpr uint cull_group_size = 256;
// Groups beyond what one dimension of a dispatch takes on every device (65535) go to the second.
inline uvec2 cull_threads(uint groups) {
  const uint row = groups < 65535 ? groups : 65535;
  return {row * cull_group_size, (groups + 65534) / 65535};
}
static_assert(sizeof(CullGroup) == 20 && sizeof(DrawCommand) == 20 && sizeof(CullPush) == 40);
}  // namespace candela::shared
#else
const uint cull_group_size = 256u;
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer CullGroupsRef { CullGroup g[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer DrawCommandsRef { DrawCommand d[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer CountsRef { uint n[]; };
#endif

#endif
