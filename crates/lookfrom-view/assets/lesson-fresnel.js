// Snell's law and Fresnel's equations as a dial: the incident ray is turned by hand.

import { draggable } from "./drag.js";
import { display, frac } from "./formula.js";
import { h, replace, svg } from "./html.js";
import { slider } from "./fields.js";
import { short } from "./format.js";

const [CX, CY, R] = [150, 130, 110];

/** @param {import("./app.js").App} app */
export function fresnelLesson(app) {
    let angle = 0.7;
    let [eta1, eta2] = [1, 1.5];
    const figure = svg("svg", { viewBox: "0 0 300 260", class: "figure dial", role: "slider", tabindex: "0", "aria-label": "Angle of incidence, degrees", "aria-valuemin": 0, "aria-valuemax": 90 });
    const curve = svg("svg", { viewBox: "0 0 300 120", class: "figure", role: "img", "aria-label": "Fresnel reflectance over the angle of incidence" });
    const words = h("p", { class: "number centred", role: "status" });
    const first = slider("η above", { min: 1, max: 2.5, step: 0.01 }, () => eta1, (value) => ((eta1 = value), draw()), (value) => value.toFixed(2));
    const second = slider("η below", { min: 1, max: 2.5, step: 0.01 }, () => eta2, (value) => ((eta2 = value), draw()), (value) => value.toFixed(2));
    const swap = h("button", { type: "button", onclick: () => {
        [eta1, eta2] = [eta2, eta1];
        first.show();
        second.show();
        draw();
    } }, "Turn it over");
    const here = h("p", { class: "hint" });
    const element = h("div", {}, h("p", {}, "Turn the incident ray: drag it, or use the arrow keys."), figure, words,
        first.element, second.element, swap, display("η_1 sin θ_1 = η_2 sin θ_2,  F = ", frac("1", "2"), "( r_s² + r_p² )"), curve, here);

    const turn = (/** @type {number} */ to) => {
        angle = Math.max(0, Math.min(Math.PI / 2 - 1e-3, to));
        draw();
    };
    draggable(figure, {
        to: (x, y) => turn(Math.atan2(Math.abs(x - CX), Math.abs(y - CY))),
        by: (right, up) => turn(angle - ((right + up) * Math.PI) / 180),
    });

    function draw() {
        const { reflectance, refracted } = fresnel(angle, eta1, eta2);
        const degrees = (angle * 180) / Math.PI;
        const tip = (/** @type {number} */ a, /** @type {number} */ sx, /** @type {number} */ sy) => [CX + sx * R * Math.sin(a), CY + sy * R * Math.cos(a)];
        const [ix, iy] = tip(angle, -1, -1);
        const [rx, ry] = tip(angle, 1, -1);
        const transmitted = refracted === null ? null : tip(refracted, 1, 1);
        replace(figure, svg("rect", { x: 0, y: CY, width: 300, height: 130, class: "glass" }), svg("circle", { cx: CX, cy: CY, r: R, class: "ring" }),
            svg("line", { x1: CX, x2: CX, y1: 10, y2: 250, class: "grid" }), svg("line", { x1: 0, x2: 300, y1: CY, y2: CY, class: "axis" }),
            svg("line", { x1: ix, y1: iy, x2: CX, y2: CY, class: "incident" }),
            svg("line", { x1: CX, y1: CY, x2: rx, y2: ry, class: "reflected", "stroke-width": 0.5 + 5 * reflectance }),
            transmitted && svg("line", { x1: CX, y1: CY, x2: transmitted[0], y2: transmitted[1], class: "refracted", "stroke-width": 0.5 + 5 * (1 - reflectance) }),
            svg("circle", { cx: ix, cy: iy, r: 6, class: "handle" }),
            svg("text", { x: 8, y: CY - 8 }, `η₁ = ${eta1.toFixed(2)}`), svg("text", { x: 8, y: CY + 18 }, `η₂ = ${eta2.toFixed(2)}`));
        words.textContent = `θ₁ ${degrees.toFixed(1)}° · ${refracted === null ? "total internal reflection" : `θ₂ ${((refracted * 180) / Math.PI).toFixed(1)}°`} · F = ${short(reflectance, 4)}`;
        figure.setAttribute("aria-valuenow", degrees.toFixed(1));
        figure.setAttribute("aria-valuetext", `${degrees.toFixed(1)}°`);
        const points = Array.from({ length: 91 }, (_, i) => `${20 + i * 3},${(105 - 95 * fresnel(Math.min(i, 89.9) * (Math.PI / 180), eta1, eta2).reflectance).toFixed(1)}`);
        replace(curve, svg("line", { x1: 20, x2: 290, y1: 105, y2: 105, class: "axis" }), svg("polyline", { points: points.join(" "), class: "curve" }),
            svg("circle", { cx: 20 + degrees * 3, cy: 105 - 95 * reflectance, r: 4.5, class: "handle" }),
            svg("text", { x: 20, y: 117 }, "0°"), svg("text", { x: 290, y: 117, class: "end" }, "90°"), svg("text", { x: 16, y: 14, class: "end" }, "1"));
    }

    function show() {
        const branch = app.selectedRay()?.branches.find(({ fresnel: value }) => typeof value === "number");
        here.textContent = branch ? `At the hit of the selected ray, F = ${short(branch.fresnel, 6)}.` : "Where the selected ray meets glass, its own F stands here.";
        draw();
    }
    return { element, show };
}

/**
 * The reflectance for unpolarised light (Fresnel 1823), and the angle of refraction; null where reflection is total.
 * @param {number} angle
 * @param {number} eta1
 * @param {number} eta2
 */
function fresnel(angle, eta1, eta2) {
    const sine = (eta1 / eta2) * Math.sin(angle);
    if (sine >= 1) return { reflectance: 1, refracted: null };
    const refracted = Math.asin(sine);
    const [c1, c2] = [Math.cos(angle), Math.cos(refracted)];
    const s = (eta1 * c1 - eta2 * c2) / (eta1 * c1 + eta2 * c2);
    const p = (eta2 * c1 - eta1 * c2) / (eta2 * c1 + eta1 * c2);
    return { reflectance: (s * s + p * p) / 2, refracted };
}
