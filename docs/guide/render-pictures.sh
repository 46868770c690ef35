#!/usr/bin/env bash
# Renders the pictures of the guide: docs/guide/img/NAME.png from docs/guide/scenes/NAME.toml, docs/guide/img/gltf-NAME.png from
# docs/guide/scenes/gltf/NAME.gltf, docs/guide/img/scene-NAME.png from scenes/NAME.toml, and docs/img/hero.png.
#
#   docs/guide/render-pictures.sh              all of them
#   docs/guide/render-pictures.sh light-spot gltf/sheen   those that are named, of the guide's own scenes
#
# Builds the command, unless LOOKFROM names a binary. The same scene gives the same bytes on any machine, so a picture that
# changes here is one that the program changed.
set -euo pipefail
cd "$(dirname "$0")/../.."

if [[ -z ${LOOKFROM:-} ]]; then
    cargo build --release --bin lookfrom
    LOOKFROM=${CARGO_TARGET_DIR:-target}/release/lookfrom
fi

picture() { "$LOOKFROM" render "$@" --quiet --strict; }

of_guide() {
    local more=()
    # Light from the whole sky is noisy at the number of samples that suits the others, and noise makes a large PNG.
    [[ $1 == light-environment ]] && more=(--samples 512)
    # So does a path.
    grep -q -e lit-stage "docs/guide/scenes/$1.toml" && more=(--fireflies median)
    # Six moments of a round.
    [[ $1 == animation ]] && more=(--frames 0..6 --fps 3 --sheet 6 --size 160x120)
    picture "docs/guide/scenes/$1.toml" -o "docs/guide/img/$1.png" ${more[@]+"${more[@]}"}
}

# A row of things, or three rows where a file has variants.
of_gltf() {
    local model="docs/guide/scenes/gltf/$1.gltf" out="docs/guide/img/gltf-$1" variant
    case $1 in
        dispersion) picture "$model" -o "$out.png" --width 360 --samples 256 --fireflies median ;;
        variants)
            for variant in clay lacquer gold; do
                picture "$model" -o "$out-$variant.png" --width 240 --samples 128 --fireflies median --variant "$variant"
            done
            ;;
        *) picture "$model" -o "$out.png" --width 360 --samples 128 --fireflies median ;;
    esac
}

if (($# > 0)); then
    for name in "$@"; do
        if [[ $name == gltf/* ]]; then of_gltf "${name#gltf/}"; else of_guide "$name"; fi
    done
    exit
fi

mkdir -p docs/guide/img docs/img
for scene in docs/guide/scenes/*.toml; do
    of_guide "$(basename "$scene" .toml)"
done
for model in docs/guide/scenes/gltf/*.gltf; do
    of_gltf "$(basename "$model" .gltf)"
done
picture scenes/hero.toml -o docs/img/hero.png
for denoise in off:noisy on:clean; do
    picture scenes/cornell.toml --width 240 --samples 8 --denoise "${denoise%:*}" \
        -o "docs/guide/img/denoise-${denoise#*:}.png"
done

# Larger scenes, small enough for a page.
of_scene() {
    local scene=$1
    shift
    picture "scenes/$scene" -o "docs/guide/img/scene-${scene%.*}.png" "$@"
}
picture scenes/images/cloister.toml -o scenes/images/cloister.hdr
of_scene cornell.toml --width 400 --samples 256 --fireflies median
of_scene materials.toml --width 528 --samples 192 --fireflies median
of_scene picture-of-light.toml --width 480 --samples 128 --fireflies median
of_scene many-lights.toml --width 480 --samples 160 --fireflies median
of_scene cutouts.toml --width 480 --samples 96
of_scene dispersion.toml --width 480 --samples 256
of_scene star.pbrt --width 320 --height 240 --samples 128 --fireflies median
"$LOOKFROM" inspect scenes/hero.toml 330 300 --depth 2 --svg-view side --svg docs/guide/img/inspector-glass.svg > /dev/null
"$LOOKFROM" inspect scenes/hero.toml 330 300 --integrator path --sample 4 --svg-view side --svg docs/guide/img/inspector-path.svg > /dev/null
"$LOOKFROM" inspect scenes/hero.toml 330 300 --integrator path --sample 4 --svg docs/guide/img/inspector-sheet.svg > /dev/null
"$LOOKFROM" inspect docs/guide/scenes/camera-lens-system.toml 40 200 --svg-view lens --svg docs/guide/img/inspector-lens.svg > /dev/null
