# Shared by tests/run and pipelines/quickstart: packages and build. Sourced, with the project's root as folder.

packages_build=(build-essential cmake ninja-build libeigen3-dev libnlopt-dev libnlopt-cxx-dev libhdf5-dev libgsl-dev
                libcli11-dev libtomlplusplus-dev libfmt-dev nlohmann-json3-dev libpugixml-dev zlib1g-dev
                libsuitesparse-dev libmetis-dev libopenblas-dev)
packages_test=(libgtest-dev libgmock-dev python3 python3-numpy python3-scipy python3-h5py python3-xarray python3-h5netcdf)

# need_packages GROUP...: installs the missing packages of these groups, or says which to ask for.
need_packages() {
  local missing=() group name
  for group in "$@"; do
    local -n list="packages_$group"
    for name in "${list[@]}"; do
      dpkg-query -W -f='${Status}' "$name" 2>/dev/null | grep -q 'install ok installed' || missing+=("$name")
    done
  done
  [ ${#missing[@]} -eq 0 ] && return 0
  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    if command -v sudo >/dev/null && sudo -n true 2>/dev/null; then
      as_root=(sudo)
    else
      echo "These Debian packages are missing; ask whoever administers this machine to install them:" >&2
      echo "  apt-get install ${missing[*]}" >&2
      exit 2
    fi
  fi
  echo "Installing: ${missing[*]}"
  "${as_root[@]}" apt-get update -qq
  DEBIAN_FRONTEND=noninteractive "${as_root[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
}

# build PRESET [CMAKE ARGUMENT...]
build() {
  local preset=$1
  shift
  cmake --preset "$preset" "$@" >/dev/null
  cmake --build --preset "$preset"
}
