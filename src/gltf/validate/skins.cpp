#include "gltf/validate/internal.h"

namespace candela::validation {
namespace {

// The root above each node; the parents form trees here.
std::vector<int64_t> find_roots(const std::vector<int64_t>& parents) {
  std::vector<int64_t> roots(parents.size(), -1), walk;
  for (size_t i = 0; i < parents.size(); ++i) {
    int64_t at = int64_t(i);
    walk.clear();
    while (roots[at] < 0 && parents[at] >= 0) {
      walk.push_back(at);
      at = parents[at];
    }
    if (roots[at] < 0) roots[at] = at;
    for (const int64_t node : walk) roots[node] = roots[at];
  }
  return roots;
}

bool is_ancestor(const std::vector<int64_t>& parents, int64_t ancestor, int64_t node, size_t& steps) {
  constexpr size_t most_steps = 1 << 20;  // the check is only for a warning; it must not cost more than loading
  for (; node >= 0 && steps < most_steps; node = parents[node], ++steps)
    if (node == ancestor) return true;
  return steps >= most_steps;
}

void check_inverse_binds(Document& d, const Json& skin, const std::string& path) {
  const AccessorLayout* a = d.accessor(skin, "inverseBindMatrices", path);
  if (!a) return;
  const std::string at = path + "/inverseBindMatrices";
  const size_t joints = elements(skin, "joints").size();
  if (a->type != "MAT4" || a->component_type != component_float)
    d.findings.fatal("SKIN_IBM_INVALID_FORMAT", at, "invalid accessor format {}, must be {{MAT4, FLOAT}}", a->format());
  if (a->view_has_stride)
    d.findings.warning("SKIN_IBM_ACCESSOR_WITH_BYTESTRIDE", at,
                       "byteStride must not be defined for inverse bind matrices");
  if (a->count < joints)
    d.findings.fatal("INVALID_IBM_ACCESSOR_COUNT", at, "{} matrices for {} joints", a->count, joints);
  d.use_view(*a, ViewUse::other, at);
}

void check_joints(Document& d, const Json& skin, const std::string& path, const std::vector<int64_t>& roots) {
  const Json& joints = elements(skin, "joints");
  bool resolved = true;
  for (size_t k = 0; k < joints.size(); ++k) {
    if (uint64_t(whole(joints[k])) < roots.size()) continue;
    resolved = false;
    d.findings.fatal("UNRESOLVED_REFERENCE", fmt::format("{}/joints/{}", path, k),
                     "unresolved reference: {} (there are {} nodes)", whole(joints[k]), roots.size());
  }
  const int64_t skeleton = d.reference(skin, "skeleton", "nodes", path);
  if (!resolved) return;
  for (const Json& joint : joints)
    if (roots[whole(joint)] != roots[whole(joints[0])]) {
      d.findings.warning("SKIN_NO_COMMON_ROOT", path + "/joints", "the joints do not have a common root");
      break;
    }
  size_t steps = 0;
  for (const Json& joint : joints)
    if (skeleton >= 0 && !is_ancestor(d.parents, skeleton, whole(joint), steps)) {
      d.findings.warning("SKIN_SKELETON_INVALID", path + "/skeleton",
                         "the skeleton node is not above every joint, ignored");
      break;
    }
}

// Joints outside the scene that is drawn still have transforms; the Khronos asset generator holds such a file to be
// valid.
void check_joints_in_scene(Document& d, const std::vector<int64_t>& roots) {
  const Json& scenes = elements(d.json, "scenes");
  if (scenes.empty()) return;
  std::vector<bool> drawn(roots.size(), false);
  for (const Json& node : elements(scenes[integer(d.json, "scene", 0)], "nodes")) drawn[whole(node)] = true;
  const Json& nodes = elements(d.json, "nodes");
  std::vector<int> state(d.count("skins"), 0);  // 1: every joint is drawn, 2: some are not
  for (size_t i = 0; i < nodes.size(); ++i) {
    const int64_t skin = integer(nodes[i], "skin", -1);
    if (skin < 0 || !nodes[i].contains("mesh") || !drawn[roots[i]]) continue;
    if (state[skin] == 0) {
      state[skin] = 1;
      for (const Json& joint : elements(elements(d.json, "skins")[skin], "joints"))
        if (!drawn[roots[whole(joint)]]) state[skin] = 2;
    }
    if (state[skin] == 2)
      d.findings.warning("NODE_SKIN_NO_SCENE", fmt::format("/nodes/{}", i),
                         "the skin's joints are not in the scene that holds the node; they are placed as if they were");
  }
}

}  // namespace

void check_skins(Document& d) {
  const std::vector<int64_t> roots = find_roots(d.parents);
  for (size_t i = 0; i < d.count("skins"); ++i) {
    const std::string path = fmt::format("/skins/{}", i);
    check_inverse_binds(d, elements(d.json, "skins")[i], path);
    check_joints(d, elements(d.json, "skins")[i], path, roots);
  }
  if (!d.findings.any_fatal()) check_joints_in_scene(d, roots);
}

}  // namespace candela::validation
