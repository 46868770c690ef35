// Rays on a picture: the segments of an inspection, projected; what is hidden behind geometry is dashed.

import { byId } from "./html.js";
import { add, length, mix, scale } from "./vector.js";

/** @typedef {import("./protocol.js").Inspection} Inspection */
/** @typedef {import("./protocol.js").Segment} Segment */
/** @typedef {import("./protocol.js").Vector} Vector */

/**
 * @typedef {object} Drawing
 * @property {Inspection} inspection
 * @property {number | null} selected The address of the ray that is highlighted.
 * @property {(p: Vector) => [number, number, number]} project To x, y and the depth.
 * @property {boolean} isCameraRayShown
 * @property {(x: number, y: number, depth: number) => boolean} [isHidden]
 */

/** The colour of a kind of ray, or of another mark, from style.css. @param {string} name */
export const color = (name) => getComputedStyle(byId("picture-overlay")).getPropertyValue(`--ray-${name.replace(" ", "-")}`).trim() || "#888";

/** @param {Segment} segment */
export const isShadow = ({ kind }) => kind === "shadow" || kind === "blocked";

/** The lines of rays by their addresses, without those of shadow rays. @param {Inspection} inspection @returns {Map<number, Segment>} */
export const linesOfRays = ({ segments }) => new Map(segments.filter((segment) => !isShadow(segment)).map((segment) => [segment.address, segment]));

/**
 * @param {CanvasRenderingContext2D} context
 * @param {Drawing} drawing
 */
export function drawRays(context, drawing) {
    const { inspection, selected } = drawing;
    context.lineCap = "round";
    // The selected ray is drawn last, above the others.
    const segments = [...inspection.segments].sort((a, b) => Number(a.address === selected) - Number(b.address === selected));
    for (const segment of segments) {
        if (segment.kind === "camera" && !drawing.isCameraRayShown) continue;
        const isSelected = segment.address === selected;
        context.globalAlpha = selected === null || isSelected ? 1 : 0.5;
        drawLine(context, drawing, segment.from, segment.to, color(segment.kind), segment.width + (isSelected ? 1.5 : 0), isSelected && !isShadow(segment));
    }
    context.globalAlpha = 1;
    const inMedia = new Set(inspection.rays.filter(({ flight, tracking }) => flight?.scattered_at || tracking?.scattered_at).map(({ address }) => address));
    for (const segment of segments) {
        if (segment.is_endless) continue;
        const [x, y, depth] = drawing.project(segment.to);
        if (depth <= 0) continue;
        const radius = (isShadow(segment) ? 2.5 : 3) * (segment.address === selected ? 1.5 : 1);
        if (!isShadow(segment) && inMedia.has(segment.address)) diamond(context, x, y, 1.7 * radius, color(segment.kind));
        else dot(context, x, y, radius, color(segment.kind));
    }
    drawNullCollisions(context, drawing);
}

/** Where the selected ray collided with a medium and went on: rings. @param {CanvasRenderingContext2D} context @param {Drawing} drawing */
function drawNullCollisions(context, { inspection, selected, project }) {
    const ray = inspection.rays.find(({ address }) => address === selected);
    for (const { t, is_real: isReal } of ray?.tracking?.collisions ?? []) {
        if (isReal || !ray) continue;
        const [x, y, depth] = project(add(ray.a, scale(ray.direction, t / length(ray.direction))));
        if (depth <= 0) continue;
        context.beginPath();
        context.arc(x, y, 3, 0, 2 * Math.PI);
        context.lineWidth = 1.6;
        context.strokeStyle = color(ray.kind);
        context.stroke();
    }
}

/** The mark of a point of a medium. @param {CanvasRenderingContext2D} context @param {number} x @param {number} y @param {number} radius @param {string} fill */
function diamond(context, x, y, radius, fill) {
    context.beginPath();
    for (const [dx, dy] of [[0, -1], [1, 0], [0, 1], [-1, 0]]) context.lineTo(x + radius * dx, y + radius * dy);
    context.closePath();
    context.fillStyle = fill;
    context.fill();
    context.lineWidth = 1;
    context.strokeStyle = "#fff";
    context.stroke();
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
