// A value that tells its listeners when it changes.

/**
 * @template T
 * @typedef {object} Signal
 * @property {() => T} get
 * @property {(value: T) => void} set
 * @property {(listener: (value: T) => void) => void} on Called at each change, not at once.
 */

/**
 * @template T
 * @param {T} value
 * @returns {Signal<T>}
 */
export function signal(value) {
    /** @type {((value: T) => void)[]} */
    const listeners = [];
    return {
        get: () => value,
        set(next) {
            if (Object.is(next, value)) return;
            value = next;
            for (const listener of listeners) listener(value);
        },
        on: (listener) => void listeners.push(listener),
    };
}
