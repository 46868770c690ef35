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
    /** @type {(keyof View)[]} */ (Object.keys(SCENES_OWN)).every((key) => DEVELOPMENT.has(key) || same(a[key], b[key]));

/** @param {unknown} a @param {unknown} b */
const same = (a, b) => JSON.stringify(a) === JSON.stringify(b);

/**
 * The way back from a view that is refused: what it has changed of an accepted one, all other changes stay. Null where it has changed nothing.
 * @param {View} refused
 * @param {View} accepted
 * @returns {((view: View) => View) | null} Views without the whole change are returned as they are.
 */
export function returned(refused, accepted) {
    const keys = /** @type {(keyof View)[]} */ (Object.keys(SCENES_OWN)).filter((key) => !same(refused[key], accepted[key]));
    if (keys.length === 0) return null;
    const before = Object.fromEntries(keys.map((key) => [key, accepted[key]]));
    return (view) => (keys.every((key) => same(view[key], refused[key])) ? { ...view, ...before } : view);
}

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
            if (!moving && !same(next, rested)) {
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
        /**
         * Changes the view, and those that undo and redo return to: no step that could be undone.
         * @param {(view: View) => View} change
         */
        revise(change) {
            const isMoving = view !== rested;
            lastKeys = "";
            [done, undone, rested] = [done.map(change), undone.map(change), change(rested)];
            // Steps that would lead to what is shown anyway.
            while (done.length > 0 && same(done.at(-1), rested)) done.pop();
            while (undone.length > 0 && same(undone.at(-1), rested)) undone.pop();
            show(isMoving ? change(view) : rested, isMoving);
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
