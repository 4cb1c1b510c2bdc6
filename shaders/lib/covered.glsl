#pragma once
// llvmpipe 25.0.7 shades what no sample sees: of several samples it keeps the depth test's answers, but does not leave
// a group of pixels that has none. A GPU never begins one.
#extension GL_KHR_shader_subgroup_vote : require
bool is_any_covered() { return subgroupAny(!gl_HelperInvocation); }
