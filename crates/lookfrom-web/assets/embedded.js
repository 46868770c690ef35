// What the page holds in itself, as compressed data: the program, and the scenes of the notes and the guide.

import { decompress } from "fzstd";

/** The bytes of a text in base64. @param {string} text */
function bytesOf(text) {
    const characters = atob(text);
    const bytes = new Uint8Array(characters.length);
    for (let i = 0; i < bytes.length; i++) bytes[i] = characters.charCodeAt(i);
    return bytes;
}

/** The bytes of an element of data, packed by Zstandard. @param {string} id */
function data(id) {
    const element = document.getElementById(id);
    const bytes = decompress(bytesOf(element?.textContent?.trim() ?? ""));
    element?.remove();
    return bytes;
}

/** The program. */
export const program = async () => WebAssembly.compile(data("program"));

/** The text of the worker's script. */
export const workerScript = () => document.getElementById("worker")?.textContent ?? "";

/**
 * A scene that the page holds.
 * @typedef {object} Example
 * @property {string} path
 * @property {string} title
 * @property {string} group
 */

/** The scenes that the page holds, with all of their files. */
export async function examples() {
    /** @type {{scenes: Example[], files: Record<string, string | [string]>}} */
    const { scenes, files } = JSON.parse(new TextDecoder().decode(data("scenes")));
    const utf8 = new TextEncoder();
    const contents = Object.entries(files).map(([path, content]) => ({ path, bytes: typeof content === "string" ? utf8.encode(content) : bytesOf(content[0]) }));
    return { scenes, files: contents };
}
