#!/usr/bin/env bash
# Installs the Debian packages that luxel is built from, if any is missing.
# Needs no network and no rights when all are there.
#
#   tools/setup.sh          what luxel is built from
#   tools/setup.sh tests    and what only tests use
#   tools/setup.sh docs     and what only the API pages need
#   tools/setup.sh fuzz     and what only the fuzzers need
#   tools/setup.sh package  and what only `make package` needs
#
# luxel builds without node, npm and chromium, with less (docs/format/bake.md, view.html): where they
# cannot be installed, that is said and no error.
set -euo pipefail

packages=(
  g++ cmake ninja-build make pkg-config python3 clang-format
  libembree-dev libtbb-dev           # rays, threads
  libopenexr-dev libstb-dev          # images
  libtinygltf-dev nlohmann-json3-dev # glTF, JSON
  libdraco-dev libmeshoptimizer-dev  # compressed glTF
  libjpeg-dev libwebp-dev            # JPEG and WebP textures
  libtinyobjloader-dev               # OBJ
  libpugixml-dev                     # Collada
  libassimp-dev                      # FBX, Collada, ...
  libeigen3-dev                      # least squares
  libcgal-dev                        # exact predicates
  zlib1g-dev                         # checksums, PNG
  libvulkan-dev libvulkan-volk-dev glslang-tools # graphics devices
  libglfw3-dev libimgui-dev libfreetype-dev      # the window and its panels
  libcli11-dev libtomlplusplus-dev   # the command line, luxel.toml
  libfmt-dev
  pybind11-dev python3-dev python3-numpy python3-setuptools python3-wheel # the Python module
  libgtest-dev libgmock-dev          # tests
)

missing=()
for package in "${packages[@]}"; do
  # "install ok installed" only: a package that was removed leaves a status too.
  status=$(dpkg-query -W -f='${Status}' "$package" 2>/dev/null || true)
  [[ $status == "install ok installed" ]] || missing+=("$package")
done
# Commands, because they may have come another way than as packages.
wanted=()
for tool in node:nodejs npm:npm; do
  command -v "${tool%%:*}" >/dev/null || wanted+=("${tool##*:}")
done
# A driver for the window, on the processor where there is no graphics card.
compgen -G '/usr/share/vulkan/icd.d/*.json' >/dev/null || wanted+=(mesa-vulkan-drivers)
if [[ ${1:-} == package || ${1:-} == tests ]]; then
  command -v dpkg-shlibdeps >/dev/null || wanted+=(dpkg-dev)
  command -v file >/dev/null || wanted+=(file)
fi
if [[ ${1:-} == fuzz || ${1:-} == tests ]]; then
  command -v clang++ >/dev/null || wanted+=(clang)
  command -v llvm-symbolizer >/dev/null || wanted+=(llvm) # lines in what the sanitizers say
  [[ -n $(find /usr/lib -name 'libclang_rt.fuzzer-*' -print -quit 2>/dev/null) ]] || wanted+=(libclang-rt-dev)
fi
if [[ ${1:-} == tests ]]; then
  command -v chromium >/dev/null || wanted+=(chromium)
  command -v patch >/dev/null || wanted+=(patch)
  command -v bwrap >/dev/null || wanted+=(bubblewrap)
  command -v Xvfb >/dev/null || wanted+=(xvfb)
  command -v blender >/dev/null || wanted+=(blender)
  # Who looks at the packages, and at what is in them.
  for tool in lintian:lintian man:man-db desktop-file-validate:desktop-file-utils xmllint:libxml2-utils \
    update-mime-database:shared-mime-info zsh:zsh fish:fish; do
    command -v "${tool%%:*}" >/dev/null || wanted+=("${tool##*:}")
  done
  # What the Python module's tests and notebooks use besides numpy.
  for module in scipy matplotlib tqdm nbconvert ipykernel; do
    /usr/bin/python3 -c "import $module" 2>/dev/null || wanted+=("python3-$module")
  done
  # Bakes on clusters, which luxel has where it is built with them.
  command -v mpirun >/dev/null || wanted+=(openmpi-bin)
  command -v mpicc >/dev/null || wanted+=(libopenmpi-dev)
  # The layer that checks how a graphics device is used.
  compgen -G '/usr/share/vulkan/explicit_layer.d/*validation*.json' >/dev/null ||
    wanted+=(vulkan-validationlayers)
fi
if [[ ${1:-} == docs ]]; then
  command -v doxygen >/dev/null || wanted+=(doxygen)
fi
if [[ ${#missing[@]} -eq 0 && ${#wanted[@]} -eq 0 ]]; then
  exit 0
fi

as_root=(env)
[[ $(id -u) -eq 0 ]] || as_root=(sudo env)
for tool in apt-get $([[ $(id -u) -eq 0 ]] || echo sudo); do
  if ! command -v "$tool" >/dev/null; then
    echo "setup: packages are missing, and there is no $tool to install them: ${missing[*]} ${wanted[*]}" >&2
    # luxel builds without the wanted ones.
    [[ ${#missing[@]} -eq 0 ]]
    exit
  fi
done

# Through env, because sudo drops the variable.
install() {
  echo "setup: installing $*"
  "${as_root[@]}" apt-get update -q &&
    "${as_root[@]}" DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "$@"
}
if [[ ${#missing[@]} -gt 0 ]] && ! install "${missing[@]}"; then
  echo "setup: luxel needs these packages, and they could not be installed: ${missing[*]}" >&2
  exit 1
fi
if [[ ${#wanted[@]} -gt 0 ]] && ! install "${wanted[@]}"; then
  echo "setup: going on without ${wanted[*]}" >&2
fi
