#!/usr/bin/env bash
# Plants one break at a time in a small tree and expects check_tree.sh to name it; the tree without a break passes.
set -euo pipefail
here=$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")
tree=$(mktemp -d)
trap 'rm -rf -- "$tree"' EXIT
failures=0

fresh() {
  rm -rf -- "${tree:?}"/*
  mkdir -p "$tree"/{src/{base,math,scene,graph,gpu,passes/{shared,post,sky},techniques,reference,job,sky,plan,session,render,cli},shaders/{shared,lib},cmake,.ci,bench,tests}
  cp "$here/../../.clang-format" "$tree/"
  touch "$tree"/{run,CMakeLists.txt,CMakePresets.json,tests/CMakeLists.txt}
  printf '#include "base/error.h"\n\n#include <fmt/format.h>\n' >"$tree/src/base/error.cpp"
  printf 'struct Tone {\n  static void record(int commands);\n};\n' >"$tree/src/passes/post/tone.h"
  printf 'struct Shared {};\n' >"$tree/src/passes/post/shared_part.h"
  printf '#include "passes/post/tone.h"\n\n#include "gpu/command_list.h"\n#include "graph/plan.h"\n#include "passes/post/shared_part.h"\n#include "passes/shared/pass.h"\n' >"$tree/src/passes/post/tone.cpp"
  printf '#include <CLI/CLI.hpp>\n' >"$tree/src/cli/cli.cpp"
  printf '#include "render/job.h"\n' >"$tree/src/cli/render.cpp"
  printf '#include "shared/types.h"\n#include "lib/brdf.glsl"\n' >"$tree/shaders/tone.frag"
}

expect() {  # RULE FILE TEXT REASON
  fresh
  for rule in includes text length names format; do
    if ! "$here/check_tree.sh" "$rule" "$tree" >/dev/null; then printf 'the clean tree breaks %s\n' "$rule"; failures=1; fi
  done
  printf '%b\n' "$3" >"$tree/$2"
  local said
  if said=$("$here/check_tree.sh" "$1" "$tree"); then
    printf 'not found: %s with %s\n' "$2" "$3"
    failures=1
  elif [[ $said != "$2":*"$4"* ]]; then
    printf 'wrong reason for %s: %s\n' "$2" "$said"
    failures=1
  fi
}

expect includes src/base/a.cpp '#include "scene/scene.h"' 'base may not include'
expect includes src/scene/a.h '#include "gpu/device.h"' 'scene may not include'
expect includes src/scene/a.cpp '#include <vulkan/vulkan.h>' 'only graph gpu may'
expect includes src/graph/a.cpp '  #  include "passes/post/tone.h"' 'graph may not include'
expect includes src/gpu/a.cpp '#include "job/job.h"' 'gpu may not include'
expect includes src/passes/post/blur.cpp '#include "passes/post/tone.h"' 'passes may not include each other'
expect includes src/passes/post/blur.cpp '#include "gpu/device.h"' 'passes may not include'
expect includes src/passes/shared/a.h '#include "passes/post/shared_part.h"' 'passes/shared may not include'
expect includes src/passes/sky/a.h '#include "passes/post/shared_part.h"' 'passes/sky may not include'
expect includes src/techniques/a.cpp '#include "gpu/command_list.h"' 'techniques may not include'
expect includes src/reference/a.cpp '#include "lib/brdf.glsl"' 'reference may not include'
expect includes src/job/a.cpp '#include "plan/plan_frame.h"' 'job may not include'
expect includes src/sky/a.cpp '#include "gpu/resources.h"' 'sky may not include'
expect includes src/plan/a.h '#include "gpu/acceleration.h"' 'plan may not include'
expect includes src/plan/a.cpp '#include "session/session.h"' 'plan may not include'
expect includes src/session/a.cpp '#include "render/outputs.h"' 'session may not include'
expect includes src/render/a.cpp '#include "cli/cli.h"' 'render may not include'
expect includes src/render/a.cpp '#include <CLI/CLI.hpp>' 'only cli may'
expect includes src/render/a.cpp '#include "../cli/cli.h"' 'does not say its module'
expect includes src/render/a.cpp '#include "job.h"' 'does not say its module'
expect includes shaders/a.comp '#include "base/error.h"' 'a shader may include'
expect includes shaders/shared/a.h '#include "base/error.h"' 'shared may not include'
expect text src/base/a.cpp 'int a;  // TO''DO: more' 'unfinished'
expect text cmake/a.cmake 'set(a /wo''rk/b)' 'absolute path'
expect text run 'curl https://deb.deb''ian.org' 'host name'
expect text src/scene/a.cpp 'auto j = nlohmann::json::parse(text);' 'base/json.h alone'
expect length src/base/a.cpp "$(printf '\\n%.0s' {1..501})" 'longer than'
expect names src/passes/post/zone.h 'struct Tone {\n};' 'is defined in'
expect format src/base/a.cpp 'int  a;' 'code should be clang-formatted'
expect format shaders/a.comp "$(printf 'x%.0s' {1..121})" 'wider than'
exit "$failures"
