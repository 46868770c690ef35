// The way to a worker of this page, in place of a server: the same messages, and the files of the scene.

import { createHelpers } from "./helpers.js";

/** @typedef {{path: string, bytes: Uint8Array<ArrayBuffer>}} File */

/**
 * @param {Promise<WebAssembly.Module>} module
 * @param {string} script The text of the worker's script.
 */
export function workerTransport(module, script) {
    const url = URL.createObjectURL(new Blob([script], { type: "text/javascript" }));
    /** @type {import("../../lookfrom-view/assets/socket.js").Events | null} */
    let events = null;
    /** @type {Worker | null} */
    let worker = null;
    let isOpen = false;
    /** @type {Map<string, File>} */
    let files = new Map();
    let [scene, reference] = ["", ""];
    /** The view that the page has asked for last, and how often the files have changed. */
    let [view, edition] = ["", 0];
    const messagesOfScene = () => [{ forget: true }, ...[...files.values()].map((file) => ({ file })), { open: { scene, reference } }];
    const helpers = createHelpers(() => new Worker(url), module, () => ({ edition, view, messages: messagesOfScene }));

    /** Starts a worker, in place of one that has ended. */
    async function start() {
        worker = new Worker(url);
        worker.onmessage = ({ data }) => {
            if (data === null) {
                isOpen = true;
                events?.opened();
                send({ idle: helpers.count() });
                if (scene) send(...messagesOfScene());
            } else if (data.lent) helpers.render(data.lent).then((film) => send({ part: data.lent, film }));
            else if (typeof data === "string" || data instanceof ArrayBuffer) events?.heard(data);
            else ended(data.fault);
        };
        worker.onerror = (event) => ended(event.message);
        try {
            worker.postMessage({ module: await module });
        } catch (error) {
            ended(String(error));
        }
    }

    /** @param {string} fault */
    function ended(fault) {
        worker?.terminate();
        [worker, isOpen] = [null, false];
        events?.closed();
        events?.heard(JSON.stringify({ type: "error", id: null, message: `internal error: this program has a fault (${fault}); please report it`, place: null, excerpt: null }));
    }

    /** @param {...object} messages */
    function send(...messages) {
        for (const message of messages) worker?.postMessage(message);
    }

    /** Shows the scene again, with these files new. @param {File[]} changed @param {boolean} isOther */
    function show(changed, isOther) {
        edition++;
        if (isOther) files = new Map();
        for (const file of changed) files.set(file.path, file);
        if (!worker) start();
        else if (isOpen) send(...(isOther ? [{ forget: true }] : []), ...changed.map((file) => ({ file })), { open: { scene, reference } });
    }

    return {
        /** @param {import("../../lookfrom-view/assets/socket.js").Events} told */
        open(told) {
            events = told;
            start();
        },
        /** @param {string} text */
        send(text) {
            if (text.startsWith('{"type":"view"')) view = text;
            send({ say: text });
        },
        isOpen: () => isOpen,
        whenLost: "The program has ended; open a scene, or reload the page",
        whenBroken: "Mend it under Scene, or drop the files that it lacks.",

        /** Opens a scene of these files. @param {string} path @param {File[]} of */
        openScene(path, of) {
            [scene, reference] = [path, ""];
            show(of, true);
        },
        /** Adds files to those of the scene, or replaces them. @param {File[]} changed */
        change: (changed) => show(changed, false),
        /** Compares with a picture. @param {File} picture */
        compareWith(picture) {
            reference = picture.path;
            show([picture], false);
        },
        /** The path of the scene that was opened last. */
        scene: () => scene,
        /** A file of the scene. @param {string} path */
        file: (path) => files.get(path),
        /** How many files the scene has. */
        count: () => files.size,
    };
}
