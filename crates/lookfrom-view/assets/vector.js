// Vectors of three numbers.

/** @typedef {import("./protocol.js").Vector} Vector */

/** @type {(a: Vector, b: Vector) => Vector} */
export const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
/** @type {(a: Vector, b: Vector) => Vector} */
export const subtract = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
/** @type {(a: Vector, s: number) => Vector} */
export const scale = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
/** @type {(a: Vector, b: Vector) => number} */
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
/** @type {(a: Vector, b: Vector) => Vector} */
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
/** @type {(a: Vector) => number} */
export const length = (a) => Math.hypot(...a);
/** @type {(a: Vector) => Vector} */
export const unit = (a) => scale(a, 1 / (length(a) || 1));
/** @type {(a: Vector, b: Vector, t: number) => Vector} */
export const mix = (a, b, t) => add(scale(a, 1 - t), scale(b, t));

/**
 * A vector turned about a unit axis (Rodrigues 1840).
 * @type {(a: Vector, axis: Vector, angle: number) => Vector}
 */
export function rotate(a, axis, angle) {
    const [c, s] = [Math.cos(angle), Math.sin(angle)];
    return add(add(scale(a, c), scale(cross(axis, a), s)), scale(axis, dot(axis, a) * (1 - c)));
}
