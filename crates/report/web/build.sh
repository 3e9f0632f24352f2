#!/usr/bin/env bash
# Bundles the page of reports into ../assets: report.js, report.css and the licences of the libraries in them.
# Needs Node 18 or later with npm. `build.sh --check` writes nothing and fails if the committed bundle is not what this makes.
set -euo pipefail
cd "$(dirname "$0")"
out=../assets
if [ "${1:-}" = "--check" ]; then
    out=$(mktemp -d)
    trap 'rm -rf "$out"' EXIT
fi
if [ ! -x node_modules/.bin/esbuild ] || [ ! -d node_modules/three ]; then npm ci --silent --no-audit --no-fund; fi
esbuild() { node_modules/.bin/esbuild "$@" --minify --charset=utf8 --legal-comments=none --log-level=warning; }
esbuild src/main.js --bundle --format=iife --target=es2022 --outfile="$out/report.js"
cat node_modules/uplot/dist/uPlot.min.css src/style.css >"$out/all.css"
esbuild "$out/all.css" --outfile="$out/report.css"
rm "$out/all.css"
{
    echo "This file contains these libraries."
    for library in three uplot; do
        printf '\n%s %s\n\n' "$library" "$(node -p "require('./node_modules/$library/package.json').version")"
        cat "node_modules/$library/LICENSE"
    done
} >"$out/licences.txt"
if [ "$out" != ../assets ]; then
    for file in report.js report.css licences.txt; do
        if ! cmp -s "$out/$file" "../assets/$file"; then
            echo "crates/report/assets/$file is not what crates/report/web/build.sh makes; run that and commit the result"
            exit 1
        fi
    done
    echo "the committed bundle is what build.sh makes"
fi
