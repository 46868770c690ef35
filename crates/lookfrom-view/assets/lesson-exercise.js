// The exercise of the notes, done with the numbers of this camera; and why there is no perspective transformation.

import { display, formula, matrix } from "./formula.js";
import { h, replace } from "./html.js";
import { exact, point, short } from "./format.js";
import { noPixel } from "./no-pixel.js";

/** The eye of the exercise. @type {import("./protocol.js").Camera} */
const EXERCISE = { lookfrom: [0, 0, 0], lookat: [0, 0, 1], up: [0, 1, 0], fov: 60 };

/** @param {number[][]} a @param {number[][]} b */
const product = (a, b) => a.map((row) => b[0].map((_, k) => row.reduce((sum, x, i) => sum + x * b[i][k], 0)));

/** @param {import("./app.js").App} app */
export function exerciseLesson(app) {
    const element = h("div", { id: "exercise" });
    return { element, show };

    function show() {
        const inspection = app.inspection.get();
        const task = [
            h("p", {}, "Let the eye be at the origin, ", formula("d = 1"), ", lookat = (0, 0, d) and up = (0, 1, 0). Show that the matrix from view to world, ", formula("M_vw = T_4 · R_3"), ", is the identity."),
            h("button", { type: "button", onclick: () => app.view.set({ camera: { ...EXERCISE, fov: app.camera()?.fov ?? EXERCISE.fov } }) }, "Look from there"),
        ];
        const step = (/** @type {string} */ wanted) => inspection?.camera.steps.find(({ name }) => name === wanted)?.matrix;
        const [R3, T4] = [step("R3"), step("T4")];
        if (!inspection || !R3 || !T4) return replace(element, task, noPixel());
        const M = product(T4, R3);
        const isIdentity = M.every((row, i) => row.every((x, k) => x === (i === k ? 1 : 0)));
        const text = (/** @type {number[][]} */ m) => matrix(m.map((row) => row.map((x) => short(x, 4))));
        const { a, b, direction } = inspection.camera;
        const met = inspection.rays[0]?.met;
        replace(element, task,
            h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "T4 times R3" }, display("M_vw = ", text(T4), text(R3), "=", text(M))),
            h("p", { class: isIdentity ? "verdict good" : "verdict", role: "status", id: "exercise-verdict" }, isIdentity ? "M_vw = I: every one of its sixteen numbers is exactly 0 or 1." : "With this camera M_vw is not the identity: its columns are u, v, w and lookfrom."),
            h("p", {}, "The columns of ", formula("R_3"), " are ", formula("u = up × w"), ", to the viewer's left, ", formula("v = w × u"), " and ", formula("w"), ", forward. Only T4 · R3 is the identity; T1 and S2 still turn pixels into lengths."),
            h("h4", {}, "Why no perspective transformation?"),
            h("p", {}, "Because every ray starts at the eye and fans out through its pixel. The division by depth that a matrix of projection does is in the ray:"),
            display("p(t) = a + t (b − a)"),
            h("p", {}, `Here a = ${point(a)} and b = ${point(b)}, so b − a = ${point(direction)}. At t = 1 the ray is on the image plane`,
                met ? `; it meets ${met.shape} at t = ${exact(met.t)}: there, everything is ${short(met.t, 4)} times as far from the axis as on the image plane. To put that point into its pixel is to divide by ${short(met.t, 4)}.` : ", and it meets nothing."));
    }
}
