// The view that the window asks for, with undo and redo.

/** @typedef {import("./protocol.js").View} View */

/** @type {View} */
export const SCENES_OWN = {
    camera: null,
    size: null,
    integrator: null,
    depth: null,
    samples: null,
    min_contribution: null,
    turn: null,
    rotate_environment: null,
    animation: null,
    at: null,
    variant: null,
    exposure: null,
    tonemap: null,
    denoise: null,
    layer: "color",
    compare: null,
};

/** The parts of a view that only develop the film anew. */
const DEVELOPMENT = new Set(["exposure", "tonemap", "denoise", "layer", "compare"]);

/** Whether two views have the same film. @param {View} a @param {View} b */
export const sameFilm = (a, b) =>
    Object.keys(SCENES_OWN).every((key) => DEVELOPMENT.has(key) || JSON.stringify(a[/** @type {keyof View} */ (key)]) === JSON.stringify(b[/** @type {keyof View} */ (key)]));

const MOST_UNDONE = 200;

export function viewState() {
    let view = { ...SCENES_OWN };
    /** The last view at rest, which undo returns to. */
    let rested = view;
    let lastKeys = "";
    let lastTime = 0;
    /** @type {View[]} */
    let undone = [];
    /** @type {View[]} */
    let done = [];
    /** @type {((view: View, moving: boolean) => void)[]} */
    const listeners = [];

    /** @param {View} next @param {boolean} moving */
    function show(next, moving) {
        view = next;
        if (!moving) rested = next;
        for (const listener of listeners) listener(view, moving);
    }

    return {
        get: () => view,
        /** @param {(view: View, moving: boolean) => void} listener */
        on: (listener) => void listeners.push(listener),
        /**
         * Changes parts of the view. While `moving`, nothing is remembered; quick changes of one control are one step.
         * @param {Partial<View>} change
         * @param {boolean} [moving]
         */
        set(change, moving = false) {
            const next = { ...view, ...change };
            if (!moving && JSON.stringify(next) !== JSON.stringify(rested)) {
                const keys = Object.keys(change).join();
                const isSameStep = keys === lastKeys && performance.now() - lastTime < 800;
                if (!isSameStep || done.length === 0) done = [...done.slice(-MOST_UNDONE), rested];
                [lastKeys, lastTime, undone] = [keys, performance.now(), []];
            }
            show(next, moving);
        },
        /** Starts from a view, without a past. @param {View} start */
        reset(start) {
            [done, undone] = [[], []];
            show(start, false);
        },
        undo() {
            const last = done.pop();
            if (!last) return false;
            undone.push(rested);
            lastKeys = "";
            show(last, false);
            return true;
        },
        redo() {
            const next = undone.pop();
            if (!next) return false;
            done.push(rested);
            show(next, false);
            return true;
        },
        canUndo: () => done.length > 0,
        canRedo: () => undone.length > 0,
    };
}
