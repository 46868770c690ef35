// What of a view a scene has: links and older versions of a file may name what is not there.

import { SCENES_OWN } from "./state.js";

/** @typedef {import("./protocol.js").Scene} Scene */
/** @typedef {import("./protocol.js").View} View */

/** Whether a scene has what a part of a view names. */
const NAMED = /** @type {Partial<Record<keyof View, (scene: Scene, value: any) => boolean>>} */ ({
    integrator: ({ integrators }, name) => integrators.includes(name),
    tonemap: ({ tonemaps }, name) => tonemaps.includes(name),
    layer: ({ layers }, word) => layers.some(({ name }) => name === word),
    variant: ({ variants }, name) => variants.includes(name),
    animation: ({ animations }, index) => index < animations.length,
    compare: ({ reference }) => reference !== null,
});

/**
 * The view without what the scene lacks, and the words for that.
 * @param {View} view
 * @param {Scene} scene
 * @returns {{view: View, absent: string[]}}
 */
export function possible(view, scene) {
    const keys = /** @type {(keyof View)[]} */ (Object.keys(NAMED)).filter((key) => view[key] !== SCENES_OWN[key] && !NAMED[key]?.(scene, view[key]));
    return { view: { ...view, ...Object.fromEntries(keys.map((key) => [key, SCENES_OWN[key]])) }, absent: keys.map((key) => `${key} ${view[key]}`) };
}
