#!/usr/bin/env bash
# Checks the tree against the rules of the design: check_tree.sh includes|text|length|names|format ROOT. Prints FILE:LINE: reason for each
# break and exits 1 when there is one.
set -euo pipefail
rule=$1
cd -- "$2"

sources() { find src shaders -type f \( -name '*.h' -o -name '*.cpp' -o -name '*.c' -o -name '*.vert' -o -name '*.frag' -o -name '*.comp' -o -name '*.glsl' -o -name '*.rgen' -o -name '*.rahit' -o -name '*.rchit' -o -name '*.rmiss' \) -print0; }

includes() {
  # A header in src/passes that declares record() is a pass; the others of a folder are what its passes share.
  local passes
  passes=$(find src/passes -name '*.h' ! -name pass.h -exec grep -lE '[^A-Za-z_]record\(' {} + 2>/dev/null | sed 's|^src/||' | tr '\n' ' ')
  sources | xargs -0 -r awk -v passes="$passes" '
    # ours: modules and single headers that a module may include, besides itself. "shared" is shaders/shared.
    BEGIN {
      ours["base"] = ""
      ours["math"] = "base"
      ours["image"] = "base math"
      ours["metrics"] = "base math image"
      ours["bvh"] = "base math"
      ours["look"] = "base"
      ours["scene"] = "base math image look"
      ours["gltf"] = "base math image look scene"
      ours["testscenes"] = "base math image look scene"
      ours["demoscenes"] = "base math image scene testscenes"
      ours["graph"] = "base"
      ours["glsl"] = "base"
      ours["gpu"] = "base math image look scene graph glsl bvh shared"
      ours["passes"] = "base math graph shared gpu/command_list.h scene/survey.h scene/draw_list.h scene/frame_data.h scene/view.h look/look.h"
      ours["techniques"] = "base math graph look passes scene/survey.h shared"
      ours["reference"] = "base math image look scene bvh"
      # Up to the plan nothing needs a device: gpu is not in these three.
      ours["job"] = "base math image metrics look scene gltf bvh graph passes techniques shared"
      ours["sky"] = ours["job"] " job"
      ours["plan"] = ours["sky"] " sky reference"
      ours["session"] = ours["plan"] " plan glsl gpu"
      ours["render"] = ours["session"] " session"
      ours["farm"] = ours["render"] " render"
      ours["bench"] = ours["render"] " render testscenes"
      ours["stability"] = ours["bench"] " bench"
      ours["report"] = ours["stability"] " stability"
      ours["cli"] = ours["report"] " report farm"
      ours["main.cpp"] = "cli"
      ours["shared"] = ""
      # Folders of src/passes, below each other: what a folder may include besides itself, of the others no pass.
      folders["shared"] = ""
      folders["lights"] = folders["shadows"] = folders["sky"] = folders["post"] = "shared"
      folders["surfaces"] = "shared lights"
      folders["occlusion"] = folders["reflections"] = folders["volumes"] = folders["debug"] = "shared surfaces"
      folders["geometry"] = folders["transparency"] = "shared shadows surfaces"
      # Libraries that stop at the modules named.
      only["OpenImageIO"] = only["OpenEXR"] = only["png.h"] = "image"
      only["vulkan"] = "graph gpu"
      only["glslang"] = only["SPIRV"] = only["spirv-tools"] = "glsl"
      only["tiny_gltf.h"] = only["meshoptimizer.h"] = only["draco"] = "gltf"
      only["stb"] = only["stb_image.h"] = only["stb_image_write.h"] = "image testscenes"
      only["CLI"] = "cli"
    }
    function in_list(list, word,   n, i, part) {
      n = split(list, part, " ")
      for (i = 1; i <= n; i++) if (part[i] == word) return 1
      return 0
    }
    function stem(path) { sub(/.*\//, "", path); sub(/\..*/, "", path); return path }
    function broken(reason) { printf "%s:%d: %s\n", FILENAME, FNR, reason; bad = 1 }
    FNR == 1 {
      split(FILENAME, folder, "/")
      glsl = folder[1] == "shaders"
      module = glsl && folder[2] != "shared" ? "shader" : folder[2]
    }
    !/^[ \t]*#[ \t]*include[ \t]*["<]/ { next }
    {
      quoted = $0 ~ /^[ \t]*#[ \t]*include[ \t]*"/
      name = $0
      sub(/^[^"<]*["<]/, "", name)
      sub(/[">].*/, "", name)
      split(name, part, "/")
      top = part[1]
      if (!quoted) {
        if (top in only && !in_list(only[top], module)) broken(module " may not include <" name ">: only " only[top] " may")
        next
      }
      if (module == "shader") {
        if (top != "shared" && top != "lib") broken("a shader may include shared/ and lib/ only, not \"" name "\"")
        next
      }
      if (name !~ /\// || name ~ /(^|\/)\.\.?\//) { broken("\"" name "\" does not say its module"); next }
      if (!(module in ours)) { broken("module " module " is not in the table of tests/arch/check_tree.sh"); next }
      if (top == module) {
        if (module != "passes" || FILENAME ~ /^src\/passes\/all_passes\./) next
        if (stem(name) != stem(FILENAME) && in_list(passes, name)) broken("passes may not include each other: \"" name "\"")
        if (!(folder[3] in folders)) broken("folder " folder[3] " of passes is not in the table of tests/arch/check_tree.sh")
        else if (part[2] != folder[3] && !in_list(folders[folder[3]], part[2])) broken("passes/" folder[3] " may not include \"" name "\"")
        next
      }
      if (!in_list(ours[module], top) && !in_list(ours[module], name)) broken(module " may not include \"" name "\"")
    }
    END { exit bad }'
}

text() {
  local unfinished='T''ODO|F''IXME|X''XX'
  { sources; find cmake .ci run CMakeLists.txt CMakePresets.json bench tests/CMakeLists.txt -type f \
      \( -name '*.cmake' -o -name '*.txt' -o -name '*.sh' -o -name run -o -name CMakePresets.json \) -print0; } |
    xargs -0 -r awk -v unfinished="(^|[^A-Za-z])($unfinished)([^A-Za-z]|$)" '
    function broken(reason) { printf "%s:%d: %s\n", FILENAME, FNR, reason; bad = 1 }
    FNR == 1 && /^#!/ { next }
    $0 ~ unfinished { broken("unfinished") }
    /(^|[ \t"=(,:])\/(home|work|root|Users|mnt|opt|tmp|var|usr)\// { broken("absolute path") }
    # XML needs the name spaces that the W3C chose.
    /https?:\/\/[A-Za-z0-9]/ && !/https?:\/\/www\.w3\.org\// { broken("URL with a host name") }
    /(deb|archive|snapshot|security)\.(debian|ubuntu)|pypi\.|pythonhosted|npmjs|crates\.io|ghcr\.io|docker\.io/ { broken("host name of a registry") }
    FILENAME ~ /^src\// && FILENAME !~ /^src\/base\/json\./ && /[Jj]son(_sax)?(<[^>]*>)?::(sax_)?(parse|accept)\(/ {
      broken("JSON is read by base/json.h alone")
    }
    END { exit bad }'
}

length_limit=500
length() {
  sources | xargs -0 -r awk -v limit="$length_limit" '
    FNR == limit + 1 { printf "%s:%d: longer than %d lines: split it by idea\n", FILENAME, FNR, limit; bad = 1 }
    END { exit bad }'
}

# A type has one definition in a namespace: two of one name in different headers are linked as if they were one.
names() {
  find src -name '*.h' -print0 2>/dev/null | sort -z | xargs -0 -r awk '
    FNR == 1 { space = "" }
    /^namespace [^{]/ { space = $2 }
    /^(struct|class|enum class|enum) [A-Za-z0-9_]+( final)?( :.*)? \{/ {
      name = $1 == "enum" && $2 == "class" ? $3 : $2
      key = space "::" name
      if (key in at && at[key] != FILENAME) { printf "%s:%d: %s is defined in %s too\n", FILENAME, FNR, key, at[key]; bad = 1 }
      at[key] = FILENAME
    }
    END { exit bad }'
}

# C++ is as clang-format of Debian 12 leaves it; no line of code or shader is wider than 120 columns.
format() {
  local bad=0 found
  found=$(find src tests bench shaders/shared -type f \( -name '*.h' -o -name '*.cpp' \) -print0 2>/dev/null |
    xargs -0 -r clang-format --dry-run -Werror 2>&1 | grep -E '^[^ ].*error:') || true
  if [[ -n $found ]]; then printf '%s\n' "$found"; bad=1; fi
  { sources; find tests bench -type f \( -name '*.h' -o -name '*.cpp' -o -name '*.comp' -o -name '*.frag' \) -print0; } |
    xargs -0 -r awk -v limit=120 'length($0) > limit && !/R"/ && !/"[^"]*$/ { printf "%s:%d: wider than %d columns\n", FILENAME, FNR, limit; bad = 1 }
      END { exit bad }' || bad=1
  return "$bad"
}

case $rule in
  includes | text | length | names | format) "$rule" ;;
  *) printf 'unknown rule: %s\n' "$rule" >&2; exit 2 ;;
esac
