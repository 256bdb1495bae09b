#!/bin/sh
# Makes .venv with everything that Tidemill needs. PYTHON names the interpreter, Python 3.11.
set -eu
cd "$(dirname "$0")"

python=${PYTHON:-python3.11}
if ! "$python" -c 'import sys; sys.exit(sys.version_info[:2] != (3, 11))' 2>/dev/null; then
    echo "Tidemill needs Python 3.11 (Blender's package exists for no other version): install it, or run" >&2
    echo "  PYTHON=/path/to/python3.11 ./setup.sh" >&2
    exit 1
fi

"$python" -m venv .venv
.venv/bin/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable '.[test]'

libraries="libx11-6 libxrender1 libxfixes3 libxi6 libxkbcommon0 libsm6 libice6 libgl1"
if ! .venv/bin/python -c 'import bpy' >/dev/null 2>&1; then
    if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
        apt-get update -qq
        # shellcheck disable=SC2086
        apt-get install -qq --yes --no-install-recommends $libraries >/dev/null
    else
        echo "Blender needs system libraries. On Debian and Ubuntu:" >&2
        echo "  sudo apt-get install $libraries" >&2
        exit 1
    fi
    .venv/bin/python -c 'import bpy'
fi
echo "ready: .venv/bin/snakemake --cores 2 renders/bunny"
