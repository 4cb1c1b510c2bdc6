#!/usr/bin/env bash
# Builds the libraries that Debian has only as shared ones, statically, from the source packages of the versions that are
# installed, so that their headers fit: static_libraries.sh FOLDER. Leaves FOLDER/lib/lib*.a and FOLDER/licences/NAME. A later call
# with the same versions does nothing. Sources come through apt from the mirrors that this machine uses; no root is needed.
set -euo pipefail

mkdir -p -- "$1"
out=$(readlink -f -- "$1")

packages=(libopenexr-dev libimath-dev libtbb-dev libmeshoptimizer-dev libfmt-dev libtinygltf-dev)
versions=$(dpkg-query -W -f='${source:Package} ${source:Version}\n' "${packages[@]}")
if [[ -f $out/versions ]] && [[ $(<"$out/versions") == "$versions" ]]; then exit 0; fi
say() { printf 'static libraries: %s\n' "$*" >&2; }

# --- sources --------------------------------------------------------------------------------------------------------

# apt with lists and sources of its own: the machine's entries for Debian, as source entries.
fetch() {
  local apt=$out/apt file name
  rm -rf -- "$apt"
  mkdir -p "$apt/lists/partial" "$apt/cache/archives/partial" "$apt/sources"
  for file in /etc/apt/sources.list /etc/apt/sources.list.d/*.list /etc/apt/sources.list.d/*.sources; do
    [[ -r $file ]] || continue
    name=$apt/sources/$(basename -- "$file")
    case $file in
      *.sources) grep -qE '^URIs:.*/debian' "$file" && sed 's/^Types:.*/Types: deb-src/' "$file" >"$name" || true ;;
      *) [[ $(basename -- "$file") == *.list ]] || name+=.list
         sed -nE '/\/debian/ s/^deb[ \t]/deb-src /p' "$file" >"$name" ;;
    esac
  done
  cat >"$apt/apt.conf" <<TEXT
Dir::Etc::sourcelist "/dev/null";
Dir::Etc::sourceparts "$apt/sources";
Dir::State::lists "$apt/lists";
Dir::Cache "$apt/cache";
APT::Sandbox::User "$(id -un)";
TEXT
  export APT_CONFIG=$apt/apt.conf
  say "fetching sources"
  apt-get -q -o Acquire::Retries=5 update >&2
  local source version
  rm -rf -- "$out/source"
  mkdir -p "$out/source"
  cd -- "$out/source"
  while read -r source version; do
    [[ $source == tinygltf ]] || apt-get -q -o Acquire::Retries=5 source "$source=$version" >&2
  done <<<"$versions"
  cd -- "$out"
  unset APT_CONFIG
}

# --- building -------------------------------------------------------------------------------------------------------

# Without warnings: those of other people's sources would hide ours. What was printed is shown where a build fails.
build() {  # SOURCE OPTION...
  local source=$1 folder log=$out/build/$1.log
  shift
  folder=$(find "$out/source" -mindepth 1 -maxdepth 1 -type d -name "$source-*")
  say "building $source"
  mkdir -p "$out/build"
  {
    cmake -S "$folder" -B "$out/build/$source" -G Ninja -DCMAKE_BUILD_TYPE=Release -Wno-dev -DCMAKE_WARN_DEPRECATED=OFF \
      -DCMAKE_CXX_FLAGS_RELEASE="-O2 -DNDEBUG -w" -DCMAKE_C_FLAGS_RELEASE="-O2 -DNDEBUG -w" \
      -DCMAKE_CXX_STANDARD=17 -DBUILD_SHARED_LIBS=OFF -DCMAKE_POSITION_INDEPENDENT_CODE=ON -DBUILD_TESTING=OFF \
      -DCMAKE_INSTALL_PREFIX="$out" -DCMAKE_INSTALL_LIBDIR=lib -DCMAKE_PREFIX_PATH="$out" \
      -DCMAKE_CXX_COMPILER_LAUNCHER="$(command -v ccache || true)" "$@" &&
      cmake --build "$out/build/$source" --target install -- -j "${CANDELA_JOBS:-$(nproc)}"
  } >"$log" 2>&1 || { cat -- "$log" >&2; exit 1; }
}

fetch
rm -rf -- "$out/build" "$out/lib" "$out/include" "$out/licences"
build imath
build openexr -DOPENEXR_BUILD_TOOLS=OFF -DOPENEXR_INSTALL_EXAMPLES=OFF -DOPENEXR_INSTALL_TOOLS=OFF
build onetbb -DTBB_TEST=OFF -DTBBMALLOC_BUILD=OFF -DTBB_STRICT=OFF
build meshoptimizer
build fmtlib -DFMT_TEST=OFF -DFMT_DOC=OFF

# One header and no build of its own; Debian's library is built the same way.
say "building tinygltf"
mkdir -p "$out/build/tinygltf"
printf '%s\n' '#define TINYGLTF_IMPLEMENTATION' '#include <tiny_gltf.h>' >"$out/build/tinygltf/tinygltf.cpp"
g++ -std=c++17 -O2 -DNDEBUG -w -fPIC -I"$(dirname -- "$(dpkg-query -L libstb-dev | grep -m1 "/stb_image.h$")")" -c "$out/build/tinygltf/tinygltf.cpp" \
  -o "$out/build/tinygltf/tinygltf.o"
ar rcs "$out/lib/libtinygltf.a" "$out/build/tinygltf/tinygltf.o"

rm -rf -- "$out/build" "$out/source" "$out/apt" "$out/include"
printf '%s\n' "$versions" >"$out/versions"
