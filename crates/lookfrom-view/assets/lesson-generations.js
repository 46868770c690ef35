// Two generations: Appel's ray casting (1968) stops at the first hit, Whitted's ray tracing (1980) grows a tree from it.

import { slider } from "./fields.js";
import { display } from "./formula.js";
import { h, replace, svg } from "./html.js";

const DEEPEST = 5;

/** Rays of a tree in which each hit sends a mirrored and a refracted one. @param {number} depth */
export const countOfRays = (depth) => ({ rays: 2 ** (depth + 1) - 1 });

export function generationsLesson() {
    const figure = svg("svg", { viewBox: "0 0 400 210", class: "figure", role: "img", "aria-label": "A tree of rays" });
    const words = h("p", { class: "number centred", role: "status" });
    let [grown, count] = [2, 1];
    const depth = slider("Depth", { min: 0, max: DEEPEST, step: 1 }, () => grown, (value) => ((grown = value), draw()));
    const lights = slider("Lights", { min: 0, max: 4, step: 1 }, () => count, (value) => ((count = value), draw()));

    function draw() {
        const place = (/** @type {number} */ level, /** @type {number} */ i) => [(400 * (i + 0.5)) / 2 ** level, 22 + level * 34];
        const levels = Array.from({ length: grown + 1 }, (_, level) => level);
        replace(figure, levels.map((level) => Array.from({ length: 2 ** level }, (_, i) => {
            const [x, y] = place(level, i);
            const [px, py] = level === 0 ? [200, 0] : place(level - 1, i >> 1);
            const kind = level === 0 ? "camera" : i % 2 === 0 ? "reflected" : "refracted";
            const shadows = Array.from({ length: count }, (_, k) => svg("line", { x1: x, y1: y, x2: x + 5 * (k - (count - 1) / 2), y2: y + 12, class: "shadow-ray" }));
            return [svg("line", { x1: px, y1: py, x2: x, y2: y, class: `edge ${kind}`, "stroke-width": 2 }), shadows, svg("circle", { cx: x, cy: y, r: Math.max(1.5, 5 - level), class: `node ${kind}` })].flat();
        }).flat()).flat());
        const { rays } = countOfRays(grown);
        words.textContent = `${rays} ${rays === 1 ? "ray" : "rays"} · ${rays * count} shadow rays · ${grown === 0 ? "ray casting, 1968" : "ray tracing, 1980"}`;
        figure.setAttribute("aria-label", words.textContent);
    }
    draw();
    const element = h("div", {},
        h("p", {}, "Appel (1968) follows one ray from the eye through each pixel to the nearest surface, and asks from there by a shadow ray which lights it sees. Whitted (1980) goes on: a mirrored and a refracted ray leave the hit, and each of them asks the same again. Drag the depth; at 0 the tree is Appel's."),
        display("I = k_a I_a + k_d Σ (N·L_j) I_j + k_s Σ (N·H_j)ⁿ I_j + k_r S + k_t T"),
        depth.element, lights.element, figure, words);
    return { element, show() {} };
}
