#!/usr/bin/env bash
# Fetches a lavapipe that knows ray queries, for tests: Mesa 24.1 or newer, from the backports of the
# Debian release that runs. Nothing is installed. Leaves FOLDER/lavapipe.json, which tests find by
# VK_ICD_FILENAMES. Where it cannot be had, says why, and ends with success all the same.
#
#   tools/newer_lavapipe.sh FOLDER
set -uo pipefail

folder=$1
driver=usr/lib/$(uname -m)-linux-gnu/libvulkan_lvp.so
[[ -f $folder/lavapipe.json ]] && exit 0
mkdir -p "$folder/lists/partial" "$folder/cache/archives/partial"
folder=$(cd "$folder" && pwd)

give_up() {
  echo "newer_lavapipe: $1; rays by ray queries are not tested"
  exit 0
}

. /etc/os-release
[[ ${ID:-} == debian ]] || give_up "this is not Debian"
release=${VERSION_CODENAME:-}
# The mirror that this machine uses.
mirror=$(apt-get indextargets --format '$(RELEASE) $(REPO_URI)' 2>/dev/null |
  awk -v release="$release" '$1 == release { print $2; exit }')
[[ -n $mirror ]] || give_up "apt knows no mirror of Debian"
echo "deb $mirror $release-backports main" >"$folder/sources.list"
apt_get() {
  apt-get -q -o Dir::Etc::SourceList="$folder/sources.list" -o Dir::Etc::SourceParts=- \
    -o Dir::State::Lists="$folder/lists" -o Dir::Cache="$folder/cache" "$@" >"$folder/log.txt" 2>&1
}
apt_get update || give_up "the mirror cannot be reached ($folder/log.txt)"
(cd "$folder" && apt_get download "mesa-vulkan-drivers/$release-backports") ||
  give_up "$release-backports has no newer Mesa ($folder/log.txt)"
dpkg-deb -x "$folder"/mesa-vulkan-drivers_*.deb "$folder/root" || give_up "the package is broken"
rm -f "$folder"/*.deb
if ! libraries=$(ldd "$folder/root/$driver" 2>&1) || grep -q 'not found' <<<"$libraries"; then
  give_up "a library that lavapipe needs is not there: $(grep 'not found' <<<"$libraries" | head -n 1)"
fi
printf '{"file_format_version": "1.0.0", "ICD": {"api_version": "1.3.0", "library_path": "%s"}}\n' \
  "$folder/root/$driver" >"$folder/lavapipe.json"
