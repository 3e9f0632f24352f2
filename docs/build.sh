#!/usr/bin/env bash
# Builds the guide as a book: target/book/docs/index.html. It needs mdbook 0.5.
# Files outside docs/ that pages link to are copied beside the book, so that every link leads somewhere.
set -euo pipefail
cd "$(dirname "$0")/.."
mdbook=${MDBOOK:-mdbook}
rm -rf target/book
"$mdbook" build
# mdbook rewrites links to pages. Those to other files stay, and lead out of the book.
grep -rhoE '\]\(\.\./[^)#]+' docs --include='*.md' | sed -E 's/^\]\((\.\.\/)+//' | sort -u | while read -r path; do
    if [ -e "$path" ]; then
        mkdir -p "target/book/$(dirname "$path")"
        cp -r "$path" "target/book/$path"
    fi
done
echo "target/book/docs/index.html"
