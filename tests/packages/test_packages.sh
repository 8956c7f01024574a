#!/bin/bash
# Builds the .deb files, has lintian look at them, installs them into a clean folder and uses what is there.
#
#   tests/packages/test_packages.sh BUILD
#
# BUILD is a build folder. Code 77, with the reason: a tool is missing. Programs that are installed run in a
# sandbox where neither luxel's source nor BUILD exists, if bubblewrap works on this machine.
set -euo pipefail
build=$(cd "$1" && pwd)
source=$(cd "$(dirname "$0")/../.." && pwd)
for tool in lintian dpkg-deb dpkg-shlibdeps man bwrap desktop-file-validate xmllint update-mime-database; do
  if ! command -v $tool >/dev/null; then
    echo "skipped: $tool is not installed (tools/setup.sh tests)"
    exit 77
  fi
done
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
root=$folder/root packages=$build/packages

fail() {
  echo "packages: $*" >&2
  exit 1
}

# alone COMMAND...: where only the installed files and the libraries of the system are.
alone() {
  bwrap --ro-bind / / --dev /dev --proc /proc --tmpfs /tmp --bind "$folder" "$folder" --tmpfs "$source" \
    --tmpfs "$build" --chdir "$folder/work" --setenv HOME "$folder/work" --unshare-net "$@"
}
if ! bwrap --ro-bind / / --dev /dev --proc /proc --unshare-net true 2>/dev/null; then
  echo "bubblewrap does not work here: installed programs run where they can see luxel's source"
  alone() { (cd "$folder/work" && "$@"); }
fi

build_packages() {
  cmake --build "$build" --target packages >"$folder/log" 2>&1 || { tail -40 "$folder/log"; fail "no packages"; }
  wanted="libluxel-dev luxel luxel-view"
  if compgen -G "$build/python/luxel/_luxel.*.so" >/dev/null; then wanted+=" python3-luxel"; fi
  got=$(cd "$packages" && for file in *.deb; do dpkg-deb -f "$file" Package; done | sort | tr '\n' ' ')
  [[ $got == "$wanted " ]] || fail "the packages are $got, not $wanted"
  ls "$packages"/luxel_*_"$(dpkg --print-architecture)".deb >/dev/null
}

# dpkg itself where it may, its unpacking elsewhere: dependencies are those of the system around.
install_packages() {
  mkdir -p "$root/var/lib/dpkg/"{info,updates,triggers} "$folder/work"
  touch "$root/var/lib/dpkg/status"
  if [[ $(id -u) -eq 0 ]]; then
    dpkg "${to_root[@]}" --install "$packages"/*.deb >"$folder/log" 2>&1 || { cat "$folder/log"; fail "dpkg"; }
  else
    for file in "$packages"/*.deb; do dpkg-deb -x "$file" "$root"; done
  fi
}
to_root=(--root="$root" --force-depends --force-script-chrootless --log=/dev/null)

check_files() {
  if grep -rlF -e "$source" -e "$build" "$root/usr"; then fail "these files name the folder of the source"; fi
  for file in usr/bin/luxel usr/bin/luxel-view usr/lib/luxel/view/libluxel_view_ui.so; do
    if readelf -SW "$root/$file" | grep -q '\.symtab'; then fail "$file is not stripped"; fi
  done
  [[ $(dpkg-deb -f "$packages"/luxel_*.deb Depends) == *libembree3* ]] || fail "luxel does not ask for Embree"
  [[ $(dpkg-deb -f "$packages"/luxel-view_*.deb Depends) == *libvulkan1* ]] || fail "luxel-view does not ask for Vulkan"
  # Every package of luxelConfig.cmake is one that libluxel-dev asks for: installed, because luxel was built.
  for package in $(dpkg-deb -f "$packages"/libluxel-dev_*.deb Depends | tr -d ,); do
    dpkg-query -W "$package" >/dev/null || fail "libluxel-dev asks for $package, which luxel was built without"
  done
  for notice in "$root"/usr/share/doc/*/copyright; do
    for licence in 'License: LGPL-3+' 'CGAL, compiled in' 'Draco, linked in'; do
      grep -qF "$licence" "$notice" || fail "$notice says nothing of $licence"
    done
    if grep -E '^License:.*\bGPL' "$notice"; then fail "$notice names the GPL"; fi
  done
}

check_programs() {
  cp "$source/scenes/furnace-box.glb" "$folder/work"
  alone "$root/usr/bin/luxel" bake furnace-box.glb -o baked --resolution 32 --samples 16 --quiet
  [[ -s $folder/work/baked/lightmap.exr && -s $folder/work/baked/preview.png ]] || fail "the bake left no files"
  alone "$root/usr/bin/luxel" relight furnace-box.glb -o box.lxr --target none --patches 100 --rays 64 --quiet
  alone "$root/usr/bin/luxel-view" --version
}

check_python() {
  [[ -d $root/usr/lib/python3 ]] || return 0
  if ! /usr/bin/python3 -c 'import numpy' 2>/dev/null; then
    echo "the Python module was not imported: python3-numpy is not installed"
    return 0
  fi
  alone env PYTHONPATH="$root/usr/lib/python3/dist-packages" PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 -c "
import luxel
assert luxel.__file__.startswith('$root'), luxel.__file__
print(luxel.bake('furnace-box.glb', resolution=16, samples=4), luxel.__version__)"
}

# The smaller one of examples/library, which looks for neither Assimp nor tinygltf.
check_library() {
  cp -r "$source/examples/library/relight" "$folder/work/relight"
  alone sh -c "cmake -G Ninja -S relight -B relight/build -DCMAKE_PREFIX_PATH='$root/usr' && cmake --build relight/build" \
    >"$folder/log" 2>&1 || { cat "$folder/log"; fail "the example of libluxel-dev does not build"; }
  alone relight/build/relight box.lxr 3 >/dev/null
}

check_pages() {
  for page in "$root"/usr/share/man/man1/*.gz; do
    said=$(MANWIDTH=80 LC_ALL=C.UTF-8 man --warnings -E UTF-8 -l -Tutf8 -Z "$page" 2>&1 >/dev/null)
    [[ -z $said ]] || fail "man says of $page: $said"
  done
  MANWIDTH=80 man -l "$root/usr/share/man/man1/luxel-bake.1.gz" | grep -q -e '--samples' || fail "no --samples in luxel-bake(1)"
  [[ -e $root/usr/share/man/man1/luxel-view.1.gz ]] || fail "luxel-view has no man page"
}

# completed WORD...: what bash offers for the last word.
completed() {
  bash -c 'source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _luxel; echo "${COMPREPLY[*]}"' bash \
    "$root/usr/share/bash-completion/completions/luxel" "$@"
}
check_completions() {
  [[ $(completed luxel bake --uv "") == "auto keep unwrap" ]] || fail "bash completes --uv by $(completed luxel bake --uv "")"
  [[ $(completed luxel rel) == relight ]] || fail "bash completes rel by $(completed luxel rel)"
  for shell in zsh fish; do
    command -v $shell >/dev/null || { echo "$shell is not installed, and did not read its completions"; continue; }
    find "$root/usr/share/$shell" -type f -exec $shell -n {} \; || fail "$shell cannot read its completions"
  done
}

check_desktop() {
  desktop-file-validate "$root/usr/share/applications/luxel-view.desktop"
  xmllint --noout "$root/usr/share/mime/packages/luxel.xml" "$root/usr/share/icons/hicolor/scalable/apps/luxel-view.svg"
  # The bytes that the database looks for are those of a file that luxel wrote.
  update-mime-database "$root/usr/share/mime" 2>/dev/null
  magic=$(head -c 8 "$folder/work/box.lxr" | od -An -tx1)
  grep -aq 'application/x-luxel-relight' "$root/usr/share/mime/magic" || fail "the database has no .lxr files"
  [[ $(od -An -v -tx1 "$root/usr/share/mime/magic" | tr -d '\n') == *"$magic"* ]] || fail "an .lxr file begins by$magic"
}

check_removing() {
  [[ $(id -u) -eq 0 ]] || return 0
  find "$root/usr/share/mime" -maxdepth 1 -type f -delete  # update-mime-database made them, above
  rm -rf "$root/usr/share/mime/application"
  dpkg "${to_root[@]}" --purge libluxel-dev luxel luxel-view python3-luxel >"$folder/log" 2>&1 || fail "purging"
  left=$(find "$root" -path "$root/var" -prune -o -type f -print)
  [[ -z $left ]] || fail "purging leaves $left"
}

build_packages
lintian --allow-root --fail-on error,warning "$packages"/*.deb
install_packages
check_files
check_programs
check_python
check_library
check_pages
check_completions
check_desktop
check_removing
echo "packages: $got are right"
