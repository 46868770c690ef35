// From the pixel to the world: P_k goes through T1, S2, R3 and T4, for a pixel that is dragged.

import { draggable } from "./drag.js";
import { formula, matrix } from "./formula.js";
import { byId, h, replace, svg } from "./html.js";
import { short } from "./format.js";
import { noPixel } from "./no-pixel.js";

/** @typedef {import("./protocol.js").Step} Step */

/** @param {number[][]} m @param {number[]} p */
const times = (m, p) => m.map((row) => row.reduce((sum, x, i) => sum + x * p[i], 0));

/** @param {number[]} p */
const column = (p) => matrix(p.map((x) => [short(x, 5)]));

/** @param {import("./app.js").App} app */
export function cameraLesson(app) {
    const element = h("div");
    return { element, show };

    function show() {
        const inspection = app.inspection.get();
        if (!inspection || !app.frame.get()) return replace(element, noPixel());
        const { steps, p_k } = inspection.camera;
        if (steps[0]?.name !== "T1") return replace(element, h("p", { class: "hint" }, "This camera has other steps: it is not a plane of pixels."));
        const size = app.size();
        const body = h("div");
        const pad = pixelPad(size, [p_k[0], p_k[1]], (p) => fill(p));
        const copy = h("canvas", { width: size[0], height: size[1], "aria-hidden": "true" });
        copy.getContext("2d")?.drawImage(/** @type {HTMLCanvasElement} */ (byId("picture")), 0, 0);
        replace(element,
            h("p", {}, "Drag the point on the image, or move it with the arrow keys. x runs to the right, y ", h("em", {}, "up"), ", both in pixels."),
            h("p", { class: "formula" }, formula("P_world = T_4 · R_3 · S_2 · T_1 · P_k")), h("div", { class: "pad" }, copy, pad), body);
        fill([p_k[0], p_k[1]]);

        /** @param {[number, number]} p */
        function fill([x, y]) {
            let point = [x, y, 0, 1];
            replace(body, h("p", { class: "step-title" }, formula("P_k"), ` = (${short(x, 6)}, ${short(y, 6)}, 0, 1)`),
                steps.map((step) => {
                    const before = point;
                    point = times(step.matrix, before);
                    return h("section", { class: "step" }, h("h4", {}, h("b", {}, step.name), ` ${step.does}`),
                        h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": `${step.name} times the point` },
                            formula(matrix(step.matrix.map((row) => row.map((number) => short(number, 4)))), column(before), "=", column(point))),
                        stage(step, size, point));
                }),
                h("p", {}, "The last point is ", formula("b"), ", on the image plane: the ray starts at the eye, ", formula("a"), `, and is there at t = 1.`),
                h("button", { type: "button", onclick: () => app.pixel.set([Math.min(size[0] - 1, Math.floor(x)), Math.min(size[1] - 1, Math.floor(size[1] - y))]) }, "Inspect this pixel"));
        }
    }
}

/**
 * The image with a point that is dragged.
 * @param {[number, number]} size
 * @param {[number, number]} start
 * @param {(p: [number, number]) => void} moved
 */
function pixelPad([width, height], start, moved) {
    let p = start;
    const dot = svg("circle", { r: width / 60, class: "handle" });
    const picture = svg("svg", { viewBox: `0 0 ${width} ${height}`, role: "slider", tabindex: "0", "aria-label": "The point on the image", "aria-valuemin": 0, "aria-valuemax": width, "aria-valuenow": 0 },
        svg("rect", { width, height, class: "frame-line" }),
        svg("line", { x1: width / 2, x2: width / 2, y1: 0, y2: height, class: "grid" }), svg("line", { x1: 0, x2: width, y1: height / 2, y2: height / 2, class: "grid" }), dot);
    const show = () => {
        dot.setAttribute("cx", String(p[0]));
        dot.setAttribute("cy", String(height - p[1]));
        picture.setAttribute("aria-valuenow", p[0].toFixed(1));
        picture.setAttribute("aria-valuetext", `x ${p[0].toFixed(1)}, y ${p[1].toFixed(1)}`);
    };
    /** @param {number} x @param {number} y */
    const move = (x, y) => {
        p = [Math.max(0, Math.min(width, x)), Math.max(0, Math.min(height, y))];
        show();
        moved(p);
    };
    draggable(picture, { to: (x, y) => move(x, height - y), by: (right, up) => move(p[0] + right, p[1] + up) });
    show();
    return picture;
}

/**
 * The image rectangle after a step, drawn from the side and a little from above, with the axes of its space.
 * @param {Step} step
 * @param {[number, number]} size
 * @param {number[]} point
 */
function stage(step, [width, height], point) {
    const corners = [[0, 0, 0, 1], [width, 0, 0, 1], [width, height, 0, 1], [0, height, 0, 1]].map((p) => times(step.product, p));
    const points = [...corners, point, [0, 0, 0, 1]];
    /** @param {number[]} p an oblique projection, z to the lower left */
    const flat = ([x, y, z]) => [x - 0.45 * z, -y + 0.35 * z];
    const all = points.map(flat);
    const [xs, ys] = [all.map(([x]) => x), all.map(([, y]) => y)];
    const [left, top] = [Math.min(...xs), Math.min(...ys)];
    const extent = Math.max(Math.max(...xs) - left, (Math.max(...ys) - top) * 2, 1e-9);
    const place = (/** @type {number[]} */ p) => {
        const [x, y] = flat(p);
        return [12 + ((x - left) / extent) * 196, 14 + ((y - top) / extent) * 196];
    };
    const [ox, oy] = place([0, 0, 0]);
    const [px, py] = place(point);
    const tall = Math.max(...points.map((p) => place(p)[1])) + 14;
    return svg("svg", { viewBox: `0 0 240 ${Math.max(40, Math.min(130, tall))}`, class: "oblique", "aria-hidden": "true" },
        svg("polygon", { points: corners.map((p) => place(p).map((x) => x.toFixed(1)).join(",")).join(" "), class: "plane" }),
        svg("line", { x1: ox, y1: oy, x2: px, y2: py, class: "ray-line" }),
        svg("circle", { cx: ox, cy: oy, r: 3, class: "origin" }), svg("text", { x: ox + 5, y: oy - 5 }, "0"),
        svg("circle", { cx: px, cy: py, r: 4, class: "handle" }));
}
