"""Judges the JSON schema of scenarios with an independent validator.

check_schema.py SCHEMA SCENARIOS BAD..: all scenarios in the folder must be valid, as written and merged with what they
extend; each bad file must not be.
"""

import json
import sys
import tomllib
from pathlib import Path

import jsonschema


def read(path):
    with open(path, "rb") as file:
        return tomllib.load(file)


def merged(path):
    """The scenario with what it extends: tables key by key, all else replaced."""
    own = read(path)
    if "extends" not in own:
        return own
    base = merged(path.parent / own.pop("extends"))
    return overlaid(base, own)


def overlaid(under, over):
    if not (isinstance(under, dict) and isinstance(over, dict)):
        return over
    both = dict(under)
    for key, value in over.items():
        both[key] = overlaid(under[key], value) if key in under else value
    return both


def main(schema, scenarios, *bad):
    schema = json.loads(Path(schema).read_text(encoding="utf-8"))
    validator_type = jsonschema.Draft202012Validator
    validator_type.check_schema(schema)
    validator = validator_type(schema)
    faults = []
    files = sorted(Path(scenarios).rglob("*.toml"))
    for file in files:
        faults += [f"{file}: {error.json_path}: {error.message}" for error in validator.iter_errors(read(file))]
        # A choice of a later file replaces that of an earlier one, which plain merging does not know.
        faults += [
            f"{file}, merged: {error.json_path}: {error.message}"
            for error in validator.iter_errors(merged(file))
            if error.validator != "oneOf"
        ]
    rejected = 0
    for file in bad:
        if validator.is_valid(read(file)):
            faults.append(f"{file}: accepted")
        else:
            rejected += 1
    print(f"{len(files)} accepted, {rejected} rejected" if not faults else "\n".join(faults))
    return 1 if faults or len(files) < 80 else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
