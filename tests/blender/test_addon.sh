#!/bin/sh
# Builds the Blender add-on's zip, installs it in a Blender of its own and bakes with it.
#
#   tests/blender/test_addon.sh LUXEL FOLDER
#
# Code 77, with the reason: Blender is not there.
set -eu
luxel=$1 folder="$2/blender addon test"  # a name with blanks, as users have
here=$(cd "$(dirname "$0")" && pwd)
if ! command -v blender >/dev/null; then
  echo "skipped: Blender is not installed (apt-get install blender)"
  exit 77
fi
rm -rf "$folder"
mkdir -p "$folder/config" "$folder/scripts"
"$here/../../tools/blender_addon.sh" "$folder/luxel-blender.zip"
# Nothing of the user's own Blender is read or changed.
BLENDER_USER_CONFIG=$folder/config BLENDER_USER_SCRIPTS=$folder/scripts HOME=$folder XDG_CONFIG_HOME=$folder/config \
  blender -b --factory-startup --python-exit-code 1 --python "$here/bake_in_blender.py" -- \
  "$folder/luxel-blender.zip" "$luxel" "$folder" >"$folder/log" 2>&1 || { tail -40 "$folder/log"; exit 1; }
grep -E ' holds$|FLIP|passed' "$folder/log"
