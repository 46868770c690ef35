// Cameras that move: orbit, pan, dolly, fly; and the projection of points of the world onto their pictures.

import { add, cross, dot, length, rotate, scale, subtract, unit } from "./vector.js";

/** @typedef {import("./protocol.js").Camera} Camera */
/** @typedef {import("./protocol.js").Vector} Vector */

/** The steepest look up or down, so that `up` and `w` are never parallel. */
const STEEPEST = (89 * Math.PI) / 180;

/**
 * The axes of the lecture notes: u to the left of the picture, v up, w forward.
 * @param {Camera} camera
 */
export function axes({ lookfrom, lookat, up, is_mirrored }) {
    const w = unit(subtract(lookat, lookfrom));
    const left = unit(cross(up, w));
    return { u: is_mirrored ? scale(left, -1) : left, v: cross(w, left), w };
}

/** The sense in which a picture turns. @param {Camera} camera */
const sense = ({ is_mirrored }) => (is_mirrored ? -1 : 1);

/**
 * Turns the eye about `lookat`: by `yaw` about `up`, then by `pitch` up or down, both in radians.
 * @param {Camera} camera
 * @param {number} yaw
 * @param {number} pitch
 * @returns {Camera}
 */
export function orbit(camera, yaw, pitch) {
    const up = unit(camera.up);
    const back = rotate(subtract(camera.lookfrom, camera.lookat), up, sense(camera) * yaw);
    return { ...camera, lookfrom: add(camera.lookat, tilted(back, up, pitch)) };
}

/**
 * Turns the view about the eye, which stays.
 * @param {Camera} camera
 * @param {number} yaw
 * @param {number} pitch
 * @returns {Camera}
 */
export function look(camera, yaw, pitch) {
    const up = unit(camera.up);
    const forward = rotate(subtract(camera.lookat, camera.lookfrom), up, sense(camera) * yaw);
    return { ...camera, lookat: add(camera.lookfrom, tilted(forward, up, pitch)) };
}

/**
 * A vector turned towards `up` or away from it, not beyond the steepest angle.
 * @param {Vector} a
 * @param {Vector} up
 * @param {number} pitch
 */
function tilted(a, up, pitch) {
    const elevation = Math.asin(Math.max(-1, Math.min(1, dot(unit(a), up))));
    const wanted = Math.max(-STEEPEST, Math.min(STEEPEST, elevation + pitch));
    return rotate(a, unit(cross(a, up)), wanted - elevation);
}

/**
 * Moves eye and target along the axes of the camera, in units of their distance.
 * @param {Camera} camera
 * @param {number} left
 * @param {number} upwards
 * @param {number} [forward]
 * @returns {Camera}
 */
export function pan(camera, left, upwards, forward = 0) {
    const { u, v, w } = axes(camera);
    const distance = length(subtract(camera.lookat, camera.lookfrom));
    const move = scale(add(add(scale(u, left), scale(v, upwards)), scale(w, forward)), distance);
    return { ...camera, lookfrom: add(camera.lookfrom, move), lookat: add(camera.lookat, move) };
}

/**
 * Moves the eye towards its target: the distance is multiplied by `factor`.
 * @param {Camera} camera
 * @param {number} factor
 * @returns {Camera}
 */
export function dolly(camera, factor) {
    return { ...camera, lookfrom: add(camera.lookat, scale(subtract(camera.lookfrom, camera.lookat), factor)) };
}

/**
 * Moves eye and target by a length of the world.
 * @param {Camera} camera
 * @param {Vector} step left, up, forward
 * @returns {Camera}
 */
export function fly(camera, step) {
    const distance = length(subtract(camera.lookat, camera.lookfrom)) || 1;
    return pan(camera, step[0] / distance, step[1] / distance, step[2] / distance);
}

/**
 * The matrix from points of the world to pixels, x right and y down, before the division by w, which is the distance
 * along the view's axis.
 * @param {Camera} camera
 * @param {readonly [number, number]} size
 * @returns {number[]} 4 × 4, row-major
 */
export function screenFromWorld(camera, [width, height]) {
    const { u, v, w } = axes(camera);
    const eye = camera.lookfrom;
    const pixels = height / (2 * Math.tan((((camera.fov ?? 40) / 2) * Math.PI) / 180));
    /** @type {(a: Vector) => number[]} */
    const row = (a) => [...a, -dot(a, eye)];
    const [left, up, forward] = [row(u), row(v), row(w)];
    return [
        ...forward.map((f, i) => (f * width) / 2 - left[i] * pixels),
        ...forward.map((f, i) => (f * height) / 2 - up[i] * pixels),
        ...forward.map(() => 0),
        ...forward,
    ];
}

/**
 * A point on the screen: x, y in pixels, and w, the depth; w ≤ 0 is behind the eye.
 * @param {readonly number[]} m
 * @param {readonly number[]} p
 * @returns {[number, number, number]}
 */
export function project(m, p) {
    /** @type {(i: number) => number} */
    const row = (i) => m[i] * p[0] + m[i + 1] * p[1] + m[i + 2] * p[2] + m[i + 3];
    const w = row(12);
    return [row(0) / w, row(4) / w, w];
}
