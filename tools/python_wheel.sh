#!/bin/sh
# Makes a wheel of the built Python module.
#
#   tools/python_wheel.sh BUILT FOLDER [PYTHON]
#
# BUILT holds the built package luxel/ (build/release/python); the wheel is written into FOLDER. Without setuptools and
# wheel in PYTHON it is Debian's python3 that makes it.
set -eu
if [ $# -lt 2 ]; then
  sed -n 2,8p "$0"
  exit 2
fi
built=$(cd "$1" && pwd)
mkdir -p "$2"
folder=$(cd "$2" && pwd) python=${3:-python3}
"$python" -c 'import setuptools, wheel' 2>/dev/null || python=/usr/bin/python3
root=$(cd "$(dirname "$0")/.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$root/bindings/python"  # nothing is written here
cp -r luxel pyproject.toml setup.py "$work"
cp "$root/LICENSE" "$work"
# The notice of what is compiled in, and the texts that it names.
three=$built/../web/node_modules/three/LICENSE
[ -e "$built/../web/made_from" ] || three=
python3 "$root/tools/package/make_notices.py" python3-luxel "$work/NOTICE" ${three:+"$three"}
for text in $(grep -o '/usr/share/common-licenses/[A-Z].*[0-9]' "$work/NOTICE"); do
  cp "$text" "$work/LICENSE.${text##*/}"
done
cd "$work"
LUXEL_PYTHON=$built LUXEL_SOURCE=$root "$python" setup.py --quiet bdist_wheel --dist-dir "$folder"
ls "$folder"/luxel-*.whl
