#!/usr/bin/env bash
# The shared libraries that programs load, by Debian package, with the licences that the package's copyright file names:
#
#   tools/list_licences.sh build/release/bin/rigel_estimate [PROGRAM ...]
#
# A copyright file covers the whole source package, its build scripts and tests too: a licence in the list is to be
# looked up there, in /usr/share/doc/PACKAGE/copyright, before it is taken to bind the library.
set -euo pipefail

if [[ ${1-} == -h || ${1-} == --help ]]; then
  echo "usage: list_licences.sh PROGRAM ..."
  exit 0
fi
if [[ $# -eq 0 ]]; then
  echo "usage: list_licences.sh PROGRAM ..." >&2
  exit 2
fi

for program in "$@"; do
  [[ -x $program ]] || { echo "list_licences: $program: not a program" >&2; exit 1; }
  ldd "$program" | awk '$3 ~ /^\// {print $3}'
done | sort -u | while read -r library; do
  file=$(readlink -f "$library")
  owner=$(dpkg-query -S "$file" 2>/dev/null || dpkg-query -S "${file#/usr}" 2>/dev/null || true)
  owner=${owner%%:*}
  echo "${owner:-$file (of no package)}"
done | sort -u | while read -r package; do
  licences=$(sed -n 's/^License:[[:space:]]*//p' "/usr/share/doc/$package/copyright" 2>/dev/null |
             sort -u | paste -sd, | sed 's/,/, /g')
  printf '%-26s %s\n' "$package" "${licences:-see /usr/share/doc/$package/copyright}"
done
