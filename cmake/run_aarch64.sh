#!/usr/bin/env bash
# run_aarch64.sh ROOT PROGRAM ARGUMENT...: runs a program of the folder ROOT (unpack_packages.sh) under
# qemu-user, as if ROOT were the whole system. The emulator is /qemu there: a program that starts
# another one must start it by /qemu.
set -euo pipefail

[ $# -gt 1 ] || {
  echo "run_aarch64.sh: ROOT and PROGRAM are expected" >&2
  exit 2
}
root=$1
shift
mkdir -p "$root/proc" "$root/tmp"
cp "$(command -v qemu-aarch64-static)" "$root/qemu"
user=()
if [ "$(id -u)" -ne 0 ]; then user=(--map-root-user); fi
exec unshare "${user[@]}" --mount --pid --fork --mount-proc="$root/proc" chroot "$root" /qemu "$@"
