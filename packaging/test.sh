#!/usr/bin/env bash
# test.sh PACKAGES SCENE: installs candela's packages in clean systems and renders with them. Needs root and debootstrap; about
# 5 minutes, nearly all of it downloads.
#   Debian 12:           the .deb through apt with the packages that it names, and lavapipe of backports
#   a newer Debian:      the archive, unpacked in a folder, with a Vulkan driver of that system and nothing else
set -euo pipefail
packages=$(readlink -f -- "$1") scene=$(readlink -f -- "$2") sources=$(dirname -- "$(dirname -- "$(readlink -f -- "$0")")")
[[ $(id -u) -eq 0 ]] || { printf 'test: chroot needs root\n' >&2; exit 2; }
command -v debootstrap >/dev/null || { printf 'test: install debootstrap\n' >&2; exit 2; }
deb=$(find "$packages" -maxdepth 1 -name 'candela_*.deb') archive=$(find "$packages" -maxdepth 1 -name 'candela-*.tar.xz')
[[ -f $deb && -f $archive ]] || { printf 'test: one .deb and one .tar.xz are wanted in %s\n' "$packages" >&2; exit 2; }
mirror=$({ sed -nE 's/^(URIs: *|deb (\[[^]]*\] *)?)([^ ]*\/debian)\/?( .*)?$/\3/p' /etc/apt/sources.list /etc/apt/sources.list.d/* 2>/dev/null || true; } | head -n 1)
[[ -n $mirror ]] || { printf 'test: no mirror of Debian under /etc/apt\n' >&2; exit 2; }

work=$(mktemp -d)
clean() { for root in "$work"/*/; do umount "$root/proc" 2>/dev/null || true; done; rm -rf --one-file-system -- "$work"; }
trap clean EXIT
failures=0
broken() { printf 'FAILED: %s\n' "$*" >&2; failures=$((failures + 1)); }
say() { printf 'package test: %s\n' "$*" >&2; }

system() {  # ROOT SUITE
  say "a clean $2"
  debootstrap --variant=minbase "$2" "$1" "$mirror" >"$work/log" 2>&1 || { tail -n 20 "$work/log" >&2; exit 1; }
  mount -t proc proc "$1/proc" 2>/dev/null || true
}
inside() { local root=$1; shift; chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive "$@"; }
install() { local root=$1; shift; inside "$root" apt-get -q install -y --no-install-recommends "$@" >"$work/log" 2>&1 || { tail -n 20 "$work/log" >&2; exit 1; }; }

renders() {  # ROOT PROGRAM
  local root=$1 program=$2 said
  cp "$scene" "$root/root/scene.glb"
  inside "$root" "$program" --version --json >"$root/root/version.json" || broken "$program --version"
  said=$(inside "$root" "$program" render /root/scene.glb --size 160x90 -o /root/a.exr -o /root/a.png 2>&1) || broken "render: $said"
  inside "$root" "$program" reference /root/scene.glb --spp 2 --size 32x18 -o /root/r.exr >/dev/null 2>&1 || broken "reference"
  inside "$root" "$program" compare /root/a.png /root/a.png --limit differing=0 >/dev/null 2>&1 || broken "compare"
  [[ -s $root/root/a.exr && -s $root/root/a.png ]] || broken "no pictures"
  # Shaders that are built in need no compiler; edited ones do.
  grep -A1 candela_glslang.so "$root/root/version.json" | grep -q '"opens": true' || broken "candela_glslang.so does not open"
  rm -rf -- "$root/root/shaders"
  cp -r -- "$sources/shaders" "$root/root/shaders"
  printf '// edited\n' >>"$root/root/shaders/tonemap.comp"
  said=$(inside "$root" "$program" render /root/scene.glb --size 160x90 --shader-dir /root/shaders -o /root/b.png 2>&1) || broken "edited shaders: $said"
  inside "$root" "$program" compare /root/a.png /root/b.png --limit differing=0 >/dev/null 2>&1 || broken "a comment changes the picture"
}

system "$work/bookworm" bookworm
printf 'deb %s bookworm-backports main\n' "$mirror" >"$work/bookworm/etc/apt/sources.list.d/backports.list"
inside "$work/bookworm" apt-get -q update >/dev/null 2>&1
cp "$deb" "$work/bookworm/root/candela.deb"
say "installing the .deb"
install "$work/bookworm" -t bookworm-backports mesa-vulkan-drivers
install "$work/bookworm" /root/candela.deb
renders "$work/bookworm" candela
# Without OpenImageIO, which is only suggested, other formats are refused in words.
printf 'BM a picture of another format, long enough to be looked at' >"$work/bookworm/root/a.bmp"
said=$(inside "$work/bookworm" candela compare /root/a.bmp /root/a.bmp 2>&1) && broken "a BMP is read without OpenImageIO" || true
[[ $said == *candela_oiio.so* ]] || broken "the message does not name the module: $said"
install "$work/bookworm" -t bookworm-backports libopenimageio2.4  # its libelf goes with that of the mesa above
inside "$work/bookworm" candela --version --json | grep -A1 candela_oiio.so | grep -q '"opens": true' || broken "candela_oiio.so does not open"
inside "$work/bookworm" dpkg -r candela >/dev/null 2>&1 || broken "dpkg -r"
[[ ! -e $work/bookworm/usr/bin/candela && ! -e $work/bookworm/usr/lib/candela ]] || broken "files are left after dpkg -r"

newer=trixie
system "$work/$newer" "$newer"
say "unpacking the archive"
install "$work/$newer" libvulkan1 mesa-vulkan-drivers
mkdir -p "$work/$newer/opt/any where"
tar -xf "$archive" -C "$work/$newer/opt/any where"
folder=$(cd "$work/$newer" && echo opt/any\ where/candela-*)
renders "$work/$newer" "/$folder/bin/candela"
inside "$work/$newer" "/$folder/bin/candela" --version --json | grep -A1 candela_draco.so | grep -q '"opens": true' || broken "candela_draco.so of the archive does not open"
needed=$(readelf -d "$work/$newer/$folder/bin/candela" "$work/$newer/$folder"/lib/candela/*.so | sed -nE 's/.*NEEDED.*\[(.*)\]/\1/p' | sort -u | tr '\n' ' ')
[[ $needed == "ld-linux-x86-64.so.2 libc.so.6 libm.so.6 libvulkan.so.1 " ]] || broken "the archive needs more than the C library and the Vulkan loader: $needed"
glibc=$(objdump -T "$work/$newer/$folder/bin/candela" | grep -oE 'GLIBC_[0-9.]+' | sort -uV | tail -n 1)
[[ $(printf '%s\n' GLIBC_2.36 "$glibc" | sort -V | tail -n 1) == GLIBC_2.36 ]] || broken "the archive needs $glibc"
[[ $(stat -c %s "$archive") -lt 20000000 ]] || broken "the archive is larger than 20 MB"

[[ $failures -eq 0 ]] || exit 1
say "the .deb and the archive install, render and go ($(stat -c %s "$deb") and $(stat -c %s "$archive") bytes)"
