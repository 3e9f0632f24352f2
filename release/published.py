#!/usr/bin/env python3
"""Prints the packages of the workspace that are published, as flags of cargo: `--package NAME ..`."""

import json
import subprocess

metadata = subprocess.run(
    ["cargo", "metadata", "--no-deps", "--format-version", "1", "--locked"], capture_output=True, check=True
)
packages = json.loads(metadata.stdout)["packages"]
# `publish = false` is an empty list of registries.
print(*(f"--package {package['name']}" for package in packages if package["publish"] != []))
