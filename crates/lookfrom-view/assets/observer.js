// Where an observer stands to see the rays of a sample.

import { orbit, project, screenFromWorld } from "./camera.js";
import { isShadow } from "./rays.js";
import { add, cross, length, mix, scale, subtract, unit } from "./vector.js";

/** @typedef {import("./protocol.js").Camera} Camera */
/** @typedef {import("./protocol.js").Inspection} Inspection */
/** @typedef {import("./protocol.js").Vector} Vector */
/** Beside the scene, with the camera in sight; or near the camera, within the walls of a room. @typedef {"beside" | "near"} Place */

const FOV = 36;

/** The vertices of a sample, on surfaces and in media: where its rays end, but at lights and far away. @param {Inspection} inspection @returns {Vector[]} */
export const vertices = ({ segments }) => segments.filter((segment) => !isShadow(segment) && !segment.is_endless).map(({ to }) => to);

/**
 * @param {Inspection} inspection
 * @param {Camera} viewed The camera of the picture.
 * @param {[number, number]} size
 * @param {number} sceneSize
 * @param {Place} place
 * @returns {Camera}
 */
export function observer(inspection, viewed, size, sceneSize, place) {
    const eye = viewed.lookfrom;
    const ends = inspection.segments.map(({ to }) => to);
    const near = vertices(inspection);
    const points = place === "beside" ? [eye, ...ends] : near.length > 0 ? near : ends;
    /** @type {(pick: (...values: number[]) => number) => Vector} */
    const corner = (pick) => /** @type {Vector} */ ([0, 1, 2].map((i) => pick(...points.map((p) => p[i]))));
    const middle = mix(corner(Math.min), corner(Math.max), 0.5);
    const radius = Math.max(...points.map((p) => length(subtract(p, middle))), 1e-3 * sceneSize);
    if (place === "near") {
        // Not farther than the eye, which sees the first hit; a little to its side, so that the ray is not a point.
        const distance = Math.min(4 * radius, 0.9 * length(subtract(eye, middle)));
        const towards = add(middle, scale(unit(subtract(eye, middle)), distance));
        return orbit({ lookfrom: towards, lookat: middle, up: viewed.up, fov: FOV }, 0.45, 0.2);
    }
    const forward = unit(subtract(viewed.lookat, eye));
    const up = unit(viewed.up);
    const direction = unit(add(add(scale(unit(cross(forward, up)), 0.85), scale(up, 0.45)), scale(forward, -0.35)));
    return fitted(points, { lookfrom: add(middle, scale(direction, 3 * radius)), lookat: middle, up: viewed.up, fov: FOV }, size);
}

/** Nearer or farther until the outermost point is just inside; three steps are enough. @param {Vector[]} points @param {Camera} camera @param {[number, number]} size */
function fitted(points, camera, size) {
    for (let i = 0; i < 3; i++) {
        const matrix = screenFromWorld(camera, size);
        const outermost = Math.max(...points.map((p) => {
            const [x, y] = project(matrix, p);
            return Math.max(Math.abs((2 * x) / size[0] - 1), Math.abs((2 * y) / size[1] - 1));
        }));
        camera = { ...camera, lookfrom: mix(camera.lookat, camera.lookfrom, Math.max(0.05, outermost / 0.8)) };
    }
    return camera;
}

/**
 * The share of the vertices that an observer would have in sight, were nothing between: 1 for all.
 * @param {Inspection} inspection
 * @param {Camera} camera
 */
export function sight(inspection, camera) {
    const matrix = screenFromWorld(camera, [1, 1]);
    const points = vertices(inspection);
    const seen = points.filter((point) => {
        const [x, y, depth] = project(matrix, point);
        return depth > 0 && Math.abs(x - 0.5) < 0.9 && Math.abs(y - 0.5) < 0.5;
    });
    return points.length > 0 ? seen.length / points.length : 1;
}
