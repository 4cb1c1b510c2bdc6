// A group's segment of the lights' chunks (passes/lights/light_assign.h): whole blocks, whose hits are a word of each
// thread. Needs the push constant dispatch.
const uint light_block_chunks = 32u;

void segment_chunks(out uint first, out uint last) {
  const uint chunks = LightDispatchRef(pc.dispatch).d.chunks;
  const uint blocks = (chunks + light_block_chunks - 1u) / light_block_chunks;
  const uint each = (blocks + light_segments - 1u) / light_segments * light_block_chunks;
  first = gl_WorkGroupID.x * each;
  last = min(first + each, chunks);
}
