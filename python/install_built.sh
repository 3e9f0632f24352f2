#!/usr/bin/env bash
# Puts the package into the environment of Python FOLDER, with the module that the workspace's tests have built, and what its own
# tests need: `python/install_built.sh FOLDER`. It takes a minute, where `pip install ./python` builds all for a release.
set -euo pipefail
cd "$(dirname "$0")/.."
python="$1/bin/python"
unset PYTHONPATH
# As for the tests, with all that their crates share, so that only the module itself is left.
cargo build --workspace --all-features --lib --tests --locked
"$python" - <<'END' >"$1/requirements.txt"
import tomllib

with open("python/pyproject.toml", "rb") as file:
    print("\n".join(tomllib.load(file)["project"]["optional-dependencies"]["test"]))
END
"$python" -m pip install --quiet --disable-pip-version-check -r "$1/requirements.txt"
packages=$("$python" -c 'import sysconfig; print(sysconfig.get_path("purelib"))')
rm -rf "$packages/sextant"
cp -r python/sextant "$packages/sextant"
cp target/debug/lib_native.so "$packages/sextant/_native.abi3.so"
