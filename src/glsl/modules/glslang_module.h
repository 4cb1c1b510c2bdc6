#pragma once
#include <stddef.h>
#include <stdint.h>

// The C interface of candela_glslang.so, which compiles GLSL to SPIR-V. It is opened at first need: by a shader that is
// neither built into the program nor in the cache.
extern "C" {

struct CandelaGlslText {
  const char* name;  // zero-terminated; below the shader folder
  const char* text;
  size_t size;
};

enum CandelaGlslStage : uint32_t {
  candela_glsl_vertex,
  candela_glsl_fragment,
  candela_glsl_compute,
  candela_glsl_raygen,
  candela_glsl_any_hit,
  candela_glsl_closest_hit,
  candela_glsl_miss
};

// Results go to the caller, whose functions do not throw.
struct CandelaGlslRequest {
  CandelaGlslStage stage;
  const char* definitions;  // preprocessor lines before the first of the root
  CandelaGlslText root;
  void* user;
  // What `include` means inside the file `includer`; false where there is nothing. Valid until the call returns.
  bool (*include)(void* user, const char* include, const char* includer, CandelaGlslText* out);
  void (*done)(void* user, const uint32_t* words, size_t count);
  void (*failed)(void* user, const char* log);  // the compiler's messages
};

typedef void CandelaGlslCompile(const CandelaGlslRequest* request);
typedef const char* CandelaGlslIdentity();  // equals glsl/compiler_identity.h of the program that it belongs to
}
