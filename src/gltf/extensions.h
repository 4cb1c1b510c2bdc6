#pragma once
#include "gltf/document.h"
#include "gltf/gltf.h"

namespace candela::gltf {
// One line for each extension that the file uses, with what uses it. Refuses the file when it requires one that is
// ignored.
std::vector<ExtensionUse> survey_extensions(Document& document, LoadFor use);
}  // namespace candela::gltf
