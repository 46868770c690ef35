// The other end of a hand-out: it answers questions about one pixel from what `lookfrom view --export` has asked before.

import { screenFromWorld } from "./camera.js";

/** @typedef {Record<string, any>} Message */

/**
 * What a hand-out holds: answers, as a server sends them.
 * @typedef {object} Kept
 * @property {[number, number]} pixel
 * @property {number} sample The one to show first.
 * @property {Message} scene
 * @property {Message} progress
 * @property {Message} picture The header of its frame.
 * @property {string} png The picture, in base64.
 * @property {Message} words
 * @property {Message} report
 * @property {Message} value
 * @property {Record<string, {inspection: Message, lobes: Record<string, Message>}>} samples
 * @property {string | null} source The text of the scene's file.
 */

/** A transparent PNG of one pixel, which stands for a view in space without surfaces. */
const NOTHING = "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNkYPhfDwAChwGA60e6kgAAAABJRU5ErkJggg==";

/** @param {string} base64 */
const bytes = (base64) => Uint8Array.from(atob(base64), (character) => character.charCodeAt(0));

/**
 * A binary message: the length of the header, the header, the payload.
 * @param {Message} header
 * @param {...Uint8Array<ArrayBuffer>} payload
 */
function frame(header, ...payload) {
    const text = new TextEncoder().encode(JSON.stringify(header));
    const length = new Uint8Array(new Uint32Array([text.length]).buffer);
    return new Blob([length, text, ...payload]).arrayBuffer();
}

/**
 * @param {Kept} kept
 * @returns {import("./socket.js").Transport}
 */
export function handoutTransport(kept) {
    /** @type {import("./socket.js").Events | null} */
    let events = null;

    /** @param {Message} asked @returns {Message | Promise<ArrayBuffer>} */
    function answer({ type, id, x, y, sample, depth, address, format, camera, size }) {
        const isPicked = x === kept.pixel[0] && y === kept.pixel[1];
        const held = isPicked ? kept.samples[sample] : undefined;
        const numbers = Object.keys(kept.samples).join(", ");
        if (type === "pixel" && isPicked) return kept.report;
        if (type === "value" && isPicked) return kept.value;
        if (type === "words") return kept.words;
        if (type === "lobe" && held?.lobes[address]) return held.lobes[address];
        if (type === "inspect") {
            if (held && depth === undefined) return held.inspection;
            throw new Error(held ? "A hand-out has no program that could trace another tree" : `This hand-out holds these samples: ${numbers}`);
        }
        if (type === "save" && format === "png") return frame({ kind: "file", id, name: "picture.png", mime: "image/png" }, bytes(kept.png));
        if (type === "space") {
            const [width, height] = size;
            const [picture, depths] = [bytes(NOTHING), new Uint8Array(new Float32Array(width * height).fill(Infinity).buffer)];
            return frame({ kind: "space", id, width, height, screen_from_world: screenFromWorld(camera, size), sizes: [picture.length, depths.length] }, picture, depths);
        }
        throw new Error("A hand-out has no answer to this");
    }

    /** @param {string} text */
    async function send(text) {
        const asked = JSON.parse(text);
        const { type, id } = asked;
        if (type === "pause") return;
        if (type === "view") {
            events?.heard(JSON.stringify({ ...kept.progress, view: id }));
            events?.heard(await frame({ ...kept.picture, view: id }, bytes(kept.png)));
            return;
        }
        // An answer comes after its question has been noted.
        await null;
        try {
            const found = await answer(asked);
            events?.heard(found instanceof ArrayBuffer ? found : JSON.stringify({ ...found, id }));
        } catch (error) {
            events?.heard(JSON.stringify({ type: "error", id, message: String(error instanceof Error ? error.message : error), excerpt: null }));
        }
    }

    return {
        open(given) {
            events = given;
            queueMicrotask(() => {
                given.opened();
                given.heard(JSON.stringify(kept.scene));
            });
        },
        send,
        isOpen: () => events !== null,
        whenLost: "",
        whenBroken: "",
    };
}
