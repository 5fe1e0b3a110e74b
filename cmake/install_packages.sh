#!/usr/bin/env bash
# install_packages.sh SECTION...: installs the Debian packages of these sections of
# debian-packages.txt that are missing. Changes nothing if none is missing.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

packages_of() {
  awk -v wanted="[$1]" '/^\[/ { inside = ($1 == wanted); next }
                        inside && NF && $1 !~ /^#/ { print $1 }' "$here/debian-packages.txt"
}

installed() {
  [ "$(dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null)" = installed ]
}

missing=()
for section in "$@"; do
  for package in $(packages_of "$section"); do
    if ! command -v dpkg-query >/dev/null || ! installed "$package"; then missing+=("$package"); fi
  done
done
[ ${#missing[@]} -gt 0 ] || exit 0

if ! command -v apt-get >/dev/null; then
  echo "apt-get is not installed. Continuing; the packages that Debian calls ${missing[*]} must be installed." >&2
  exit 0
fi
as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || {
    echo "Not root and no sudo: install ${missing[*]} and start again." >&2
    exit 1
  }
  as_root=(sudo)
fi

echo "Installing ${missing[*]}"
log=$(mktemp)
trap 'rm -f "$log"' EXIT
install_all() {
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get update -q &&
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
      apt-get install -q -y --no-install-recommends "${missing[@]}"
}
install_all >"$log" 2>&1 || {
  tail -n 30 "$log" >&2
  echo "apt-get failed." >&2
  exit 1
}
