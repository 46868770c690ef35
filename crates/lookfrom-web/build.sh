#!/usr/bin/env bash
# The page without a server, dist/page/index.html: crates/lookfrom-web/build.sh
#
# Compiles the library to WebAssembly by a compiler from Debian's packages (.ci/rustc-web), or by RUSTC and WASM_LD where both are set, and
# puts it, the page of `lookfrom view` and the scenes of the notes and the guide into one file. Needs node, npm and
# zstd; says "skipped", with code 3, where something cannot be had.
set -euo pipefail
cd "$(dirname "$0")"
root=$(realpath ../..)
target=$(realpath -m "${CARGO_TARGET_DIR:-$root/target}")

skip() { printf 'skipped: %s\n' "$1"; exit 3; }
for tool in node npm zstd; do
    command -v "$tool" > /dev/null || skip "$tool is not installed"
done
[[ -d node_modules/esbuild && -d node_modules/fzstd ]] || npm ci --no-audit --no-fund --silent --fetch-retries 1 --fetch-timeout 20000 2> /dev/null \
    || skip "npm's packages cannot be had"
if [[ -z ${RUSTC:-} || -z ${WASM_LD:-} ]]; then
    tools=$("$root/.ci/rustc-web") || skip "there is no compiler for WebAssembly"
    export RUSTC=$tools/rustc WASM_LD=$tools/wasm-ld
fi

export CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUSTFLAGS="-Ctarget-feature=+simd128 -Clinker=$WASM_LD"
# The stack has a megabyte by default, and readers of nested scenes need more.
RUSTC_BOOTSTRAP=1 cargo rustc --locked --profile web -p lookfrom-web --lib --target wasm32-unknown-unknown -Zbuild-std=std,panic_abort \
    --manifest-path "$root/Cargo.toml" --target-dir "$target" -- -Clink-arg=-zstack-size=8388608
built=$target/wasm32-unknown-unknown/web/lookfrom_web.wasm

node bundle.mjs "$built" "$root/dist/page"
