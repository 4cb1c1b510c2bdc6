#!/usr/bin/env bash
# test_container.sh PACKAGES SCENE: builds the image of the Containerfile with the Debian package in PACKAGES and renders a
# scene in it. Exit 77, with the reason, where that cannot be tried. The base is debian:bookworm-slim where a registry
# has it, else a minimal Debian 12 by debootstrap (root). Minutes, nearly all of them downloads.
set -euo pipefail
packages=$1 scene=$2 sources=$(dirname -- "$(dirname -- "$(readlink -f -- "$0")")")
skip() { printf 'test package_container: skipped: %s\n' "$*" >&2; exit 77; }
say() { printf 'container: %s\n' "$*" >&2; }

shopt -s nullglob
debs=("$packages"/candela_*.deb)
[[ ${#debs[@]} -eq 1 ]] || skip "no package in $packages (./run package)"
if command -v podman >/dev/null; then builder=podman
elif command -v buildah >/dev/null; then builder=buildah
elif command -v docker >/dev/null && docker info >/dev/null 2>&1; then builder=docker
else skip "no podman, buildah, or docker with a daemon"; fi

work=$(mktemp -d)
tag=candela-test-$$ base=candela-test-base-$$
container=
clean() {
  local code=$?
  case $builder in
    buildah) [[ -z $container ]] || buildah rm "$container"; buildah rmi "$tag"; buildah rmi "$base" ;;
    *) "$builder" rmi "$tag"; "$builder" rmi "$base" ;;
  esac >/dev/null 2>&1 || true
  rm -rf --one-file-system -- "$work"
  exit "$code"
}
trap clean EXIT

# chroot isolation needs no namespaces, and vfs no overlays: both work inside containers too.
case $builder in
  buildah) export BUILDAH_ISOLATION=chroot STORAGE_DRIVER=${STORAGE_DRIVER:-vfs}
    build=(buildah build) pull=(buildah pull) ;;
  *) build=("$builder" build) pull=("$builder" pull) ;;
esac
if ! "${pull[@]}" debian:bookworm-slim >"$work/log" 2>&1; then
  [[ $(id -u) -eq 0 ]] && command -v debootstrap >/dev/null ||
    skip "debian:bookworm-slim cannot be pulled, and there is no debootstrap (as root) to make a base"
  mirror=$({ sed -nE 's/^(URIs: *|deb (\[[^]]*\] *)?)([^ ]*\/debian)\/?( .*)?$/\3/p' /etc/apt/sources.list \
    /etc/apt/sources.list.d/* 2>/dev/null || true; } | head -n 1)
  [[ -n $mirror ]] || skip "debian:bookworm-slim cannot be pulled, and no mirror of Debian is under /etc/apt"
  say "a minimal Debian 12 as the base"
  debootstrap --variant=minbase bookworm "$work/root" "$mirror" >"$work/log" 2>&1 || { tail -n 20 "$work/log" >&2; exit 1; }
  if [[ -d /usr/local/share/ca-certificates ]]; then cp -r /usr/local/share/ca-certificates "$work/root/usr/local/share/"; fi
  tar -C "$work/root" --one-file-system -cf "$work/root.tar" .
  rm -rf --one-file-system -- "$work/root"
  mkdir "$work/base"
  mv "$work/root.tar" "$work/base/"
  printf 'FROM scratch\nADD root.tar /\n' >"$work/base/Containerfile"
  "${build[@]}" -t "$base" -f "$work/base/Containerfile" "$work/base" >"$work/log" 2>&1 || { tail -n 20 "$work/log" >&2; exit 1; }
  set -- --build-arg "BASE=$([[ $builder == docker ]] || printf localhost/)$base"
else
  set --
fi

say "building the image with $builder"
mkdir "$work/context" "$work/files"
cp -- "${debs[0]}" "$work/context/"
"${build[@]}" "$@" -t "$tag" -f "$sources/packaging/Containerfile" "$work/context" >"$work/log" 2>&1 ||
  { tail -n 30 "$work/log" >&2; exit 1; }
cp -- "$scene" "$work/files/scene.glb"
words=(render /work/scene.glb --size 160x90 --device cpu -o /work/frame.png)
case $builder in
  buildah)
    container=$(buildah from "localhost/$tag")
    buildah run -v "$work/files:/work" "$container" -- candela "${words[@]}" ;;
  *) "$builder" run --rm -v "$work/files:/work" "$tag" "${words[@]}" ;;
esac
[[ -s $work/files/frame.png ]] || { say "FAILED: no picture"; exit 1; }
say "the image builds and renders ($builder)"
