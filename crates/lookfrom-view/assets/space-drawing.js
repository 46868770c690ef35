// What lies over the observer's picture: the camera with its image plane and axes, rays, normals and BSDF lobes.

import { axes } from "./camera.js";
import { color, dot, drawLine, drawRays } from "./rays.js";
import { add, length, scale, subtract } from "./vector.js";

/** @typedef {import("./protocol.js").Camera} Camera */
/** @typedef {import("./protocol.js").Lobe} Lobe */
/** @typedef {import("./protocol.js").Vector} Vector */
/** @typedef {import("./rays.js").Drawing & {camera: Camera, size: [number, number], sceneSize: number, lobe: Lobe | null}} SpaceDrawing */

/**
 * @param {CanvasRenderingContext2D} context
 * @param {SpaceDrawing} drawing
 */
export function drawSpace(context, drawing) {
    drawCamera(context, drawing);
    drawRays(context, drawing);
    drawNormal(context, drawing);
    if (drawing.lobe) drawLobe(context, drawing, drawing.lobe);
}

/** The frustum up to the image plane, and u, v, w. @param {CanvasRenderingContext2D} context @param {SpaceDrawing} drawing */
function drawCamera(context, drawing) {
    const { camera, size, sceneSize, inspection } = drawing;
    const { u, v, w } = axes(camera);
    const eye = camera.lookfrom;
    // Drawn at a size that is seen: the true image plane is at t = 1, and may be tiny or huge.
    const [first] = inspection.segments;
    const distance = Math.min(length(subtract(first.to, eye)) * 0.25, sceneSize * 0.12) || 1;
    if (camera.fov !== null) {
        const top = distance * Math.tan(((camera.fov / 2) * Math.PI) / 180);
        const side = (top * size[0]) / size[1];
        /** @type {(x: number, y: number) => Vector} */
        const corner = (x, y) => add(add(add(eye, scale(w, distance)), scale(u, -x * side)), scale(v, y * top));
        const corners = [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)];
        corners.forEach((p, i) => {
            drawLine(context, drawing, eye, p, color("frustum"), 1);
            drawLine(context, drawing, p, corners[(i + 1) % 4], color("frustum"), 1.4);
        });
        const [x, y] = inspection.pixel;
        const at = corner((2 * (x + 0.5)) / size[0] - 1, 1 - (2 * (y + 0.5)) / size[1]);
        const [px, py, depth] = drawing.project(at);
        if (depth > 0) dot(context, px, py, 2.5, color("camera"));
    }
    for (const [name, axis] of /** @type {[string, Vector][]} */ ([["u", u], ["v", v], ["w", w]])) {
        const tip = add(eye, scale(axis, distance * 0.7));
        arrow(context, drawing, eye, tip, color(`axis-${name}`), 1.6);
        label(context, drawing, tip, name, color(`axis-${name}`));
    }
}

/** @param {CanvasRenderingContext2D} context @param {SpaceDrawing} drawing */
function drawNormal(context, drawing) {
    const ray = drawing.inspection.rays.find(({ address }) => address === drawing.selected);
    if (!ray?.met) return;
    const tip = add(ray.met.point, scale(ray.met.n, lobeSize(drawing, ray.met.point) * 0.9));
    arrow(context, drawing, ray.met.point, tip, color("normal"), 1.6);
    label(context, drawing, tip, "n", color("normal"));
}

/** A length of the world that has the same size on the screen wherever it is. @param {SpaceDrawing} drawing @param {Vector} at */
const lobeSize = ({ project }, at) => 0.11 * Math.max(project(at)[2], 0);

/**
 * The BSDF times the cosine as a balloon around the point: its radius is the value in that direction.
 * @param {CanvasRenderingContext2D} context
 * @param {SpaceDrawing} drawing
 * @param {Lobe} lobe
 */
function drawLobe(context, drawing, { point, theta, phi, values, directions, chosen }) {
    const most = Math.max(...values);
    const size = lobeSize(drawing, point);
    if (most > 0) {
        // The cube root keeps what is faint visible beside a sharp peak.
        const tips = directions.map((direction, i) => drawing.project(add(point, scale(direction, size * Math.cbrt(Math.max(values[i], 0) / most)))));
        context.lineWidth = 0.8;
        context.fillStyle = color("lobe");
        context.strokeStyle = color("lobe");
        // A net of some dozen meshes is enough for the eye.
        const [down, around] = [Math.max(1, Math.round(theta / 12)), Math.max(1, Math.round(phi / 24))];
        for (let i = 0; i + 1 < theta; i += down) {
            const below = Math.min(i + down, theta - 1);
            for (let k = 0; k < phi; k += around) {
                const next = k + around < phi ? k + around : 0;
                const corners = [i * phi + k, i * phi + next, below * phi + next, below * phi + k];
                if (corners.every((corner) => !(values[corner] > 0))) continue;
                context.beginPath();
                corners.forEach((corner, n) => context[n === 0 ? "moveTo" : "lineTo"](tips[corner][0], tips[corner][1]));
                context.closePath();
                context.globalAlpha = 0.07;
                context.fill();
                context.globalAlpha = 0.4;
                context.stroke();
            }
        }
        context.globalAlpha = 1;
    }
    if (chosen) arrow(context, drawing, point, add(point, scale(chosen, size * 1.15)), color("lobe"), 2.4);
}

/** @param {CanvasRenderingContext2D} context @param {SpaceDrawing} drawing @param {Vector} from @param {Vector} to @param {string} stroke @param {number} width */
function arrow(context, drawing, from, to, stroke, width) {
    const [[x0, y0, d0], [x1, y1, d1]] = [drawing.project(from), drawing.project(to)];
    if (d0 <= 0 || d1 <= 0) return;
    drawLine(context, { project: drawing.project }, from, to, stroke, width);
    const angle = Math.atan2(y1 - y0, x1 - x0);
    context.beginPath();
    for (const turn of [0, 2.6, -2.6]) context.lineTo(x1 + 6 * Math.cos(angle + turn), y1 + 6 * Math.sin(angle + turn));
    context.fillStyle = stroke;
    context.fill();
}

/** @param {CanvasRenderingContext2D} context @param {SpaceDrawing} drawing @param {Vector} at @param {string} text @param {string} fill */
function label(context, drawing, at, text, fill) {
    const [x, y, depth] = drawing.project(at);
    if (depth <= 0) return;
    context.font = "italic 600 13px Georgia, serif";
    context.lineWidth = 3;
    context.strokeStyle = "#000a";
    context.strokeText(text, x + 6, y - 6);
    context.fillStyle = fill;
    context.fillText(text, x + 6, y - 6);
}
