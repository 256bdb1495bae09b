#!/bin/sh
# Makes .venv with everything that Tidemill needs. PYTHON names the interpreter: 3.11 or 3.13, for which there is a
# package of Blender, or 3.12 beside an installed Blender.
set -eu
cd "$(dirname "$0")"

if [ -n "${PYTHON:-}" ]; then set -- "$PYTHON"; else set -- python3.11 python3.13 python3 python3.12; fi
tried="$*"
for python; do
    version=$("$python" -c 'import sys; print("%d.%d" % sys.version_info[:2])' 2>/dev/null) || version=none
    case $version in
    3.11 | 3.13) break ;;
    3.12) if command -v blender >/dev/null; then break; fi ;;
    esac
    version=none
done
if [ "$version" = none ]; then
    echo "Tidemill needs Python 3.11 or 3.13, or 3.12 and an installed Blender; looked for: $tried" >&2
    echo "  fix: install one (on Debian 13: apt-get install python3 python3-venv), or say where it is:" >&2
    echo "  PYTHON=/path/to/python3.13 ./setup.sh" >&2
    exit 1
fi
echo "setting up .venv with $("$python" -c 'import sys; print("Python", sys.version.split()[0], "at", sys.executable)')"

[ -d ".venv/lib/python$version" ] || rm -rf .venv
"$python" -m venv .venv
.venv/bin/python -m pip install --quiet --disable-pip-version-check \
    --constraint "constraints/$version.txt" --editable '.[test]'

libraries="libx11-6 libxrender1 libxfixes3 libxi6 libxkbcommon0 libsm6 libice6 libgl1"
if [ "$version" = 3.12 ]; then
    echo "Blender has no package for Python 3.12; for the installed one: export TIDEMILL_BLENDER=$(command -v blender)"
elif ! .venv/bin/python -c 'import bpy' >/dev/null 2>&1; then
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
