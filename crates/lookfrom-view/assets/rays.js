// Rays on a picture: colour by kind, width by throughput; shadow rays; what is hidden behind geometry is dashed.

import { byId } from "./html.js";
import { luminance, mean } from "./format.js";
import { add, mix, scale } from "./vector.js";

/** @typedef {import("./protocol.js").Inspection} Inspection */
/** @typedef {import("./protocol.js").Ray} Ray */
/** @typedef {import("./protocol.js").Vector} Vector */

/**
 * @typedef {object} Drawing
 * @property {Inspection} inspection
 * @property {number | null} selected The address of the ray that is highlighted.
 * @property {(p: Vector) => [number, number, number]} project To x, y and the depth.
 * @property {boolean} isCameraRayShown
 * @property {number} farAway The length that endless rays are drawn with.
 * @property {(x: number, y: number, depth: number) => boolean} [isHidden]
 */

/** The kinds of rays with the names of their colours in style.css. */
export const KINDS = {
    camera: "camera",
    reflected: "reflected",
    refracted: "refracted",
    transmitted: "refracted",
    "straight on": "straight",
    scattered: "scattered",
};

/** @param {string} name */
export const color = (name) => getComputedStyle(byId("picture-overlay")).getPropertyValue(`--ray-${name}`).trim() || "#888";

/** @param {string} kind */
export const kindName = (kind) => /** @type {Record<string, string>} */ (KINDS)[kind] ?? "straight";

/** Where a ray ends: at its hit, or far away. @param {Ray} ray @param {number} farAway @returns {Vector} */
export function end(ray, farAway) {
    if (ray.met?.point) return ray.met.point;
    const size = Math.hypot(...ray.direction) || 1;
    return add(ray.a, scale(ray.direction, farAway / size));
}

/** @param {Ray} ray */
export const rayWidth = (ray) => 1.1 + 2.4 * Math.sqrt(Math.min(1, mean(ray.throughput)));

/** The shadow rays of a hit, with the light's contribution. @param {Ray} ray @returns {{shadow: import("./protocol.js").Shadow, added: number, light: string}[]} */
export function shadows(ray) {
    const sources = ray.light_sample ? [...ray.lights, ray.light_sample] : ray.lights;
    return sources.flatMap(({ shadow, added, light }) => (shadow ? [{ shadow, added: luminance(added.rgb), light }] : []));
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {Drawing} drawing
 */
export function drawRays(context, drawing) {
    const { inspection, selected, farAway } = drawing;
    context.lineCap = "round";
    // The selected ray is drawn last, above the others.
    const rays = [...inspection.rays].sort((a, b) => Number(a.address === selected) - Number(b.address === selected));
    for (const ray of rays) {
        const isSelected = ray.address === selected;
        context.globalAlpha = selected === null || isSelected ? 1 : 0.5;
        for (const { shadow, added } of shadows(ray)) drawShadow(context, drawing, shadow, added > 0, isSelected);
        if (ray.kind === "camera" && !drawing.isCameraRayShown) continue;
        drawLine(context, drawing, ray.a, end(ray, farAway), color(kindName(ray.kind)), rayWidth(ray) + (isSelected ? 1.5 : 0), isSelected);
    }
    context.globalAlpha = 1;
    for (const ray of rays) {
        if (!ray.met?.point) continue;
        const [x, y, depth] = drawing.project(ray.met.point);
        if (depth <= 0) continue;
        dot(context, x, y, ray.address === selected ? 4.5 : 3, color(kindName(ray.kind)));
    }
}

/**
 * A shadow ray: bright up to what blocks it, dark behind.
 * @param {CanvasRenderingContext2D} context
 * @param {Drawing} drawing
 * @param {import("./protocol.js").Shadow} shadow
 * @param {boolean} isLit
 * @param {boolean} isSelected
 */
function drawShadow(context, drawing, shadow, isLit, isSelected) {
    const blocker = shadow.blockers.find(({ passed }) => Math.max(...passed) === 0);
    const at = blocker?.point ?? null;
    const width = isSelected ? 2 : 1.1;
    if (isLit || !blocker) drawLine(context, drawing, shadow.from, shadow.to, color("shadow"), width, false);
    else if (at) {
        drawLine(context, drawing, shadow.from, at, color("shadow"), width, false);
        drawLine(context, drawing, at, shadow.to, color("blocked"), width, false);
    } else drawLine(context, drawing, shadow.from, shadow.to, color("blocked"), width, false);
    if (shadow.is_endless) return;
    const [x, y, depth] = drawing.project(shadow.to);
    if (depth > 0) dot(context, x, y, isSelected ? 4 : 2.5, isLit ? color("shadow") : color("blocked"));
}

/** @param {CanvasRenderingContext2D} context @param {number} x @param {number} y @param {number} radius @param {string} fill */
export function dot(context, x, y, radius, fill) {
    context.beginPath();
    context.arc(x, y, radius, 0, 2 * Math.PI);
    context.fillStyle = fill;
    context.fill();
    context.lineWidth = 1;
    context.strokeStyle = "#000a";
    context.stroke();
}

/**
 * A line of the world, with a dark edge so that it is seen on any picture; hidden parts are dashed.
 * @param {CanvasRenderingContext2D} context
 * @param {Pick<Drawing, "project" | "isHidden">} drawing
 * @param {Vector} from
 * @param {Vector} to
 * @param {string} stroke
 * @param {number} width
 * @param {boolean} [isSelected]
 */
export function drawLine(context, { project, isHidden }, from, to, stroke, width, isSelected = false) {
    const clipped = inFront(project, from, to);
    if (!clipped) return;
    const [[x0, y0, d0], [x1, y1, d1]] = clipped.map(project);
    const parts = isHidden ? Math.max(1, Math.min(400, Math.ceil(Math.hypot(x1 - x0, y1 - y0) / 3))) : 1;
    const state = (/** @type {number} */ s) => {
        // The reciprocal of the depth is linear on the screen.
        const depth = 1 / ((1 - s) / d0 + s / d1);
        return isHidden ? isHidden(x0 + s * (x1 - x0), y0 + s * (y1 - y0), depth) : false;
    };
    let start = 0;
    let hidden = state(0.5 / parts);
    for (let i = 1; i <= parts; i++) {
        const next = i < parts ? state((i + 0.5) / parts) : !hidden;
        if (next === hidden) continue;
        const at = (/** @type {number} */ s) => /** @type {[number, number]} */ ([x0 + s * (x1 - x0), y0 + s * (y1 - y0)]);
        segment(context, at(start / parts), at(i / parts), stroke, width, hidden, isSelected);
        [start, hidden] = [i, next];
    }
}

/** @param {CanvasRenderingContext2D} context @param {[number, number]} from @param {[number, number]} to @param {string} stroke @param {number} width @param {boolean} hidden @param {boolean} isSelected */
function segment(context, from, to, stroke, width, hidden, isSelected) {
    context.beginPath();
    context.moveTo(...from);
    context.lineTo(...to);
    context.setLineDash(hidden ? [2, 5] : []);
    if (!hidden) {
        context.lineWidth = width + 1.6;
        context.strokeStyle = isSelected ? "#fff" : "#0009";
        context.stroke();
    }
    context.lineWidth = hidden ? Math.min(width, 1.6) : width;
    context.strokeStyle = stroke;
    context.stroke();
    context.setLineDash([]);
}

/**
 * The part of a segment in front of the eye.
 * @param {(p: Vector) => [number, number, number]} project
 * @param {Vector} from
 * @param {Vector} to
 * @returns {[Vector, Vector] | null}
 */
function inFront(project, from, to) {
    const [a, b] = [project(from)[2], project(to)[2]];
    const near = 1e-3 * Math.max(Math.abs(a), Math.abs(b));
    if (a <= near && b <= near) return null;
    if (a > near && b > near) return [from, to];
    const cut = mix(from, to, (near - a) / (b - a));
    return a > near ? [from, cut] : [cut, to];
}
