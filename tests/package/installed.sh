#!/usr/bin/env bash
# installed.sh BUILD SOURCE: cmake --install, the installation moved elsewhere and run there; then the Debian package, unpacked.
set -euo pipefail
build=$1 source=$2
. "$source/tests/package/check.sh"

# Runs where the program lies: its modules open, and a picture comes out.
runs() {  # PREFIX
  local program=$1/bin/candela said module
  said=$("$program" --version --json) || { broken "$1: --version --json"; return; }
  for module in candela_glslang candela_oiio candela_draco candela_demoscenes; do
    [[ -f $build/$module.so ]] || continue
    [[ -f $1/lib/candela/$module.so ]] || broken "$1: no $module.so"
    grep -A1 "\"$module.so\"" <<<"$said" | grep -q '"opens": true' || broken "$1: $module.so does not open: $said"
  done
  "$program" make-scene unlit-box -o "$work/box.glb" --seed 1 2>/dev/null || broken "$1: make-scene"
  "$program" facts "$work/box.glb" >/dev/null || broken "$1: facts"
  # Nothing is loaded for formats that the scene does not have, at the start or later.
  said=$(LD_DEBUG=files "$program" facts "$work/box.glb" 2>&1 >/dev/null | grep -oE 'file=[^ ]*(webp|zstd|OpenImageIO|draco|glslang|demoscenes)[^ ]*' | sort -u) || true
  [[ -z $said ]] || broken "$1: a plain scene loads $said"
}

holds() {  # PREFIX FILE...
  local prefix=$1 file
  shift
  for file; do [[ -s $prefix/$file ]] || broken "$prefix: no $file"; done
}
everywhere=(bin/candela share/man/man1/candela.1 share/man/man1/candela-render.1 share/bash-completion/completions/candela
  share/fish/vendor_completions.d/candela.fish share/candela/schemas/look.schema.json share/candela/ci/{action,gitlab}.yml share/doc/candela/README.md
  share/doc/candela/LICENSE share/doc/candela/copyright share/doc/candela/docs/using/look.md)
if command -v dpkg-query >/dev/null; then
  everywhere+=(share/doc/candela/licences/{libopenexr-dev,libwebp-dev,libzstd-dev,libtbb-dev,nlohmann-json3-dev,libcli11-dev,glslang-dev,libstdc++6,Apache-2.0}.txt)
fi

cmake --install "$build" --prefix "$work/first" >/dev/null
mv "$work/first" "$work/moved, with a blank"
holds "$work/moved, with a blank" "${everywhere[@]}" share/zsh/site-functions/_candela
runs "$work/moved, with a blank"
# Links to the program are followed.
mkdir -p "$work/links/bin" && ln -s "$work/moved, with a blank/bin/candela" "$work/links/bin/candela"
"$work/links/bin/candela" --version --json | grep -A1 candela_draco.so | grep -q '"opens": true' || broken "modules are not found through a link"
# Without its modules it says so, and goes on. Its own shaders are built in; an edited one needs candela_glslang.so.
mkdir -p "$work/alone/bin" "$work/edited" && cp "$work/moved, with a blank/bin/candela" "$work/alone/bin/"
alone() { CANDELA_CACHE_DIR=$work/cache "$work/alone/bin/candela" render "$work/box.glb" --size 32x18 -o "$work/box.png" "$@"; }
alone 2>"$work/said" || broken "without modules it does not render: $(<"$work/said")"
{ cat "$source/shaders/tonemap.comp"; echo "// edited"; } >"$work/edited/tonemap.comp"
code=0
said=$(alone --shader-dir "$work/edited" 2>&1) || code=$?
[[ $code -eq 3 && $said == *"tonemap.comp"*"candela_glslang.so"*"leave --shader-dir out"* ]] || broken "an edited shader without the module: exit $code, $said"
if [[ -f $build/candela_oiio.so ]]; then
  "$work/alone/bin/candela" --version --json | grep -A2 candela_oiio.so | grep -q 'no candela_oiio.so beside' || broken "a missing module is not named"
  printf 'BM a picture of another format, long enough to be looked at' >"$work/a.bmp"
  code=0
  said=$("$work/alone/bin/candela" compare "$work/a.bmp" "$work/a.bmp" 2>&1) || code=$?
  [[ $code -eq 3 && $said == *"candela_oiio.so"*"Convert the picture"* ]] || broken "a picture that needs the module: exit $code, $said"
fi

if command -v dpkg-shlibdeps >/dev/null; then
  (cd "$work" && cpack --config "$build/CPackConfig.cmake" -G DEB -B "$work/packages" -D CPACK_DEBIAN_COMPRESSION_TYPE=none >"$work/cpack.log") ||
    broken "cpack: $(<"$work/cpack.log")"
  deb=$(find "$work/packages" -maxdepth 1 -name '*.deb')
  dpkg-deb -x "$deb" "$work/root"
  holds "$work/root/usr" "${everywhere[@]}" share/zsh/vendor-completions/_candela
  runs "$work/root/usr"
  depends=$(dpkg-deb -f "$deb" Depends) suggests=$(dpkg-deb -f "$deb" Suggests)
  for library in libc6 libstdc++6 libvulkan1 libopenexr libtinygltf libtbb; do
    [[ ", $depends" == *", $library"* ]] || broken "the package does not depend on $library: $depends"
  done
  [[ $depends != *openimageio* ]] || broken "the package needs OpenImageIO, which brings 258 libraries"
  [[ ! -f $build/candela_oiio.so || $suggests == *libopenimageio* ]] || broken "OpenImageIO is not suggested: $suggests"
  dpkg --validate-version "$(dpkg-deb -f "$deb" Version)" || broken "version"
fi
finish
