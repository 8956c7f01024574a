#!/bin/sh
# Puts baked.glb of several bakes before the Khronos validator: no errors and no warnings.
#
#   tests/gltf/validate_bakes.sh LUXEL FOLDER
#
# Code 77, with the reason: node, npm or the network is missing.
set -eu
luxel=$1 folder=$2/gltf_validator
root=$(cd "$(dirname "$0")/../.." && pwd)
if ! command -v node >/dev/null || ! command -v npm >/dev/null; then
  echo "skipped: node and npm are not installed (Debian packages nodejs and npm)"
  exit 77
fi
mkdir -p "$folder"
cp "$root/tools/package.json" "$root/tools/validate_gltf.mjs" "$folder"
if [ ! -d "$folder/node_modules/gltf-validator" ] &&
  ! (cd "$folder" && npm install --ignore-scripts --no-audit --no-fund --prefer-offline --fetch-retries=1 \
    --fetch-timeout=30000 >npm.log 2>&1); then
  echo "skipped: npm could not fetch the validator, is there a network? ($folder/npm.log)"
  exit 77
fi

bake() {
  name=$1 scene=$2
  shift 2
  "$luxel" bake "$root/scenes/$scene" -o "$folder/$name" --quiet --resolution 128 "$@"
}
few="--samples 4"
coarse="--solver hemicube --hemicube 16 --max-elements 1500"
# Unquoted: several words.
bake lightmap cornell-box.glb $few
bake combined foliage.glb $few --attach combined
bake emissive cornell-box.glb $few --attach emissive
bake vertices cornell-box.glb $coarse --vertex-colors
bake triangles spheres-and-cube.glb $coarse --vertex-colors --elements triangle
bake layers ies/wall.gltf $few --layers per-light
bake normal-map bumps.glb $few --directional sh1
bake pages tiled-kit.glb $few --pages 2
node "$folder/validate_gltf.mjs" "$folder"/*/baked.glb

# The check itself can fail: the room of vertices, its colours twice as bright.
python3 - "$folder/vertices/baked.glb" "$folder/too-bright.glb" <<'END'
import json, struct, sys
data = bytearray(open(sys.argv[1], "rb").read())
length = struct.unpack_from("<I", data, 12)[0]
document = json.loads(data[20:20 + length])
colors = document["accessors"][document["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"]]
at = 28 + length + document["bufferViews"][colors["bufferView"]]["byteOffset"]
struct.pack_into("<f", data, at, 2.0)
open(sys.argv[2], "wb").write(data)
END
if node "$folder/validate_gltf.mjs" "$folder/too-bright.glb" >"$folder/too-bright.log"; then
  echo "a colour of 2 is not found"
  exit 1
fi
