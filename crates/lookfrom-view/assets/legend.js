// The legend of a false-colour layer: its colours, its name, and the range where the server gives one.

import { byId, h, replace } from "./html.js";
import { short } from "./format.js";

/** Layers that are colours themselves. */
const COLORS = new Set(["color", "albedo", "noisy", "normals", "normal", "shading normal", "uv"]);
const MEANINGS = /** @type {Record<string, string>} */ ({
    variance: "variance of the samples",
    samples: "samples per pixel",
    bounces: "bounces, mean",
    bvh: "nodes and primitives tested, per ray",
    cost: "nodes and primitives tested, per ray",
    depth: "distance along the view's axis",
    flip: "FLIP: visible difference",
    z: "standard errors between picture and reference",
    difference: "absolute difference",
});

/** @param {import("./app.js").App} app */
export function showLegend(app) {
    const legend = byId("legend");
    const show = () => {
        const { layer, compare } = app.view.get();
        const shown = compare && compare !== "wipe" && compare !== "reference" ? compare : layer;
        const known = app.scene.get()?.layers.find(({ name }) => name === shown);
        const range = app.frame.get()?.range ?? known?.range;
        legend.hidden = COLORS.has(shown) || compare === "wipe" || compare === "reference";
        if (legend.hidden) return;
        legend.dataset.scale = shown;
        replace(
            legend,
            h("span", { class: "faint" }, known?.unit ?? MEANINGS[shown] ?? known?.title ?? shown),
            h("span", { class: "scale" }),
            h("span", { class: "ends" }, h("span", {}, range ? short(range[0], 3) : "low"), h("span", {}, range ? short(range[1], 3) : "high")),
        );
    };
    app.view.on(show);
    app.scene.on(show);
    app.frame.on(show);
}
