// The exercises of the course, one for each step of the notes, with the numbers of the selected pixel where there are any.

import { numbersOf } from "./candidates.js";
import { formula } from "./formula.js";
import { short } from "./format.js";
import { countOfRays } from "./lesson-generations.js";

/** @typedef {import("./app.js").App} App */
/** @typedef {import("./exercise.js").Exercise} Exercise */

/** @param {readonly number[]} p */
const written = (p) => `(${p.map((x) => short(x, 6)).join(", ")})`;

/** The test of the selected ray against a shape of this kind: the nearest, or the first. @param {App} app @param {string} kind */
function tested(app, kind) {
    const tests = (app.selectedRay()?.candidates ?? []).filter((candidate) => numbersOf(candidate).kind === kind);
    const chosen = tests.find(({ is_nearest }) => is_nearest) ?? tests[0];
    return chosen ? numbersOf(chosen).byName : null;
}

/** @returns {Exercise} */
export function ofGenerations() {
    const { rays } = countOfRays(3);
    return {
        question: ["At depth 3 every ray has met glass, which mirrors and refracts. How many rays has the tree, with the camera's own? And how many shadow rays, with two lights?"],
        answers: [["rays", rays], ["shadow rays", 2 * rays]],
        solution: "1 + 2 + 4 + 8 rays, and from each hit a shadow ray to each light.",
    };
}

/** @param {App} app @returns {Exercise | null} */
export function ofCamera(app) {
    const camera = app.inspection.get()?.camera;
    const step = camera?.steps.find(({ name }) => name === "S2");
    if (!camera || !step) return null;
    const [x, y, , w] = [...camera.p_k, 0, 1];
    const point = step.product.map((row) => row[0] * x + row[1] * y + row[3] * (w ?? 1));
    return {
        question: [`The selected sample is at `, formula("P_k"), ` = ${written([x, y])} in a picture of ${app.size().join(" × ")} pixels. Where is it after `, formula("S_2 · T_1"), ", on the image plane before the camera is turned? ", formula("h = 2 d tan(θ/2)"), `; θ is ${short(app.camera()?.fov ?? 0, 4)}°.`],
        answers: [["x", point[0]], ["y", point[1]]],
        solution: "x has changed its sign: u points to the viewer's left.",
    };
}

/** @param {App} app @returns {Exercise | null} */
export function ofExam(app) {
    const matrix = app.inspection.get()?.camera.steps.find(({ name }) => name === "R3")?.matrix;
    const camera = app.camera();
    if (!matrix || !camera) return null;
    const axes = ["u", "v", "w"];
    return {
        question: [`The question of the exam, for this camera: lookfrom = ${written(camera.lookfrom)}, lookat = ${written(camera.lookat)}, up = ${written(camera.up)}. What are the axes `, formula("w = (lookat − lookfrom) / |…|"), ", ", formula("u = (up × w) / |…|"), " and ", formula("v = w × u"), "?"],
        answers: axes.flatMap((axis, k) => ["x", "y", "z"].map((name, i) => /** @type {[string, number]} */ ([`${axis} ${name}`, matrix[i][k]]))),
        solution: "They are the columns of R3; with lookfrom at the origin, T4 is the identity, and M_vw is R3.",
    };
}

/** @param {App} app @returns {Exercise | null} */
export function ofTriangle(app) {
    const numbers = tested(app, "Triangle");
    if (!numbers) return null;
    const value = (/** @type {string} */ name) => Number(numbers[name].f64);
    return {
        question: ["Its determinants are ", ["D", "D1", "D2", "D3"].map((name) => `${name} = ${short(value(name), 6)}`).join(", "), ". What are β, γ, α and t?"],
        answers: [["β", value("D1") / value("D")], ["γ", value("D2") / value("D")], ["α", 1 - (value("D1") + value("D2")) / value("D")], ["t", value("D3") / value("D")]],
        solution: "Cramer's rule: one quotient each, and α is what is left of 1.",
    };
}

/** @param {App} app @returns {Exercise} */
export function ofSphere(app) {
    const numbers = tested(app, "Sphere");
    const [a, b, c] = numbers ? ["A", "B", "C"].map((name) => Number(numbers[name].f64)) : [1, -4, 15];
    const discriminant = b * b - a * c;
    const root = Math.sqrt(Math.max(discriminant, 0));
    const [near, far] = [(-b - root) / a, (-b + root) / a];
    return {
        question: [`With A = ${short(a, 7)}, B = ${short(b, 7)}, C = ${short(c, 7)}: what is B² − A C`, discriminant >= 0 ? ", and at which t > 0 is the ray first on the sphere?" : "?"],
        answers: discriminant >= 0 ? [["B² − A C", discriminant], ["t", near > 0 ? near : far]] : [["B² − A C", discriminant]],
        solution: discriminant >= 0 ? "Two roots; the smaller one that is positive counts." : "It is negative: there is no real root, the ray misses.",
    };
}

/** @returns {Exercise} */
export function ofTrap() {
    // t² + 2 · 5000 t + 1 = 0: both roots negative, the near one tiny.
    const [b, c] = [5000, 1];
    const q = -(b + Math.sqrt(b * b - c));
    return {
        question: ["A = 1, B = 5000, C = 1. With seven digits, B² − A C is 25,000,000 after rounding, and −B + √(B² − A C) is 0. What are q = −(B + √(B² − A C)) and ", formula("t_2 = C / q"), "?"],
        answers: [["q", q], ["t₂", c / q]],
        solution: "No two like numbers are subtracted: the numerator is rationalised.",
    };
}

/** @returns {Exercise} */
export function ofFresnel() {
    const degrees = (/** @type {number} */ radians) => (radians * 180) / Math.PI;
    return {
        question: ["Light goes from air (η = 1) into glass (η = 1.5) at θ₁ = 40°. What is θ₂ in degrees? And from which angle on is light inside of the glass reflected totally?"],
        answers: [["θ₂", degrees(Math.asin(Math.sin((40 * Math.PI) / 180) / 1.5))], ["the critical angle", degrees(Math.asin(1 / 1.5))]],
        solution: "Beyond sin θ = 1 / 1.5 there is no refracted ray.",
    };
}

/** @param {App} app @returns {Exercise | null} */
export function ofTree(app) {
    const inspection = app.inspection.get();
    if (!inspection || inspection.radiance.rgb.length < 3) return null;
    return {
        question: ["Add all contributions of the tree, from the table above. What is the sample's radiance, as red, green and blue?"],
        answers: ["red", "green", "blue"].map((name, i) => /** @type {[string, number]} */ ([name, Number(inspection.radiance.rgb[i])])),
        solution: "The pixel is the mean of such sums over its samples.",
    };
}
