#!/usr/bin/env bash
# pip_aarch64.sh PIP ROOT FOLDER ARGUMENT...: `pip install ARGUMENT...` into FOLDER, for the Python of
# aarch64 that unpack_packages.sh unpacked in ROOT.
set -euo pipefail

[ $# -gt 3 ] || {
  echo "pip_aarch64.sh: PIP, ROOT, FOLDER and arguments of pip are expected" >&2
  exit 2
}
pip=$1 root=$2 folder=$3
shift 3
python=$(readlink "$root/usr/bin/python3")
platforms=()
for age in 2_35 2_34 2_31 2_28 2_27 2_26 2_24 2_17; do platforms+=(--platform "manylinux_${age}_aarch64"); done
exec "$pip" install --quiet --target "$folder" --only-binary :all: --implementation cp \
  --python-version "${python#python}" "${platforms[@]}" --platform manylinux2014_aarch64 "$@"
