#!/usr/bin/env bash
# The page of `lookfrom view`: types checked, its connection tested, then used as a person does, in a real browser. run.sh [path of the binary]
#
# Needs node with npm, its packages (`npm ci` here) and Chromium; says "skipped" where one is missing. Screenshots are
# kept in LOOKFROM_SCREENSHOTS, where that is set.
set -euo pipefail
binary=$(realpath -m "${1:-$(dirname "$0")/../../../../target/debug/lookfrom}")
cd "$(dirname "$0")"

skip() { printf 'skipped: %s\n' "$1"; exit 0; }
command -v node > /dev/null && command -v npm > /dev/null || skip "node is not installed"
[[ -x $binary ]] || skip "there is no $binary"
[[ -d node_modules/axe-core && -d node_modules/playwright-core && -d node_modules/typescript ]] || npm ci --no-audit --no-fund --silent --fetch-retries 1 --fetch-timeout 20000 2> /dev/null \
    || skip "npm's packages for the browser cannot be had"

npx tsc --project tsconfig.json
npx tsc --project ../../../lookfrom-web/tests/tsconfig.json
node --test unit/ ../../../lookfrom-web/tests/unit/

chromium=${CHROMIUM:-$(command -v chromium || command -v chromium-browser || command -v google-chrome || true)}
[[ -n $chromium ]] || skip "Chromium is not installed"
LOOKFROM_BINARY=$binary CHROMIUM=$chromium node --test --test-concurrency=1 ./*.test.mjs
