// Workers that render parts of the picture, each with the program, the files and the view of the first one.

/** The most workers together; each has the scene in its memory. */
const MOST = 8;
/** Longer scenes, in bytes of their files, are not held several times. */
const LONGEST = 2 ** 26;

/** A worker that has been told of an edition of the files, and of a view. @typedef {{worker: Worker, edition: number, view: string}} Helper */
/** What a helper has to know. @typedef {{edition: number, view: string, messages: () => any[]}} Shown */

/**
 * @param {() => Worker} create
 * @param {Promise<WebAssembly.Module>} module
 * @param {() => Shown} shown
 */
export function createHelpers(create, module, shown) {
    /** @type {Helper[]} */
    const idle = [];

    /** @returns {Promise<Helper>} */
    async function start() {
        const worker = create();
        const compiled = await module;
        await new Promise((resolve, reject) => {
            [worker.onmessage, worker.onerror] = [resolve, reject];
            worker.postMessage({ module: compiled });
        });
        worker.postMessage({ helps: true });
        return { worker, edition: -1, view: "" };
    }

    /** @param {Helper} helper @param {string} part @returns {Promise<ArrayBuffer>} */
    function rendered(helper, part) {
        const { edition, view, messages } = shown();
        const told = helper.edition === edition ? [] : messages();
        if (told.reduce((sum, { file }) => sum + (file?.bytes.length ?? 0), 0) > LONGEST) throw new Error("the scene is too large");
        if (told.length > 0 || helper.view !== view) told.push({ say: view });
        [helper.edition, helper.view] = [edition, view];
        return new Promise((resolve, reject) => {
            helper.worker.onmessage = ({ data }) => (data.film ? resolve(data.film) : reject(new Error(data.fault)));
            helper.worker.onerror = reject;
            for (const message of [...told, { render: part }]) helper.worker.postMessage(message);
        });
    }

    return {
        /** How many there may be. */
        count: () => Math.max(0, Math.min(MOST, navigator.hardwareConcurrency || 1) - 1),
        /** The film of a part; empty where that cannot be. @param {string} part */
        async render(part) {
            /** @type {Helper | undefined} */
            let helper;
            try {
                helper = idle.pop() ?? (await start());
                const film = await rendered(helper, part);
                idle.push(helper);
                return film;
            } catch {
                helper?.worker.terminate();
                return new ArrayBuffer(0);
            }
        },
    };
}
