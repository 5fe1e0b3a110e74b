#!/usr/bin/env bash
# unpack_packages.sh ROOT PACKAGE...: unpacks Debian's packages of aarch64 and all that they depend on
# in the folder ROOT. PACKAGE is a name or a file (./NAME.deb). Nothing is installed, and the
# system's package lists stay unchanged. Changes nothing if ROOT already has these packages.
set -euo pipefail

[ $# -gt 1 ] || {
  echo "unpack_packages.sh: ROOT and PACKAGE are expected" >&2
  exit 2
}
root=$(realpath -m "$1")
shift
[ "$(cat "$root/packages" 2>/dev/null)" != "$*" ] || exit 0
for tool in apt-get dpkg-deb; do
  command -v $tool >/dev/null || {
    echo "unpack_packages.sh: there is no $tool" >&2
    exit 1
  }
done

new=$root.new
apt=$new/apt
rm -rf "$new"
trap 'rm -rf "$new"' EXIT
mkdir -p "$apt/lists/partial" "$apt/cache/archives/partial"
: >"$apt/status"
options=(-q -y --no-install-recommends -o APT::Architecture=arm64 -o APT::Architectures=arm64 -o "Dir::State=$apt"
  -o "Dir::State::status=$apt/status" -o "Dir::Cache=$apt/cache" -o APT::Sandbox::User=)
apt-get "${options[@]}" update
apt-get "${options[@]}" install --download-only "$@"
for archive in "$apt"/cache/archives/*.deb; do dpkg-deb -x "$archive" "$new"; done
for package in "$@"; do
  if [ -f "$package" ]; then dpkg-deb -x "$package" "$new"; fi
done
rm -rf "$apt"
# Links to places in the system become relative, so that they stay in the folder.
find "$new" -type l -lname '/*' -printf '%l\t%p\n' | while IFS=$'\t' read -r target link; do
  ln -sfn "$(realpath -ms --relative-to="$(dirname "$link")" "$new$target")" "$link"
done
echo "$*" >"$new/packages"
rm -rf "$root"
mv "$new" "$root"
