# Sourced by demo.sh and test.sh: the one list of packages, and how they are installed and the project is built.
# shellcheck shell=bash

packages=(
  cmake ninja-build g++ ccache glslang-tools
  libvulkan-dev libvulkan-volk-dev nlohmann-json3-dev libfmt-dev libspdlog-dev libcli11-dev
  libtinygltf-dev libstb-dev libopenexr-dev libglm-dev libgtest-dev libgmock-dev libvalijson-dev
  mesa-vulkan-drivers vulkan-validationlayers libxml2-utils
)

# What the command compiles shaders with while it runs, and what the viewer's page is built with, where Node comes from
# nowhere else; what tells hosts how to be compiled; and what decodes compressed models. Without them these are left out.
optional_packages=(glslang-dev pkg-config libmeshoptimizer-dev libdraco-dev)
command -v node >/dev/null || optional_packages+=(nodejs)
command -v npm >/dev/null || optional_packages+=(npm)

# What the fuzz targets need beside them.
fuzz_packages=(clang libclang-rt-14-dev)

# A third-party renderer that an example embeds Dermis in; without it that test is skipped.
# shellcheck disable=SC2034
interface_packages=(libplacebo-dev)

# What the full tests build the library for Windows with.
# shellcheck disable=SC2034
windows_packages=(g++-mingw-w64-x86-64-posix)

# What the full tests count covered code with; without it that is skipped.
# shellcheck disable=SC2034
coverage_packages=(gcovr)

say() { printf '%s\n' "$*"; }
fail() { # exit code, message
  printf '%s: %s\n' "$(basename "$0")" "$2" >&2
  exit "$1"
}

# Those of the given packages that are not installed, one a line.
missing_packages() {
  local package
  for package in "$@"; do
    [[ "$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)" == installed ]] || say "$package"
  done
}

# Is this a user who may install packages, with or without sudo?
may_install() { [[ $EUID -eq 0 ]] || { command -v sudo >/dev/null && sudo -n true 2>/dev/null; }; }

# Can the fuzz targets be built here, once install_packages was given their packages?
can_fuzz() {
  if command -v dpkg-query >/dev/null; then
    [[ -z "$(missing_packages "${fuzz_packages[@]}")" ]] || may_install
  else
    command -v clang++ >/dev/null
  fi
}

# Installs `packages`; then `optional_packages` where this user may and where they are to be had.
install_packages() {
  if ! command -v dpkg-query >/dev/null; then
    say "This is no Debian: taking it that what these packages hold is installed: ${packages[*]}"
    return
  fi
  local missing wanted=() become=()
  mapfile -t missing < <(missing_packages "${packages[@]}")
  if may_install; then
    mapfile -t wanted < <(missing_packages "${optional_packages[@]}")
    [[ $EUID -eq 0 ]] || become=(sudo)
  elif [[ ${#missing[@]} -gt 0 ]]; then
    fail 3 "missing packages; as root: apt-get install --no-install-recommends ${missing[*]}"
  fi
  [[ $((${#missing[@]} + ${#wanted[@]})) -gt 0 ]] || return 0
  local apt=("${become[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq)
  local failed=no
  "${apt[@]}" update || failed=yes
  if [[ ${#missing[@]} -gt 0 ]]; then
    [[ $failed == no ]] || fail 3 "apt-get update failed: is there a network?"
    say "Installing ${#missing[@]} packages: ${missing[*]}"
    "${apt[@]}" install -y --no-install-recommends "${missing[@]}" >/dev/null ||
      fail 3 "apt-get install failed for: ${missing[*]}"
  fi
  local package
  for package in "${wanted[@]}"; do
    say "Installing $package"
    if [[ $failed == yes ]] || ! "${apt[@]}" install -y --no-install-recommends "$package" >/dev/null; then
      say "It cannot be installed: what needs it is left out."
    fi
  done
}

# Configures and builds one preset; further arguments go to the build.
build_preset() {
  local preset=$1
  shift
  say "Building $preset ..."
  cmake --preset "$preset" --log-level=WARNING >/dev/null || fail 1 "configuring the preset '$preset' failed"
  cmake --build --preset "$preset" -j "$(nproc)" "$@" || fail 1 "building the preset '$preset' failed"
}
