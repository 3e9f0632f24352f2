"""What is linked into the program: the packages of `cargo tree`, with what `cargo metadata` and Cargo.lock say of each."""

import dataclasses
import json
import pathlib
import subprocess
import sys
import tomllib
from collections.abc import Callable

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROGRAM = "sextant-cli"


@dataclasses.dataclass
class Package:
    """A package in the program."""

    name: str
    version: str
    licence: str
    description: str
    repository: str
    folder: pathlib.Path
    sha256: str | None
    """The checksum of its archive in Cargo.lock; None for ours."""
    uses: set[tuple[str, str]] = dataclasses.field(default_factory=set)

    @property
    def key(self) -> tuple[str, str]:
        """Name and version."""
        return self.name, self.version

    @property
    def is_ours(self) -> bool:
        """Whether it is a crate of this tree."""
        return self.sha256 is None


def cargo(*arguments: str) -> str:
    """What a command of cargo prints."""
    done = subprocess.run(["cargo", *arguments], cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True)
    return done.stdout


def linked(target: str) -> dict[tuple[str, str], Package]:
    """The packages that are linked into the program for a target, by name and version, in this order.

    Procedural macros, build scripts and tests leave nothing in the program, so their packages are not among them.
    """
    tree = cargo("tree", "--locked", "--package", PROGRAM, "--all-features", "--target", target, "--charset", "ascii",
                 "--edges", "normal,no-proc-macro", "--prefix", "depth", "--format", " {p}")
    metadata = json.loads(cargo("metadata", "--locked", "--format-version", "1", "--all-features"))
    known = {(package["name"], package["version"]): package for package in metadata["packages"]}
    lock = tomllib.loads((ROOT / "Cargo.lock").read_text())
    checksums = {(package["name"], package["version"]): package.get("checksum") for package in lock["package"]}

    found: dict[tuple[str, str], Package] = {}
    above: list[Package] = []
    for line in tree.splitlines():
        depth, name, version, *_ = line.split()
        key = name, version.removeprefix("v")
        if key not in found:
            about = known[key]
            found[key] = Package(
                *key,
                licence=(about["license"] or "").replace("/", " OR "),
                description=" ".join((about["description"] or "").split()),
                repository=about["repository"] or "",
                folder=pathlib.Path(about["manifest_path"]).parent,
                sha256=checksums[key],
            )
        del above[int(depth):]
        if above:
            above[-1].uses.add(key)
        above.append(found[key])
    return dict(sorted(found.items()))


def write_document(make: Callable[[str], str], usage: str | None) -> int:
    """Does what `TARGET [FILE]` on the command line asks for: writes the document that `make` makes of a target."""
    match sys.argv[1:]:
        case [target]:
            print(make(target), end="")
        case [target, path]:
            pathlib.Path(path).write_text(make(target))
        case _:
            print(usage, file=sys.stderr)
            return 2
    return 0
