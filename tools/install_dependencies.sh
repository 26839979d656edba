#!/usr/bin/env bash
# Installs the Debian packages that Rigel is built with, those that are missing, and those that are named. Asks nothing.
#
#   tools/install_dependencies.sh [PACKAGE ...]
set -euo pipefail

if [[ ${1-} == -h || ${1-} == --help ]]; then
  echo "usage: install_dependencies.sh [PACKAGE ...]"
  exit 0
fi
packages=(
  cmake g++ ninja-build
  libceres-dev libeigen3-dev libgoogle-glog-dev libgflags-dev nlohmann-json3-dev zlib1g-dev
  libopencv-features2d-dev libopencv-imgcodecs-dev libopencv-calib3d-dev libyaml-cpp-dev
  libgtest-dev libgmock-dev libbenchmark-dev
  parallel python3-matplotlib
  "$@"
)

say() { echo "install_dependencies: $*" >&2; }
fail() {
  say "$*"
  exit 1
}

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  say "not a Debian system; taking these to be installed: ${packages[*]}"
  exit 0
fi

missing=()
for package in "${packages[@]}"; do
  status=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
  [[ $status == installed ]] || missing+=("$package")
done
[[ ${#missing[@]} -gt 0 ]] || exit 0

as_root=()
if [[ $(id -u) -ne 0 ]]; then
  command -v sudo >/dev/null ||
    fail "missing, and neither root nor sudo to install them: ${missing[*]}"
  as_root=(sudo)
fi

apt() {
  ${as_root[@]+"${as_root[@]}"} env DEBIAN_FRONTEND=noninteractive \
    apt-get -q -o DPkg::Lock::Timeout=300 "$@" </dev/null >&2
}

say "installing ${missing[*]}"
apt update || say "apt-get update failed; trying with the package lists that are there"
apt install --yes --no-install-recommends "${missing[@]}" ||
  fail "apt-get could not install: ${missing[*]}"
