#!/usr/bin/env bash
# Checks that all files name the same version, and that the changelog dates it.
#
#   release/version.sh VERSION [--unreleased]     with --unreleased, the changelog may still say "Unreleased"
set -euo pipefail
cd "$(dirname "$0")/.."
version=$1
wrong=0
complain() { printf '%s\n' "$1" >&2; wrong=1; }

[[ $version =~ ^[0-9]+\.[0-9]+\.[0-9]+(-[0-9A-Za-z.-]+)?$ ]] || complain "Cargo.toml: the version is \`$version\`; needed is MAJOR.MINOR.PATCH"
while read -r line; do
    complain "Cargo.toml: \`$line\` has another version than \`$version\`"
done < <(sed -n '/^\[workspace.dependencies\]/,/^\[workspace.lints/{/^sextant/p}' Cargo.toml | grep -v "version = \"$version\"")
cited=$(sed -n 's/^version: //p' CITATION.cff)
[ "$cited" = "$version" ] || complain "CITATION.cff: the version is \`$cited\`; Cargo.toml has \`$version\`"

first=$(sed -n 's/^## //p' CHANGELOG.md | head -n 1)
if [ "${2:-}" != --unreleased ]; then
    [[ $first =~ ^"$version - "[0-9]{4}-[0-9]{2}-[0-9]{2}$ ]] ||
        complain "CHANGELOG.md: the first heading is \`$first\`; a release needs \`$version - YEAR-MONTH-DAY\`"
    released=$(sed -n 's/^date-released: //p' CITATION.cff)
    [ "$first" = "$version - $released" ] || complain "CITATION.cff: date-released is \`$released\`; CHANGELOG.md has \`$first\`"
    # A version is published once.
    tagged=$(git rev-parse -q --verify "refs/tags/v$version^{commit}" || true)
    [ -z "$tagged" ] || [ "$tagged" = "$(git rev-parse HEAD)" ] || complain "the tag v$version is another commit: $tagged"
elif [ "$first" != Unreleased ] && [[ $first != "$version - "* ]]; then
    complain "CHANGELOG.md: the first heading is \`$first\`; needed is \`Unreleased\` or \`$version - YEAR-MONTH-DAY\`"
fi
exit "$wrong"
