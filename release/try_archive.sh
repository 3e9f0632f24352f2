#!/usr/bin/env bash
# Does with an archive what its user does: unpacks it, runs the first command of its README, and looks at what is printed.
#
#   release/try_archive.sh ARCHIVE.tar.gz
set -euo pipefail
archive=$(realpath "$1")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
tar --extract --gzip --file "$archive" --directory "$folder"
cd "$folder/$(basename "$archive" .tar.gz)"
export PATH="$PWD/bin:$PATH"
[ "$(command -v sextant)" = "$PWD/bin/sextant" ]

for file in README.md CHANGELOG.md LICENSE-MIT LICENSE-APACHE THIRD-PARTY-LICENCES.txt man/man1/sextant.1 man/man1/sextant-run.1 \
    completions/sextant.bash completions/_sextant completions/sextant.fish completions/sextant.elv completions/_sextant.ps1; do
    [ -s "$file" ] || { echo "$file is not in the archive"; exit 1; }
done
bash -n completions/sextant.bash
# Each command has its page, and the formatter of pages has nothing to say about them.
[ "$(find man -name 'sextant-*.1' | wc -l)" -ge 10 ]
if command -v groff >/dev/null; then
    [ -z "$(groff -man -Tutf8 -ww -z man/man1/*.1 2>&1 | tee -a /dev/stderr)" ]
fi

# The README runs the program by cargo, or by its name.
arguments=$(sed -n -E 's/^(cargo run --release --|sextant) (run .*)/\2/p' README.md | head -n 1)
[ -n "$arguments" ] || { echo "README.md has no command that runs a scenario"; exit 1; }
echo "sextant $arguments"
# shellcheck disable=SC2086 # the words of a command
sextant $arguments >printed
python3 - <<'PYTHON'
import pathlib

page = pathlib.Path("README.md").read_text()
shown = page.split("<!-- prints -->\n```text\n", 1)[1].split("```", 1)[0].splitlines()
printed = iter(pathlib.Path("printed").read_text().splitlines())
for line in shown:
    if line != "..." and line not in printed:
        raise SystemExit(f"README.md shows a line that is not printed, or not in this order: {line}")
print(f"printed as README.md shows: {sum(line != '...' for line in shown)} lines")
PYTHON
[ -s circular.mcap ] || { echo "no recording was written"; exit 1; }
