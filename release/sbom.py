#!/usr/bin/env python3
"""Writes what is in the program as a CycloneDX 1.6 document (JSON).

    release/sbom.py TARGET [FILE]            to standard output without FILE
    release/sbom.py --check FILE             holds a document to the schema of CycloneDX (needs release/requirements.txt)

The document is a function of Cargo.lock, package-lock.json and SOURCE_DATE_EPOCH alone. Python 3.11, no packages.
"""

import base64
import datetime
import json
import os
import pathlib
import sys
import uuid

from packages import PROGRAM, ROOT, Package, linked, write_document

WEB = ROOT / "crates/report/web"
REPORT = "sextant-report"


def purl(package: Package) -> str:
    """The package URL."""
    return f"pkg:cargo/{package.name}@{package.version.replace('+', '%2B')}"


def component(package: Package) -> dict:
    """The entry of a package."""
    is_program = package.name == PROGRAM
    entry = {
        "type": "application" if is_program else "library",
        "bom-ref": purl(package),
        "name": package.name,
        "version": package.version,
        "description": package.description,
        "licenses": [{"expression": package.licence}],
        "purl": purl(package),
    }
    if package.sha256:
        entry["hashes"] = [{"alg": "SHA-256", "content": package.sha256}]
    if package.repository:
        entry["externalReferences"] = [{"type": "vcs", "url": package.repository}]
    return entry


def scripts() -> list[dict]:
    """The libraries in the page of reports, as its package-lock.json has them."""
    lock = json.loads((WEB / "package-lock.json").read_text())["packages"]
    entries = []
    for name in sorted(lock[""]["dependencies"]):
        about = lock[f"node_modules/{name}"]
        algorithm, digest = about["integrity"].split("-", 1)
        assert algorithm == "sha512", about["integrity"]
        reference = f"pkg:npm/{name}@{about['version']}"
        entries.append({
            "type": "library",
            "bom-ref": reference,
            "name": name,
            "version": about["version"],
            "hashes": [{"alg": "SHA-512", "content": base64.b64decode(digest).hex()}],
            "licenses": [{"license": {"id": about["license"]}}],
            "purl": reference,
        })
    return entries


def document(target: str) -> dict:
    """The whole document."""
    packages = linked(target)
    pages = scripts()
    program = next(package for package in packages.values() if package.name == PROGRAM)
    components = [component(package) for package in packages.values() if package is not program] + pages
    edges = [
        {
            "ref": purl(package),
            "dependsOn": sorted(purl(packages[key]) for key in package.uses)
            + ([page["bom-ref"] for page in pages] if package.name == REPORT else []),
        }
        for package in packages.values()
    ]
    edges += [{"ref": page["bom-ref"]} for page in pages]
    metadata = {
        "component": component(program),
        "properties": [{"name": "sextant:target", "value": target}],
    }
    if "SOURCE_DATE_EPOCH" in os.environ:
        at = datetime.datetime.fromtimestamp(int(os.environ["SOURCE_DATE_EPOCH"]), datetime.UTC)
        metadata = {"timestamp": at.strftime("%Y-%m-%dT%H:%M:%SZ"), **metadata}
    content = json.dumps([metadata, components, edges], sort_keys=True)
    return {
        "$schema": "http://cyclonedx.org/schema/bom-1.6.schema.json",
        "bomFormat": "CycloneDX",
        "specVersion": "1.6",
        # The same content has the same number.
        "serialNumber": f"urn:uuid:{uuid.uuid5(uuid.NAMESPACE_URL, content)}",
        "version": 1,
        "metadata": metadata,
        "components": components,
        "dependencies": edges,
    }


def check(path: pathlib.Path) -> int:
    """Holds a document to the schema, and its edges to its components."""
    from cyclonedx.schema import SchemaVersion
    from cyclonedx.validation.json import JsonStrictValidator

    text = path.read_text()
    error = JsonStrictValidator(SchemaVersion.V1_6).validate_str(text)
    if error:
        print(f"{path} is no CycloneDX 1.6: {error}", file=sys.stderr)
        return 1
    content = json.loads(text)
    components = [content["metadata"]["component"], *content["components"]]
    names = {entry["bom-ref"] for entry in components}
    reached, new = set(), {components[0]["bom-ref"]}
    uses = {edge["ref"]: set(edge.get("dependsOn", [])) for edge in content["dependencies"]}
    while new:
        reached |= new
        new = set().union(*(uses[name] for name in new)) - reached
    if reached != names:
        print(f"{path}: these do not belong together: {sorted(reached ^ names)}", file=sys.stderr)
        return 1
    print(f"{path}: CycloneDX 1.6 with {len(names)} components, as the schema says")
    return 0


def main() -> int:
    match sys.argv[1:]:
        case ["--check", path]:
            return check(pathlib.Path(path))
    return write_document(lambda target: json.dumps(document(target), indent=2) + "\n", __doc__)


if __name__ == "__main__":
    sys.exit(main())
