#!/usr/bin/env bash
# Makes a release: everything that is published, from a clean clone, into target/release-VERSION.
#
#   release/build.sh                      the release
#   release/build.sh --rehearse PROGRAM   the same with a program that is built already, from any tree, without the packages: seconds
#
# It needs Rust, a C compiler, git, Python 3.11, GNU tar and gzip; and for the check of the list of components
# `python3 -m pip install -r release/requirements.txt`, which a rehearsal does without. The result depends on the commit alone.
set -euo pipefail
cd "$(dirname "$0")/.."

step() { printf '\n== %s\n' "$1"; }
stop() { printf '%s\n' "$1" >&2; exit 1; }

rehearsed=
case "${1:-}" in
    "") ;;
    --rehearse) rehearsed=$(realpath "${2:?--rehearse needs a program}") ;;
    *) stop "\`$1\` is unknown; allowed is --rehearse PROGRAM" ;;
esac

version=$(sed -n '/^\[workspace.package\]/,/^$/s/^version = "\(.*\)"/\1/p' Cargo.toml)
target=$(rustc --print host-tuple)
name="sextant-$version-$target"
out="$PWD/target/release-$version"
[ -z "$rehearsed" ] || out="$PWD/target/rehearsal"
SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct)}
export SOURCE_DATE_EPOCH LC_ALL=C TZ=UTC

step "version $version"
release/version.sh "$version" ${rehearsed:+--unreleased}
if [ -z "$rehearsed" ] && [ -n "$(git status --porcelain)" ]; then
    git status --short
    stop "the tree has changes that are not committed; a release is made from a clean clone"
fi
rm -rf "$out"
mkdir -p "$out"

if [ -z "$rehearsed" ]; then
    step "packages"
    # shellcheck disable=SC2046 # flags, word by word
    cargo package $(release/published.py) --locked
    mkdir "$out/crates"
    cp target/package/*-"$version".crate "$out/crates"

    step "program"
    release/compile.sh "$PWD" "$PWD/target"
    program="target/dist/sextant"
else
    program=$rehearsed
fi

step "archive"
folder="$out/$name"
mkdir -p "$folder/bin" "$folder/completions" "$folder/man/man1"
cp "$program" "$folder/bin/sextant"
sextant="$folder/bin/sextant"
[ "$("$sextant" --version)" = "sextant $version" ] || stop "\`$program --version\` prints \`$("$sextant" --version)\`, not \`sextant $version\`"
for pair in bash:sextant.bash zsh:_sextant fish:sextant.fish elvish:sextant.elv powershell:_sextant.ps1; do
    "$sextant" completions "${pair%%:*}" >"$folder/completions/${pair##*:}"
done
"$sextant" man >"$folder/man/man1/sextant.1"
# The commands are the words in the second column of its help.
"$sextant" --help | sed -n '/^Commands:/,/^$/s/^  \([a-z-]*\) .*/\1/p' | grep -v '^help$' | while read -r command; do
    "$sextant" man "$command" >"$folder/man/man1/sextant-$command.1"
done
git ls-files -z README.md CHANGELOG.md SECURITY.md CITATION.cff 'LICENSE-*' scenarios docs | xargs -0 cp --parents --target-directory "$folder"
release/notices.py "$target" "$folder/THIRD-PARTY-LICENCES.txt"
chmod -R u=rwX,go=rX "$folder"
# Packed so that its octets depend on its content alone.
tar --sort=name --owner=0 --group=0 --numeric-owner --mtime="@$SOURCE_DATE_EPOCH" --format=gnu \
    --directory "$out" --create "$name" | gzip -n -9 >"$out/$name.tar.gz"
rm -r "$folder"

step "source"
git archive --format=tar --prefix="sextant-$version/" HEAD | gzip -n -9 >"$out/sextant-$version-source.tar.gz"

step "components"
release/sbom.py "$target" "$out/$name.cdx.json"
if python3 -c 'import cyclonedx, jsonschema' 2>/dev/null; then
    release/sbom.py --check "$out/$name.cdx.json"
elif [ -n "$rehearsed" ]; then
    echo "not held to the schema; install: python3 -m pip install -r release/requirements.txt"
else
    stop "the list of components cannot be checked; install: python3 -m pip install -r release/requirements.txt"
fi

step "checksums"
sums=$(cd "$out" && find . -type f -printf '%P\n' | sort | xargs sha256sum)
printf '%s\n' "$sums" >"$out/SHA256SUMS"

step "the archive as a user has it"
release/try_archive.sh "$out/$name.tar.gz"

step "done"
(cd "$out" && ls -l . && echo "$out")
