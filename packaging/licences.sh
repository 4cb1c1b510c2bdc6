#!/usr/bin/env bash
# Copies what Debian says of the copyright of each library that is inside the program: licences.sh FOLDER.
set -euo pipefail
mkdir -p -- "$1"
packages=(libcli11-dev libdraco-dev libfmt-dev libglm-dev libimath-dev libmeshoptimizer-dev nlohmann-json3-dev libopenexr-dev libdeflate-dev libwebp-dev libzstd-dev
  libstb-dev libstdc++6 libtbb-dev libtinygltf-dev libvulkan-dev zlib1g glslang-dev spirv-tools)
texts=(Apache-2.0 GPL-3)  # that those name instead of holding
if ! command -v dpkg-query >/dev/null; then
  printf 'licences: no dpkg here; only the names of the libraries are kept\n' >&2
  printf '%s\n' "${packages[@]}" >"$1/libraries.txt"
  exit
fi
keep() { cmp -s -- "$1" "$2" || cp -L -- "$1" "$2"; }  # FROM TO
for package in "${packages[@]}"; do
  # The folder may be a link to that of another package.
  folder=$({ dpkg-query -L "$package" 2>/dev/null || true; } | grep -m1 "/doc/$package$") || folder=
  if [[ -r $folder/copyright ]]; then
    keep "$folder/copyright" "$1/$package.txt"
  else
    printf 'licences: no copyright of %s\n' "$package" >&2
  fi
done
for text in "${texts[@]}"; do
  file=$(dpkg-query -L base-files | grep -m1 "/common-licenses/$text$") || continue
  keep "$file" "$1/$text.txt"
done
