#!/usr/bin/env bash
# The page without a server, used as a person does, in a real browser. run.sh [path of the command]
#
# Needs dist/page/index.html (build.sh) and what the tests of the page of `lookfrom view` need; says "skipped" where something is missing.
# Screenshots are kept in LOOKFROM_SCREENSHOTS, where that is set.
set -euo pipefail
binary=$(realpath -m "${1:-$(dirname "$0")/../../../target/debug/lookfrom}")
cd "$(dirname "$0")"
browser=../../lookfrom-view/tests/browser

skip() { printf 'skipped: %s\n' "$1"; exit 0; }
[[ -f ../../../dist/page/index.html ]] || skip "there is no dist/page/index.html"
[[ -x $binary ]] || skip "there is no $binary"
[[ -d $browser/node_modules/playwright-core ]] || skip "npm's packages for the browser are not there"
chromium=${CHROMIUM:-$(command -v chromium || command -v chromium-browser || command -v google-chrome || true)}
[[ -n $chromium ]] || skip "Chromium is not installed"

LOOKFROM_BINARY=$binary CHROMIUM=$chromium node --test --test-concurrency=1 ./*.test.mjs
