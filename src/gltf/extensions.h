#pragma once
#include "gltf/gltf.h"
#include "gltf/document.h"

namespace candela::gltf {
// One line for each extension that the file uses, with what uses it. Refuses the file when it requires one that is
// ignored.
std::vector<ExtensionUse> survey_extensions(Document& document, LoadFor use);
}  // namespace candela::gltf
