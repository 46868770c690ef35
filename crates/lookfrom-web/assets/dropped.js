// Files that a person drops on the page or chooses: which of them is the scene, and what the others are.

import { unzip } from "./zip.js";

/** @typedef {import("./worker-transport.js").File} File */

// By rank; the extensions are those of crates/lookfrom-scene/src/format.rs.
const SCENES = [/\.toml$/i, /\.pbrt(\.gz)?$/i, /\.xml$/i, /\.(glb|gltf)$/i, /\.(obj|ply|stl|hair)(\.gz)?$/i, /\.n?vdb$/i];
const XML = /\.xml$/i;
const PICTURE = /\.(exr|hdr|pfm|png|jpe?g|webp|gif|bmp|tga|tiff?)$/i;

/** Whether a file is a picture. @param {string} path */
export const isPicture = (path) => PICTURE.test(path);

/** How deep a file is in folders. @param {string} path */
const depth = (path) => path.split("/").length;

/** Whether a file may be a scene: much is written in XML, and Mitsuba's scenes begin with an element of that name. @param {File} file */
const mayBeScene = ({ path, bytes }) => !XML.test(path) || new TextDecoder().decode(bytes.subarray(0, 1 << 16)).includes("<scene");

/**
 * The scene among files: own format before pbrt's before Mitsuba's before models before volumes, the least deep first.
 * @param {File[]} files
 */
export function sceneOf(files) {
    for (const kind of SCENES) {
        const found = files.filter((file) => kind.test(file.path) && mayBeScene(file)).sort((a, b) => depth(a.path) - depth(b.path) || (a.path < b.path ? -1 : 1));
        if (found.length > 0) return found[0].path;
    }
    return null;
}

/** A file of the browser, or the files of an archive. @param {globalThis.File} file @param {string} [path] */
async function read(file, path = file.webkitRelativePath || file.name) {
    const bytes = new Uint8Array(await file.arrayBuffer());
    return /\.zip$/i.test(path) ? unzip(bytes) : [{ path, bytes }];
}

/** All files below an entry of what was dropped. @param {FileSystemEntry} entry @returns {Promise<File[]>} */
async function below(entry) {
    const path = entry.fullPath.replace(/^\//, "");
    if (entry.isFile) return read(await new Promise((resolve, reject) => /** @type {FileSystemFileEntry} */ (entry).file(resolve, reject)), path);
    const reader = /** @type {FileSystemDirectoryEntry} */ (entry).createReader();
    /** @type {File[]} */
    const files = [];
    for (;;) {
        // A reader tells some entries at a time.
        const entries = await new Promise((resolve, reject) => reader.readEntries(resolve, reject));
        if (entries.length === 0) return files;
        for (const inner of entries) files.push(...(await below(inner)));
    }
}

/**
 * Files and folders that were dropped.
 * @param {DataTransfer} transfer
 * @returns {Promise<File[]>}
 */
export async function filesOfDrop(transfer) {
    // The list is empty once this function waits.
    const items = [...transfer.items].filter(({ kind }) => kind === "file");
    const entries = items.map((item) => item.webkitGetAsEntry() ?? item.getAsFile());
    const files = await Promise.all(entries.map((entry) => (entry instanceof File ? read(entry) : entry ? below(entry) : [])));
    return files.flat();
}

/** Files that were chosen. @param {FileList} list @returns {Promise<File[]>} */
export const filesOfList = async (list) => (await Promise.all([...list].map((file) => read(file)))).flat();
