// The legend of a false-colour picture: its colours, what they count, and their ends.

import { byId, h, replace } from "./html.js";

/** What false colours mean, and their lowest and highest end, as the server draws them. */
const HEAT = /** @type {Record<string, [meaning: string, low: string, high: string]>} */ ({
    depth: ["distance along the view's axis", "far", "near"],
    error: ["standard error ÷ mean, logarithmic", "0.1 %", "100 %"],
    samples: ["samples per pixel", "0", "most"],
    bounces: ["rays of a sample", "0", "most"],
    nodes: ["BVH nodes that the camera ray visits", "0", "most"],
    tests: ["primitives that the camera ray tests", "0", "most"],
    flip: ["FLIP: the difference that is seen", "0", "1"],
    z: ["too dark, too bright: in standard errors", "dark", "bright"],
});

/** @param {import("./app.js").App} app */
export function showLegend(app) {
    const legend = byId("legend");
    const show = () => {
        const { compare } = app.view.get();
        // That of the picture that is shown, which may wait for the one that is asked for.
        const layer = app.frame.get()?.layer ?? "color";
        const shown = layer === "color" ? compare ?? "" : layer;
        const known = HEAT[shown];
        legend.hidden = !known;
        if (!known) return;
        const [meaning, low, high] = known;
        legend.dataset.scale = shown === "z" ? "signed" : "heat";
        replace(legend, h("span", { class: "faint" }, meaning), h("span", { class: "scale" }), h("span", { class: "ends" }, h("span", {}, low), h("span", {}, high)));
    };
    app.view.on(show);
    app.frame.on(show);
}
