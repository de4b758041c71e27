#!/usr/bin/env bash
# Makes the virtual environment named by the first argument, from the first Python that Blender's module is built for.
set -euo pipefail
venv=$1
[[ -x $venv/bin/python ]] && exit 0

python=
for candidate in python3.11 python3.13 /usr/bin/python3.11 /usr/bin/python3.13 python3; do
  # A version manager's shim exists for versions that it will not run, so each candidate is asked.
  if "$candidate" -c 'import sys; sys.exit(sys.version_info[:2] not in ((3, 11), (3, 13)))' 2>/dev/null; then
    python=$candidate
    break
  fi
done
if [[ -z $python ]]; then
  echo "Tessera needs Python 3.11 (for Blender 4.5 LTS) or 3.13 (for 5.2 LTS), and neither was found." >&2
  echo "On Debian 12: apt install python3.11 python3.11-venv. On Debian 13: apt install python3.13 python3.13-venv." >&2
  exit 1
fi
if ! "$python" -c 'import ensurepip, venv' 2>/dev/null; then
  version=$("$python" -c 'import sys; print("%d.%d" % sys.version_info[:2])')
  echo "$python cannot make virtual environments here. On Debian: apt install python$version-venv" >&2
  exit 1
fi
echo "Making $venv with $("$python" --version)"
"$python" -m venv "$venv"
"$venv/bin/python" -m pip install --quiet --upgrade "pip>=25"
