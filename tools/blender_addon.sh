#!/bin/sh
# Makes the zip of the Blender add-on, which Blender installs: Edit > Preferences > Add-ons > Install.
#
#   tools/blender_addon.sh FILE.zip
set -eu
case ${1:-} in *.zip) ;; *) echo "usage: tools/blender_addon.sh FILE.zip" >&2; exit 2 ;; esac
folder=$(cd "$(dirname "$1")" && pwd)
cd "$(dirname "$0")/../addons/blender"
rm -f "$folder/${1##*/}"
python3 - "$folder/${1##*/}" <<'END'
import pathlib, sys, zipfile
with zipfile.ZipFile(sys.argv[1], "w", zipfile.ZIP_DEFLATED) as out:
    for file in sorted(pathlib.Path("luxel_bake").glob("*.py")):
        out.write(file)
END
