// Density along a ray in a medium: the extinction coefficient and its majorant over the distance, with the collisions that were sampled.

import { svg } from "./html.js";
import { short } from "./format.js";

/** @typedef {import("./protocol.js").Ray} Ray */

const [LEFT, RIGHT, TOP, BOTTOM] = [44, 388, 12, 112];

/**
 * The plot of a ray's way in a medium; null where it has none.
 * @param {Ray} ray
 */
export function densityPlot({ flight, tracking }) {
    if (flight) return flightPlot(flight);
    if (tracking?.profile) return trackingPlot(tracking.profile, tracking);
    return null;
}

/** @param {readonly number[]} lanes */
const mean = (lanes) => lanes.reduce((sum, lane) => sum + lane, 0) / lanes.length;

/** The same everywhere: one distance was sampled. @param {NonNullable<Ray["flight"]>} flight */
function flightPlot({ extinction, distance, limit, scattered_at: place }) {
    const sigma = mean(extinction);
    const reach = Number.isFinite(limit) ? limit : 2 * distance;
    if (!(sigma > 0) || !(reach > 0)) return null;
    const axes = scales(reach, sigma);
    const { x, y } = axes;
    return plot(axes, "Extinction along the ray, and the distance that was sampled",
        svg("polyline", { points: `${x(0)},${y(sigma)} ${x(reach)},${y(sigma)}`, class: "curve" }),
        mark(x(Math.min(distance, reach)), y(sigma), place !== null, `${short(distance)}${place ? "" : ": beyond"}`));
}

/** @param {NonNullable<NonNullable<Ray["tracking"]>["profile"]>} profile @param {NonNullable<Ray["tracking"]>} tracking */
function trackingPlot({ start, end, majorant, extinction }, { collisions }) {
    const axes = scales(end, Math.max(...majorant, ...collisions.map((collision) => collision.majorant)), start);
    const { x, y } = axes;
    const width = (end - start) / majorant.length;
    const stairs = majorant.flatMap((most, i) => [`${x(start + i * width)},${y(most)}`, `${x(start + (i + 1) * width)},${y(most)}`]);
    const curve = extinction.map((sigma, i) => `${x(start + (i + 0.5) * width)},${y(sigma)}`);
    const marks = collisions.map(({ t, absorption, scattering, is_real: isReal }) =>
        mark(x(t), y(mean(absorption) + mean(scattering)), isReal, `t = ${short(t)}`));
    return plot(axes, `Extinction along the ray below its majorant, and ${collisions.length} collisions`,
        svg("polyline", { points: stairs.join(" "), class: "stairs" }), svg("polyline", { points: curve.join(" "), class: "curve" }), marks);
}

/** A collision: filled where it is real. @param {number} x @param {number} y @param {boolean} isReal @param {string} title */
const mark = (x, y, isReal, title) =>
    svg("g", {}, svg("title", {}, title), svg("line", { x1: x, x2: x, y1: y, y2: BOTTOM, class: "flight" }), svg("circle", { cx: x, cy: y, r: isReal ? 5 : 3.2, class: isReal ? "collision" : "collision null" }));

/** From distances and coefficients to the drawing. @param {number} end @param {number} most @param {number} [start] */
function scales(end, most, start = 0) {
    const x = (/** @type {number} */ t) => round(LEFT + ((RIGHT - LEFT) * (t - start)) / (end - start || 1));
    const y = (/** @type {number} */ sigma) => round(BOTTOM - (BOTTOM - TOP) * Math.min(1, sigma / (most || 1)));
    return { x, y, start, end, most };
}

/** @param {number} value */
const round = (value) => Math.round(value * 100) / 100;

/** @param {ReturnType<typeof scales>} axes @param {string} label @param {...(SVGElement | SVGElement[])} inside */
const plot = ({ start, end, most }, label, ...inside) =>
    svg("svg", { viewBox: "0 0 400 132", class: "figure density", role: "img", "aria-label": label },
        svg("line", { x1: LEFT, x2: RIGHT, y1: BOTTOM, y2: BOTTOM, class: "axis" }), svg("line", { x1: LEFT, x2: LEFT, y1: TOP - 6, y2: BOTTOM, class: "axis" }),
        ...inside,
        svg("text", { x: LEFT - 5, y: TOP + 4, class: "end" }, short(most, 3)), svg("text", { x: LEFT - 5, y: BOTTOM + 4, class: "end" }, "0"),
        svg("text", { x: LEFT, y: 127 }, short(start, 3)), svg("text", { x: RIGHT, y: 127, class: "end" }, short(end, 4)), svg("text", { x: LEFT + 6, y: TOP + 18 }, "σₜ"));
