#!/usr/bin/env bash
# Sets up the tests in a browser: Chromium from Debian's or Ubuntu's packages, if there is none, and a virtual environment.
# Usage: tests/browser/setup.sh VENV
set -euo pipefail
venv=$1

if ! command -v chromium >/dev/null; then
    root() { if [ "$(id -u)" = 0 ]; then "$@"; else sudo "$@"; fi; }
    root apt-get update --quiet
    root env DEBIAN_FRONTEND=noninteractive apt-get install --yes --quiet --no-install-recommends chromium fonts-dejavu-core
fi
"${PYTHON:-python3}" -m venv --clear "$venv"
"$venv/bin/python" -m pip install --quiet --disable-pip-version-check pytest playwright
