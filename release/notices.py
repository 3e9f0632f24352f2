#!/usr/bin/env python3
"""Writes the licences of the libraries in the program, with their texts.

    release/notices.py TARGET [FILE]         to standard output without FILE

Each text is there once, after the libraries that have it. A library whose archive has no text is named with its licence, whose text
is then that of another library or of Sextant. Python 3.11, no packages.
"""

import collections
import re
import sys

from packages import ROOT, Package, linked, write_document

NAMES = re.compile(r"(un)?licen[cs]e|copying|copyright|notice", re.IGNORECASE)
# Folders of an archive that have no part in the program.
ASIDE = {"test", "tests", "fuzz", "contrib", "examples", "doc", "docs", "build", "programs", "target", ".github"}


def texts(package: Package) -> list[str]:
    """The texts of licences in the archive of a package, those of libraries in C within it too."""
    found = []
    for path in sorted(package.folder.rglob("*")):
        inner = path.relative_to(package.folder)
        if path.is_file() and NAMES.match(path.name) and not ASIDE & set(inner.parts[:-1]) and path.suffix not in {".rs", ".c", ".h"}:
            found.append("\n".join(line.rstrip() for line in path.read_text(errors="replace").strip().splitlines()))
    return found


def notices(target: str) -> str:
    """The whole document."""
    packages = [package for package in linked(target).values() if not package.is_ours]
    holders: dict[str, list[Package]] = collections.defaultdict(list)
    without = []
    for package in packages:
        own = texts(package)
        without += [] if own else [package]
        for text in own:
            holders[text].append(package)
    parts = [
        "Libraries in the program sextant, and their licences.\n"
        "Where a library offers several licences, Sextant uses it under MIT or Apache 2.0 if these are among them.\n",
        "\n".join(f"{package.name} {package.version}: {package.licence}" for package in packages) + "\n",
    ]
    if without:
        named = "\n".join(f"{package.name} {package.version}: {package.licence} {package.repository}" for package in without)
        parts.append(f"These archives have no text of their licence; those of MIT and Apache 2.0 are below.\n{named}\n")
    for text, of in holders.items():
        parts.append("\n".join(f"{package.name} {package.version}" for package in of) + f"\n\n{text}\n")
    parts.append("Libraries in the page of reports\n\n" + (ROOT / "crates/report/assets/licences.txt").read_text().strip() + "\n")
    return f"\n{'-' * 80}\n\n".join(parts)


if __name__ == "__main__":
    sys.exit(write_document(notices, __doc__))
