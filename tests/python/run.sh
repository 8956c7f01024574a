#!/bin/sh
# Runs a test of the Python module with the Python that has what it needs.
#
#   tests/python/run.sh module LUXEL FOLDER        test_*.py, and the types
#   tests/python/run.sh notebooks LUXEL FOLDER     runs examples/python/*.ipynb
#   tests/python/run.sh wheel LUXEL FOLDER         makes a wheel, installs it in a folder, bakes with it
#
# FOLDER is the one that holds the built package, luxel/. Code 77, with the reason: something is missing.
set -eu
what=$1 LUXEL=$2 built=$3
export LUXEL
root=$(cd "$(dirname "$0")/../.." && pwd)
case $what in
  module) needs="numpy, scipy.sparse" ;;
  notebooks) needs="numpy, scipy.sparse, matplotlib, tqdm, nbconvert, ipykernel" ;;
  wheel) needs="numpy, setuptools, wheel" ;;
  *) sed -n 2,8p "$0"; exit 2 ;;
esac
python=""
for one in /usr/bin/python3 python3; do
  if command -v "$one" >/dev/null && PYTHONPATH=$built "$one" -c "import luxel, $needs" 2>/dev/null; then
    python=$one
    break
  fi
done
if [ -z "$python" ]; then
  echo "skipped: no Python that the module was built for has $needs"
  exit 77
fi
export PYTHONDONTWRITEBYTECODE=1

case $what in
  module)
    export PYTHONPATH="$built"
    "$python" -W ignore "$root/tests/python/test_bakes.py"
    "$python" -W ignore "$root/tests/python/test_light_and_rays.py"
    "$python" "$root/bindings/python/make_stub.py" --check
    ;;
  notebooks)
    export PYTHONPATH="$built" IPYTHONDIR="$built/../notebooks/ipython" MPLCONFIGDIR="$built/../notebooks/matplotlib"
    rm -rf "$built/../notebooks"
    mkdir -p "$IPYTHONDIR" "$MPLCONFIGDIR"
    # The notebooks run where they lie, with a kernel of this Python, whichever is installed for the user.
    JUPYTER_DATA_DIR="$built/../notebooks/jupyter"
    export JUPYTER_DATA_DIR
    "$python" -m ipykernel install --prefix "$built/../notebooks/kernel" >/dev/null
    JUPYTER_PATH="$built/../notebooks/kernel/share/jupyter" "$python" -m nbconvert --to html --execute \
      --output-dir "$built/../notebooks" "$root"/examples/python/*.ipynb
    ;;
  wheel)
    rm -rf "$built/../wheel_test"
    mkdir -p "$built/../wheel_test/package"
    "$root/tools/python_wheel.sh" "$built" "$built/../wheel_test" "$python"
    cd "$built/../wheel_test"
    "$python" -m zipfile -e luxel-*.whl package
    ls package/luxel/__init__.pyi package/luxel/py.typed package/luxel-*.dist-info/METADATA >/dev/null
    # The notice names what is compiled in, nothing of it is under the GPL, and the texts are there.
    notice=$(find package/luxel-*.dist-info -name NOTICE)
    for part in 'License: LGPL-3+' 'CGAL, compiled in' 'Draco, linked in'; do grep -qF "$part" "$notice"; done
    if grep -E '^License:.*\bGPL' "$notice"; then exit 1; fi
    ls "${notice%NOTICE}LICENSE.LGPL-3" "${notice%NOTICE}LICENSE.GPL-3" >/dev/null
    PYTHONPATH=$PWD/package "$python" -c "
import luxel
assert luxel.__file__.startswith('$PWD/package'), luxel.__file__
scene = luxel.load('$root/scenes/cornell-box.glb')
print(luxel.bake(scene, resolution=16, samples=4), luxel.__version__)"
    ;;
esac
