// The exercise of the notes, done with the numbers of this camera, which is turned by hand; and why there is no perspective transformation.

import { axes, look } from "./camera.js";
import { draggable } from "./drag.js";
import { display, formula, matrix } from "./formula.js";
import { h, replace, svg } from "./html.js";
import { exact, point, short } from "./format.js";
import { noPixel } from "./no-pixel.js";

/** @typedef {import("./protocol.js").Camera} Camera */
/** @typedef {import("./protocol.js").Vector} Vector */

/** The eye of the exercise. @type {Camera} */
const EXERCISE = { lookfrom: [0, 0, 0], lookat: [0, 0, 1], up: [0, 1, 0], fov: 60 };
/** The origin in the figure, the length of an axis, and where the axes of the world go: the figure is seen from between them. */
const [X, Y, UNIT] = [150, 120, 74];
const WORLD = [[0.8, 0.4], [0, -0.9], [-0.8, 0.4]];

/** The relative error within which two numbers are the same one. */
const NEAR = 1e-9;

/** @param {number[][]} a @param {number[][]} b */
const product = (a, b) => a.map((row) => b[0].map((_, k) => row.reduce((sum, x, i) => sum + x * b[i][k], 0)));

/** R3 and T4 of a camera. @param {Camera} camera */
function matrices(camera) {
    const { u, v, w } = axes(camera);
    const [x, y, z] = camera.lookfrom;
    return {
        R3: [...[0, 1, 2].map((i) => [u[i], v[i], w[i], 0]), [0, 0, 0, 1]],
        T4: [[1, 0, 0, x], [0, 1, 0, y], [0, 0, 1, z], [0, 0, 0, 1]],
    };
}

/** @param {import("./app.js").App} app */
export function exerciseLesson(app) {
    let camera = EXERCISE;
    const figure = svg("svg", { viewBox: "0 0 300 185", class: "figure dial", role: "slider", tabindex: "0", "aria-label": "Direction of the camera", "aria-valuenow": 0 });
    const body = h("div");
    const element = h("div", { id: "exercise" },
        h("p", {}, "Let the eye be at the origin, ", formula("d = 1"), ", lookat = (0, 0, d) and up = (0, 1, 0). Show that the matrix from view to world, ", formula("M_vw = T_4 · R_3"), ", is the identity."),
        h("button", { type: "button", onclick: () => app.view.set({ camera: { ...EXERCISE, fov: app.camera()?.fov ?? EXERCISE.fov } }) }, "Look from there"),
        h("p", {}, "Then turn the camera: drag w, or use the arrow keys. Where u, v and w lie on the axes of the world, ", formula("R_3"), " is the identity."),
        figure, body);
    draggable(figure, {
        // The tip follows the hand where w points towards who looks at the figure, and goes against it behind.
        to: (_x, _y, right, down) => turn(((axes(camera).w.reduce((sum, c) => sum + c) < 0 ? -1 : 1) * right) / UNIT, -down / UNIT, true),
        by: (right, up) => turn((right * Math.PI) / 36, (up * Math.PI) / 36, true),
        rest: () => app.view.set({ camera }),
    });
    return { element, show };

    /** @param {number} yaw @param {number} pitch @param {boolean} moving */
    function turn(yaw, pitch, moving) {
        camera = look(camera, yaw, pitch);
        app.view.set({ camera }, moving);
        const { R3, T4 } = matrices(camera);
        draw(R3, T4);
    }

    function show() {
        const { lookfrom, lookat, up, fov } = app.camera() ?? EXERCISE;
        camera = { lookfrom, lookat, up, fov };
        const own = matrices(camera);
        // The program's numbers, once they are those of this camera.
        const told = (/** @type {"R3" | "T4"} */ wanted) => {
            const step = app.inspection.get()?.camera.steps.find(({ name }) => name === wanted)?.matrix;
            return step?.every((row, i) => row.every((x, k) => Math.abs(x - own[wanted][i][k]) < NEAR * Math.max(1, Math.abs(x)))) ? step : own[wanted];
        };
        draw(told("R3"), told("T4"));
    }

    /** @param {number[][]} R3 @param {number[][]} T4 */
    function draw(R3, T4) {
        drawAxes(figure, R3);
        const M = product(T4, R3);
        const isIdentity = M.every((row, i) => row.every((x, k) => x === (i === k ? 1 : 0)));
        const text = (/** @type {number[][]} */ m) => matrix(m.map((row) => row.map((x) => short(x, 4))));
        replace(body,
            h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "T4 times R3" }, display("M_vw = ", text(T4), text(R3)), display("= ", text(M))),
            h("p", { class: isIdentity ? "verdict good" : "verdict", role: "status", id: "exercise-verdict" }, isIdentity ? "M_vw = I: every one of its sixteen numbers is exactly 0 or 1." : "With this camera M_vw is not the identity: its columns are u, v, w and lookfrom."),
            h("p", {}, "The columns of ", formula("R_3"), " are ", formula("u = up × w"), ", to the viewer's left, ", formula("v = w × u"), " and ", formula("w"), ", forward. Only T4 · R3 is the identity; T1 and S2 still turn pixels into lengths."),
            perspective(app));
    }
}

/**
 * The axes of the camera in those of the world.
 * @param {SVGSVGElement} figure
 * @param {number[][]} R3
 */
function drawAxes(figure, R3) {
    const flat = (/** @type {number[]} */ p) => [0, 1].map((k) => [X, Y][k] + UNIT * p.reduce((sum, c, i) => sum + c * WORLD[i][k], 0));
    /** @param {string} name @param {number[]} axis @param {string} kind */
    const arrow = (name, axis, kind) => {
        const [x, y] = flat(axis);
        // The name stands beyond the tip.
        const beyond = 14 / Math.max(1, Math.hypot(x - X, y - Y));
        return [svg("line", { x1: X, y1: Y, x2: x, y2: y, class: kind }), svg("text", { x: x + (x - X) * beyond, y: y + (y - Y) * beyond + 4, class: "middle" }, name)];
    };
    const column = (/** @type {number} */ k) => R3.slice(0, 3).map((row) => row[k]);
    const [x, y] = flat(column(2));
    replace(figure,
        ["x", "y", "z"].flatMap((name, i) => arrow(name, [0, 1, 2].map((k) => (i === k ? 1.35 : 0)), "axis")),
        ["u", "v", "w"].flatMap((name, k) => arrow(name, column(k), `camera-axis ${name}`)),
        svg("circle", { cx: x, cy: y, r: 6, class: "handle" }));
    figure.setAttribute("aria-valuenow", ((Math.atan2(R3[0][2], R3[2][2]) * 180) / Math.PI).toFixed(1));
    figure.setAttribute("aria-valuetext", `w = ${point(column(2), 3)}`);
}

/** Why no perspective transformation, with the numbers of the selected ray. @param {import("./app.js").App} app */
function perspective(app) {
    const inspection = app.inspection.get();
    if (!inspection) return noPixel();
    const { a, b, direction } = inspection.camera;
    const met = inspection.rays[0]?.met;
    return [
        h("h4", {}, "Why no perspective transformation?"),
        h("p", {}, "Because every ray starts at the eye and fans out through its pixel. The division by depth that a matrix of projection does is in the ray:"),
        display("p(t) = a + t (b − a)"),
        h("p", {}, `Here a = ${point(a)} and b = ${point(b)}, so b − a = ${point(direction)}. At t = 1 the ray is on the image plane`,
            met ? `; it meets ${met.shape} at t = ${exact(met.t)}: there, everything is ${short(met.t, 4)} times as far from the axis as on the image plane. To put that point into its pixel is to divide by ${short(met.t, 4)}.` : ", and it meets nothing."),
    ];
}
