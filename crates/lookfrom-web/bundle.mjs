// One file of the page: node bundle.mjs PROGRAM FOLDER
//
// A page that is opened as a file may load nothing: so scripts, styles and the program are in index.html. Its content security policy
// names the scripts by their hashes, and allows no connection at all.

import { execFileSync } from "node:child_process";
import { createHash } from "node:crypto";
import { mkdir, readFile, readdir, writeFile } from "node:fs/promises";
import { dirname, join, relative } from "node:path";
import { fileURLToPath } from "node:url";
import { brotliCompressSync, constants, gzipSync } from "node:zlib";
import { build } from "esbuild";

const here = dirname(fileURLToPath(import.meta.url));
const root = join(here, "../..");
const view = join(root, "crates/lookfrom-view/assets");
const [program, folder] = process.argv.slice(2);

/** One script of a module and those that it imports. */
async function script(entry) {
    const { outputFiles } = await build({ entryPoints: [join(here, "assets", entry)], bundle: true, minify: true, format: "esm", target: "es2022", write: false, charset: "utf8", legalComments: "none" });
    return outputFiles[0].text.trim();
}

/** Data as text, packed by Zstandard: a quarter smaller than by gzip. Its size is told, else unpacking copies whole windows. */
function data(content) {
    const bytes = Buffer.from(content);
    const packed = execFileSync("zstd", ["--ultra", "-22", "--quiet", "--stdout", `--stream-size=${bytes.length}`], { input: bytes, maxBuffer: 2 ** 28 });
    return packed.toString("base64");
}

/** All files below folders, by their paths from the root. */
async function filesIn(...folders) {
    const files = [];
    for (const folder of folders) {
        const found = await readdir(join(root, folder), { recursive: true, withFileTypes: true });
        files.push(...found.filter((entry) => entry.isFile()).map((entry) => relative(root, join(entry.parentPath, entry.name))));
    }
    return files.sort();
}

/** Words of a guide as comments of a scene, in lines that the editor shows whole. */
const comments = (words) => words.replace(/\[([^\]]*)\]\([^)]*\)/g, "$1").trim().split(/\n\n+/)
    .map((paragraph) => [...paragraph.replace(/\s+/g, " ").matchAll(/(.{1,56})(?: |$)/g)].map(([, line]) => `# ${line}`).join("\n")).join("\n#\n");

/** The tutorial as a path through the editor: after each of its blocks the scene so far, with its words as comments. */
async function tutorial() {
    const guide = await readFile(join(root, "docs/guide/tutorial.md"), "utf8");
    const steps = [];
    let whole = "";
    for (const section of guide.split(/^## /m).slice(1)) {
        const [words, ...blocks] = section.split("```toml\n");
        const [title, ...introduction] = words.split("\n");
        let before = introduction.join("\n");
        for (const [index, block] of blocks.entries()) {
            const [scene, after] = block.split("```\n");
            whole += `${whole && "\n"}${index === 0 ? `# ${title}\n#\n` : ""}${comments(before)}\n\n${scene}`;
            before = after;
        }
        // The first has no shape yet.
        if (blocks.length > 0 && whole.includes("[[")) steps.push({ path: `tutorial/${steps.length + 1}.toml`, title: `${steps.length + 1}. ${title}`, text: whole });
    }
    return steps;
}

/** The scenes, each with a title and its group, and all files that they may name. */
async function scenes() {
    const paths = (await filesIn("scenes", "docs/guide/scenes")).filter((path) => /\.(toml|pbrt|obj|ply|png|hdr|ies|ttf|gltf|bin|jpg|ktx2)$/.test(path));
    const files = {};
    for (const path of paths) {
        const bytes = await readFile(join(root, path));
        const text = bytes.toString("utf8");
        // What is no text is the only element of a list.
        files[path] = Buffer.from(text).equals(bytes) ? text : [bytes.toString("base64")];
    }
    const titled = (path, group, prefix) => ({ path, group, title: path.slice(prefix.length).replace(/\.(toml|pbrt)$/, "").replaceAll("-", " ") });
    const shown = [["scenes/", "Scenes"], ["docs/guide/scenes/", "Guide"]].flatMap(([prefix, group]) =>
        paths.filter((path) => path.startsWith(prefix) && /^[^/]+\.(toml|pbrt)$/.test(path.slice(prefix.length))).map((path) => titled(path, group, prefix)));
    for (const { path, title, text } of await tutorial()) {
        files[path] = text;
        shown.push({ path, group: "Tutorial: a still life", title });
    }
    const first = shown.find(({ path }) => path.endsWith("/notes-exercise.toml"));
    return JSON.stringify({ scenes: [first, ...shown.filter((scene) => scene !== first)], files });
}

const source = (text) => `'sha256-${createHash("sha256").update(text).digest("base64")}'`;
const [main, worker] = await Promise.all([script("main.js"), script("worker.js")]);
const css = await Promise.all([...["style", "panels", "figures"].map((name) => join(view, `${name}.css`)), join(here, "assets/style.css")].map((path) => readFile(path, "utf8")));
const style = css.join("\n");
const icon = `data:image/svg+xml;base64,${(await readFile(join(view, "icon.svg"))).toString("base64")}`;
const policy = `default-src 'none'; script-src ${source(main)} 'wasm-unsafe-eval'; worker-src blob:; style-src ${source(style)}; img-src blob: data:; connect-src 'none'; base-uri 'none'; form-action 'none'`;

const page = await readFile(join(view, "index.html"), "utf8");
const head = `<meta http-equiv="Content-Security-Policy" content="${policy}">
    <link rel="icon" href="${icon}">
    <style>${style}</style>`;
const end = `<script type="text/plain" id="worker">${worker}</script>
<script type="text/plain" id="scenes">${data(await scenes())}</script>
<script type="text/plain" id="program">${data(await readFile(program))}</script>
<script type="module">${main}</script>
`;
for (const text of [main, worker]) if (text.includes("</script")) throw new Error("a script ends the element that it is in");
const links = /\s*<link [^>]*>|\s*<script [^>]*><\/script>/g;
const whole = page.replace(links, "").replace('<meta charset="utf-8">', (charset) => `${charset}\n    ${head}`).replace("</body>", () => `${end}</body>`);
await mkdir(folder, { recursive: true });
await writeFile(join(folder, "index.html"), whole);
const brotli = brotliCompressSync(whole, { params: { [constants.BROTLI_PARAM_QUALITY]: 9 } });
const size = (bytes) => `${(bytes / 1e6).toFixed(2)} MB`;
console.log(`${join(folder, "index.html")}: ${size(whole.length)}, ${size(gzipSync(whole).length)} by gzip, ${size(brotli.length)} by brotli; the program has ${size((await readFile(program)).length)}`);
