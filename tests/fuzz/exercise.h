#pragma once
#include <cstddef>
#include <span>

namespace candela::fuzz {
// Reads the bytes and gives whether it could. Every outcome but a return is a failure: a crash, a hang, memory without
// bound. Each program has one of these: exercise_gltf.cpp takes them as a glTF file and poses what comes out, at times
// before, among and past the keys; exercise_image.cpp takes them as an image.
bool exercise(std::span<const std::byte> bytes);
}  // namespace candela::fuzz
