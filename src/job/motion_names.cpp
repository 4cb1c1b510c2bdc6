#include "job/motion_names.h"

namespace candela {

Expected<void> rename_motion_files(Job& job, const std::function<Expected<std::string>(const std::string&)>& rename) {
  std::vector<std::string*> names;
  for (PathRequest& path : job.paths) names.push_back(&path.points), names.push_back(&path.times);
  for (InstancesRequest& instances : job.instances) names.push_back(&instances.file);
  for (std::string* name : names) {
    if (name->empty()) continue;
    auto renamed = rename(*name);
    if (!renamed) return std::unexpected(renamed.error());
    *name = std::move(*renamed);
  }
  return {};
}

}  // namespace candela
