# Sourced by demo.sh and test.sh: lists the packages, installs them and builds the project.
# shellcheck shell=bash

packages=(
  cmake ninja-build g++ ccache glslang-tools
  libvulkan-dev libvulkan-volk-dev nlohmann-json3-dev libfmt-dev libspdlog-dev libcli11-dev
  libtinygltf-dev libstb-dev libopenexr-dev libglm-dev libgtest-dev libgmock-dev libvalijson-dev
  mesa-vulkan-drivers vulkan-validationlayers libxml2-utils
)

# Packages for run-time shader compilation, pkg-config files, compressed models, and for building
# the viewer's page if no other Node is installed. Features whose package is missing are left out.
optional_packages=(glslang-dev pkg-config libmeshoptimizer-dev libdraco-dev)
command -v node >/dev/null || optional_packages+=(nodejs)
command -v npm >/dev/null || optional_packages+=(npm)

# Additional packages of the fuzz targets.
fuzz_packages=(clang libclang-rt-14-dev)

# A third-party renderer in which an example embeds Dermis. Without the package its test is skipped.
# shellcheck disable=SC2034
interface_packages=(libplacebo-dev)

# Cross compiler with which the full tests build the library for Windows.
# shellcheck disable=SC2034
windows_packages=(g++-mingw-w64-x86-64-posix)

# Coverage tool of the full tests. Without the package coverage is skipped.
# shellcheck disable=SC2034
coverage_packages=(gcovr)

say() { printf '%s\n' "$*"; }
fail() { # exit code, message
  printf '%s: %s\n' "$(basename "$0")" "$2" >&2
  exit "$1"
}

# Prints the given packages that are not installed, one per line.
missing_packages() {
  local package status
  for package in "$@"; do
    status=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
    [[ $status == installed ]] || say "$package"
  done
}

# Succeeds if this user may install packages, with or without sudo.
may_install() { [[ $EUID -eq 0 ]] || { command -v sudo >/dev/null && sudo -n true 2>/dev/null; }; }

# Succeeds if the fuzz targets can be built here.
can_fuzz() {
  if command -v dpkg-query >/dev/null; then
    [[ -z "$(missing_packages "${fuzz_packages[@]}")" ]]
  else
    command -v clang++ >/dev/null
  fi
}

# Installs `packages`, then those of `optional_packages` that are available, if this user may.
install_packages() {
  if ! command -v dpkg-query >/dev/null; then
    say "This is not Debian; assuming that the contents of these packages are installed:" \
      "${packages[*]}"
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
    if [[ $failed == yes ]] ||
      ! "${apt[@]}" install -y --no-install-recommends "$package" >/dev/null; then
      say "$package cannot be installed; features that need it are left out."
    fi
  done
}

# Configures and builds one preset. Further arguments are passed to the build.
build_preset() {
  local preset=$1
  shift
  say "Building $preset ..."
  cmake --preset "$preset" --log-level=WARNING >/dev/null ||
    fail 1 "configuring the preset '$preset' failed"
  cmake --build --preset "$preset" -j "$(nproc)" "$@" ||
    fail 1 "building the preset '$preset' failed"
}
