// The scene in the page's link: the path of one that the page holds, or the text of another, compressed.

import { deflated, inflated } from "./zip.js";

/** The longest part of a link that a scene may take, in characters. */
const LONGEST = 8192;

/** @typedef {{example: string} | {path: string, text: string} | {absent: string}} Linked */

/** What the link says of a scene that the page holds. @param {string} path */
export const ofExample = (path) => `scene=${path}`;

/**
 * What the link says of a scene of one file: its text if that is short enough, or only its name.
 * @param {string} path
 * @param {Uint8Array<ArrayBuffer>} bytes
 * @param {boolean} isWhole Whether it needs no other files.
 */
export async function ofText(path, bytes, isWhole) {
    const name = encodeURIComponent(path.split("/").at(-1) ?? path);
    if (isWhole) {
        const packed = btoa(String.fromCharCode(...(await deflated(bytes, "deflate-raw")).subarray(0, LONGEST)));
        const text = packed.replace(/\+/g, "-").replace(/\//g, "_").replace(/=+$/, "");
        if (text.length <= LONGEST) return `name=${name}&text=${text}`;
    }
    return `dropped=${name}`;
}

/**
 * What a fragment says of the scene.
 * @param {string} fragment
 * @returns {Promise<Linked | null>}
 */
export async function linked(fragment) {
    const parameters = new URLSearchParams(fragment.replace(/^#/, ""));
    const [example, name, text, absent] = ["scene", "name", "text", "dropped"].map((key) => parameters.get(key));
    if (example) return { example };
    if (absent) return { absent };
    if (!text) return null;
    try {
        const packed = Uint8Array.from(atob(text.replace(/-/g, "+").replace(/_/g, "/")), (character) => character.charCodeAt(0));
        return { path: name ?? "scene.toml", text: new TextDecoder().decode(await inflated(packed, "deflate-raw")) };
    } catch {
        return null;
    }
}
