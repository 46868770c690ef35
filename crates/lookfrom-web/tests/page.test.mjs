// The page without a server, opened as a file and from a server of static files.

import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { readFile, readdir } from "node:fs/promises";
import { createRequire } from "node:module";
import { createServer } from "node:http";
import { after, before, test } from "node:test";
import { dirname, join } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import { promisify } from "node:util";
import { deflateRawSync } from "node:zlib";
import { completions } from "../assets/complete.js";
import { BINARY, PATIENCE, inspect, inspection, launch, open, pictureHash, screenshot, serve } from "../../lookfrom-view/tests/browser/browser.mjs";

const ROOT = join(dirname(fileURLToPath(import.meta.url)), "../../..");
const PAGE = join(ROOT, "dist/page/index.html");
const FILE = pathToFileURL(PAGE).href;
const SMALL = "size=96x96&samples=4";
let browser;

before(async () => void (browser = await launch()));
after(() => browser?.close());

const finished = (page) => page.locator('#picture[data-done="true"]').waitFor();
const hashOf = (page) => page.locator("#progress-text").evaluate((element) => element.dataset.hash);

/** Waits until something is true. */
async function until(what, isTrue) {
    const start = Date.now();
    while (!(await isTrue())) {
        if (Date.now() - start > PATIENCE) assert.fail(`never: ${what}`);
        await new Promise((resolve) => setTimeout(resolve, 50));
    }
}

/** Drops files on the page. @param {[string, string | Buffer][]} files */
async function drop(page, files) {
    const contents = files.map(([name, content]) => [name, Buffer.from(content).toString("base64")]);
    await page.evaluate((contents) => {
        const dataTransfer = new DataTransfer();
        for (const [name, content] of contents) dataTransfer.items.add(new File([Uint8Array.from(atob(content), (c) => c.charCodeAt(0))], name));
        document.dispatchEvent(new DragEvent("drop", { dataTransfer, bubbles: true, cancelable: true }));
    }, contents);
}

/** The parts of a zip archive of one file. */
function zip(name, content) {
    const packed = deflateRawSync(content);
    const of = (bytes, offset) => (value, at, size = 2) => bytes[size === 2 ? "writeUInt16LE" : "writeUInt32LE"](value, at - offset);
    const [local, entry, end] = [Buffer.alloc(30), Buffer.alloc(46), Buffer.alloc(22)];
    const path = Buffer.from(name);
    const [a, b, c] = [of(local, 0), of(entry, 0), of(end, 0)];
    a(0x04034b50, 0, 4), a(8, 8), a(packed.length, 18, 4), a(content.length, 22, 4), a(path.length, 26);
    b(0x02014b50, 0, 4), b(8, 10), b(packed.length, 20, 4), b(content.length, 24, 4), b(path.length, 28);
    const central = local.length + path.length + packed.length;
    c(0x06054b50, 0, 4), c(1, 8), c(1, 10), c(entry.length + path.length, 12, 4), c(central, 16, 4);
    return Buffer.concat([local, path, packed, entry, path, end]);
}

test("opened as a file: the notes' scene, why a pixel is as it is, and the numbers of the command", async () => {
    const { page, context, errors } = await open(browser, `${FILE}#size=160x160&samples=4`);
    await finished(page);
    await screenshot(page, "web-file");
    await inspect(page, 50, 90);
    await until("the sample is in the link", async () => /sample=\d+/.test(page.url()));
    const sample = Number(/sample=(\d+)/.exec(page.url())[1]);
    const said = await inspection(join(ROOT, "scenes/notes-exercise.toml"), 50, 90, sample, ["--size", "160x160", "--samples", "4"]);
    await page.getByRole("tab", { name: "Notes, alive" }).click();
    await page.getByLabel("Lesson").selectOption({ label: "8. The tree, and its sum" });
    assert.equal(await page.locator("#adds-up").textContent(), "It adds up, bit for bit.");
    const sums = await page.locator("#sum tfoot tr").evaluateAll((rows) => rows.map((row) => [...row.querySelectorAll("td")].map((cell) => Number(cell.textContent))));
    assert.deepEqual(sums, [said.radiance.lanes, said.radiance.lanes, said.film]);
    await page.locator("#space-overlay").waitFor();
    await screenshot(page, "web-why");
    assert.deepEqual(errors, []);
    await context.close();
});

test("six pictures have the hashes of the command", async () => {
    const { page, context, errors } = await open(browser, `${FILE}#${SMALL}`);
    for (const scene of ["scenes/notes-exercise.toml", "scenes/glass-and-mirror.toml", "scenes/cornell.toml", "scenes/dispersion.toml", "docs/guide/scenes/texture-marble.toml", "docs/guide/scenes/shape-solid.toml"]) {
        await page.goto(`${FILE}#scene=${scene}&${SMALL}`);
        await page.reload();
        await finished(page);
        const { stdout } = await promisify(execFile)(BINARY, ["render", scene, "--size", "96x96", "--samples", "4", "--denoise=off", "--json", "--quiet", "--output", "/tmp/t/x.png"], { cwd: ROOT, maxBuffer: 2 ** 24 });
        await until(`the hash of ${scene}`, async () => (await hashOf(page)) !== "");
        assert.equal(await hashOf(page), JSON.parse(stdout).hash, scene);
    }
    assert.deepEqual(errors, []);
    await context.close();
});

test("several workers render one picture, and it has the bits of the command", async () => {
    const { page, context, errors } = await open(browser, `${FILE}#scene=scenes/cornell.toml&size=128x128&samples=96`);
    await finished(page);
    await until("the hash", async () => (await hashOf(page)) !== "");
    assert.ok(page.workers().length > 1, "there are helpers");
    const told = await page.locator("#progress-text").textContent();
    const { stdout } = await promisify(execFile)(BINARY, ["render", "scenes/cornell.toml", "--size", "128x128", "--samples", "96", "--denoise=off", "--json", "--quiet", "--output", "/tmp/t/x.png"], { cwd: ROOT, maxBuffer: 2 ** 24 });
    assert.equal(await hashOf(page), JSON.parse(stdout).hash, told);
    // Another view in the middle of it: what comes back of the first is not added.
    await page.locator("#picture-overlay").press("ArrowRight");
    await page.waitForTimeout(2500);
    await page.locator("#picture-overlay").press("Home");
    await until("the first picture again", async () => (await hashOf(page)) === JSON.parse(stdout).hash);
    assert.deepEqual(errors, []);
    await context.close();
});

test("from a server of static files, and nothing leaves the page", async () => {
    const [asked, bytes] = [[], await readFile(PAGE)];
    const server = createServer((request, response) => {
        asked.push(request.url);
        response.setHeader("Access-Control-Allow-Origin", "*");
        response.setHeader("Content-Type", request.url === "/" ? "text/html" : "text/javascript");
        response.end(request.url === "/" ? bytes : "");
    });
    await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
    const home = `http://127.0.0.1:${server.address().port}/`;
    const { page, context } = await open(browser, `${home}#${SMALL}`);
    await finished(page);
    assert.deepEqual(asked, ["/"], "one request is enough");
    const refused = await page.evaluate(async (home) => {
        const attempts = {
            fetch: () => fetch(`${home}fetch`),
            module: () => import(`${home}module.js`),
            socket: () => new Promise((resolve, reject) => Object.assign(new WebSocket(`${home.replace("http", "ws")}socket`), { onopen: resolve, onerror: reject })),
            picture: () => new Promise((resolve, reject) => Object.assign(new Image(), { onload: resolve, onerror: reject, src: `${home}picture.png` })),
            worker: () => new Promise((resolve, reject) => {
                const script = `fetch("${home}worker").then(() => postMessage(true), () => postMessage(false))`;
                new Worker(URL.createObjectURL(new Blob([script]))).onmessage = ({ data }) => (data ? resolve() : reject());
            }),
        };
        const refused = [];
        for (const [name, attempt] of Object.entries(attempts)) await attempt().catch(() => refused.push(name));
        if (!navigator.sendBeacon(`${home}beacon`, "data")) refused.push("beacon");
        return refused;
    }, home);
    await new Promise((resolve) => setTimeout(resolve, 200));
    assert.deepEqual(asked, ["/"]);
    assert.deepEqual(refused.filter((name) => name !== "beacon"), ["fetch", "module", "socket", "picture", "worker"]);
    await context.close();
    server.close();
});

const SCENE = `
camera = { lookfrom = [0, 1, 5], lookat = [0, 0, 0] }
image = { width = 96, height = 72 }
render = { samples = 4, integrator = "raycast" }
light = [{ type = "point", position = [3, 4, 5], intensity = 20 }]
mesh = [{ file = "parts/quad.obj" }]
`;
const QUAD = "mtllib quad.mtl\nusemtl red\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n";

test("dropped files: a scene, what it lacks, an archive, a reference", async () => {
    const { page, context, errors } = await open(browser, `${FILE}#${SMALL}`);
    await finished(page);
    await drop(page, [["mine.toml", SCENE]]);
    await page.locator("#failure").waitFor();
    assert.match((await page.locator("#failure").textContent()) ?? "", /quad\.obj[\s\S]*no such file/);
    await drop(page, [["quad.obj", QUAD], ["quad.mtl", "newmtl red\nKd 0.8 0.1 0.1\n"]]);
    await page.locator("#failure").waitFor({ state: "hidden" });
    await until("its picture", async () => (await page.locator("#scene-name").textContent()) === "mine.toml" && (await page.locator("#picture").evaluate((canvas) => canvas.width)) === 96);
    await finished(page);
    const whole = await pictureHash(page);
    await until("its name in the link", async () => /dropped=mine\.toml/.test(page.url()));

    const archive = zip("folder/model.obj", Buffer.from(QUAD.replace("mtllib quad.mtl\nusemtl red\n", "")));
    await drop(page, [["model.zip", archive]]);
    await until("the model", async () => (await page.locator("#scene-name").textContent()) === "model.obj");
    await until("another picture", async () => (await pictureHash(page)) !== whole);
    await drop(page, [["broken.zip", archive.subarray(0, archive.length - 30)]]);
    await until("what is wrong", async () => /zip archive is damaged/.test((await page.locator("#toast").textContent()) ?? ""));

    const [download] = await Promise.all([page.waitForEvent("download"), page.getByText("Share").click().then(() => page.locator("#save-exr").click())]);
    await drop(page, [["reference.exr", await readFile(await download.path())]]);
    await page.getByRole("tab", { name: "View" }).click();
    await until("comparisons", async () => (await page.locator("#development").textContent() + (await page.locator("#settings").textContent())).includes("Wipe"));
    assert.deepEqual(errors, []);
    await context.close();
});

test("the text of the scene: a picture as one types, an error under its line, and a link that has it", async () => {
    const { page, context, errors } = await open(browser, `${FILE}#${SMALL}`);
    await finished(page);
    const before = await pictureHash(page);
    await page.getByRole("tab", { name: "Scene" }).click();
    const area = page.getByLabel("Text of the scene");
    const text = await area.inputValue();
    await area.fill(text.replace("radius = 1", "radius = one"));
    await page.locator("#scene .mark").waitFor();
    const line = 1 + text.split("\n").indexOf("radius = 1");
    assert.match((await page.locator("#scene .mark").textContent()) ?? "", /\^/);
    const at = await page.locator("#scene .mark").evaluate((mark) => Number(/, (.*)px/.exec(mark.style.transform)?.[1]));
    assert.equal(at + (await area.evaluate((area) => area.scrollTop)), 18 * line, "under its line");
    assert.equal(await pictureHash(page), before, "the last good picture stays");
    await screenshot(page, "web-editor");
    const broken = page.url();
    await area.fill(text.replace("radius = 1", "radius = 0.5"));
    await page.locator("#scene .mark").waitFor({ state: "hidden" });
    await until("another picture", async () => (await pictureHash(page)) !== before);
    await until("the text is in the link", async () => page.url().includes("text=") && page.url() !== broken);
    await finished(page);
    const edited = await pictureHash(page);

    const other = await open(browser, page.url());
    await until("the link's picture", async () => (await pictureHash(other.page)) === edited);
    await other.page.getByRole("tab", { name: "Scene" }).click();
    assert.equal(await other.page.getByLabel("Text of the scene").inputValue(), text.replace("radius = 1", "radius = 0.5"));
    assert.deepEqual([...errors, ...other.errors], []);
    await other.context.close();
    await context.close();
});

test("completion in the text: by keys, by the mouse, and named for screen readers", async () => {
    const { page, context, errors } = await open(browser, `${FILE}#${SMALL}`);
    await finished(page);
    const before = await pictureHash(page);
    await page.getByRole("tab", { name: "Scene" }).click();
    const area = page.getByLabel("Text of the scene");
    const text = await area.inputValue();
    const caretAfter = (part) => area.evaluate((area, part) => area.setSelectionRange(area.value.indexOf(part) + part.length, area.value.indexOf(part) + part.length), part);
    const list = page.getByRole("listbox", { name: "Completions" });
    const options = () => list.getByRole("option").allTextContents();
    await area.focus();
    await caretAfter("[[sphere]]");
    await page.keyboard.press("Enter");
    await page.keyboard.press("Control+Space");
    await list.waitFor();
    assert.ok((await options()).includes("material") === !text.includes("material"), (await options()).join());
    await page.keyboard.press("ArrowDown");
    assert.equal(await list.getByRole("option", { selected: true }).textContent(), (await options())[1]);
    assert.equal(await area.getAttribute("aria-activedescendant"), "completion-1");
    const axe = await readFile(createRequire(new URL("../../lookfrom-view/tests/browser/", import.meta.url)).resolve("axe-core/axe.min.js"), "utf8");
    // The policy of the page lets no script in: it is evaluated by the browser's own tools.
    await page.evaluate(axe);
    assert.deepEqual((await page.evaluate(() => window.axe.run())).violations.map(({ id, nodes }) => [id, nodes.map(({ html }) => html)]), []);
    await screenshot(page, "web-completion");
    await page.keyboard.press("Escape");
    assert.ok(await list.isHidden());
    assert.ok(await area.evaluate((area) => area === document.activeElement), "Escape closes the list first");

    await page.keyboard.type("rev");
    await list.waitFor();
    assert.deepEqual(await options(), ["reverse_orientation"]);
    await page.keyboard.press("Tab");
    await page.keyboard.type("true\n");
    await page.keyboard.type("ph");
    await list.getByRole("option", { name: "phi_max" }).click();
    await page.keyboard.type("200");
    assert.equal(await area.inputValue(), text.replace("[[sphere]]\n", "[[sphere]]\nreverse_orientation = true\nphi_max = 200\n"));
    await until("half a sphere", async () => (await pictureHash(page)) !== before);
    assert.ok(await page.locator("#scene .mark").isHidden());
    for (let i = 0; i < 80 && (await area.inputValue()) !== text; i++) await page.keyboard.press("Control+z");
    assert.equal(await area.inputValue(), text, "all of it can be undone");
    assert.deepEqual(errors, []);
    await context.close();
});

test("360 pixels: nothing is cut off", async () => {
    for (const width of [360, 800]) {
        const { page, context, errors } = await open(browser, `${FILE}#${SMALL}`, { viewport: { width, height: 740 } });
        await finished(page);
        await page.getByRole("tab", { name: "Scene" }).click();
        await page.getByLabel("Text of the scene").press("Control+Space");
        await page.getByRole("listbox", { name: "Completions" }).waitFor();
        await screenshot(page, `web-${width}`);
        const outside = await page.evaluate(() =>
            [...document.querySelectorAll("button, input, select, summary, [role=option]")].filter((control) => control.checkVisibility() && !control.closest(".skip") && control.getBoundingClientRect().right > innerWidth + 1).map((control) => control.outerHTML));
        assert.deepEqual(outside, []);
        assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "the page scrolls sideways");
        assert.deepEqual(errors, []);
        await context.close();
    }
});

test("Share: a page that answers for its pixel, and a scene that is whole", async () => {
    const { page, context, errors } = await open(browser, `${FILE}#${SMALL}`, { acceptDownloads: true });
    await finished(page);
    await inspect(page, 30, 50);
    await until("the sample is in the link", async () => /sample=\d+/.test(page.url()));
    const before = await hashOf(page);
    await page.locator("#picture-overlay").press("ArrowRight");
    await until("another camera", async () => page.url().includes("camera="));
    await until("its picture", async () => ![before, ""].includes(await hashOf(page)));
    await until("its rays", async () => !(await page.locator("body").evaluate((body) => body.classList.contains("is-tracing"))));
    const shown = await pictureHash(page);
    await page.getByText("Share").click();
    const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "Save page" }).click()]);
    assert.equal(download.suggestedFilename(), "notes-exercise.html");
    await page.getByText("Share").click();
    await page.getByRole("button", { name: "Copy as TOML" }).click();
    await page.locator("#text pre").or(page.locator("#toast.shown", { hasText: "clipboard" })).first().waitFor();
    const saved = `${await download.path()}.html`;
    await download.saveAs(saved);
    const other = await open(browser, pathToFileURL(saved).href);
    await other.page.locator("#tree li").first().waitFor();
    assert.equal(await pictureHash(other.page), shown);
    assert.match(other.page.url(), /pixel=30,50&sample=\d+/);
    const toml = await other.page.evaluate(() => JSON.parse(document.getElementById("handout").textContent).words.toml);
    // The whole scene: it needs no other file, and shows the view.
    await drop(page, [["whole.toml", toml]]);
    await until("the scene", async () => (await page.locator("#scene-name").textContent()) === "whole.toml");
    await finished(page);
    await until("the same picture", async () => (await pictureHash(page)) === shown);
    assert.deepEqual([...errors, ...other.errors], []);
    await other.context.close();
    await context.close();
});

test("wherever a scene of the repository has a key, that key would have been offered", async () => {
    const server = await serve(join(ROOT, "scenes/notes-exercise.toml"), ["--size", "16x16", "--samples", "1"]);
    const { page, context } = await open(browser, server.url);
    const tables = await page.evaluate(() => new Promise((resolve) => {
        const socket = new WebSocket(`${location.origin.replace("http", "ws")}/socket${location.search}`);
        socket.onopen = () => socket.send(JSON.stringify({ type: "vocabulary", id: 1 }));
        socket.onmessage = ({ data }) => void (typeof data === "string" && JSON.parse(data).id === 1 && resolve(JSON.parse(data).tables));
    }));
    await context.close();
    await server.stop();
    let count = 0;
    for (const folder of ["scenes", "docs/guide/scenes"]) {
        for (const name of (await readdir(join(ROOT, folder))).filter((name) => name.endsWith(".toml"))) {
            const text = await readFile(join(ROOT, folder, name), "utf8");
            for (const { 1: before, 2: key, index } of text.matchAll(/((?:^|[{,])[ \t]*)([a-z_]+)(?= *=)/gm)) {
                const at = index + before.length;
                const typed = text.slice(0, at + 1) + text.slice(at + key.length);
                const isFree = /^\[variables\]$|light_paths = \{[^}]*$/m.test(text.slice(0, at).split(/^(?=\[)/m).at(-1));
                if (isFree || /#[^\n]*$/.test(text.slice(0, at))) continue;
                const offered = completions(tables, typed, at + 1)?.options ?? [];
                assert.ok(key.length === 1 || offered.includes(key), `${name}: ${key} is not among ${offered.join(", ")}`);
                count++;
            }
        }
    }
    assert.ok(count > 500, `${count} keys`);
});

test("the tutorial is a path through the editor: each of its steps is a scene, and says what is new", async () => {
    const { page, context, errors } = await open(browser, `${FILE}#${SMALL}`);
    await finished(page);
    const steps = await page.locator('#examples optgroup[label^="Tutorial"] option').evaluateAll((options) => options.map(({ value }) => value));
    assert.equal(steps.length, 7);
    await page.getByRole("tab", { name: "Scene" }).click();
    let before = "";
    for (const step of steps) {
        await page.locator("#examples").selectOption(step);
        await until(`the picture of ${step}`, async () => page.url().includes(encodeURIComponent(step)) || page.url().includes(step));
        await until(`the text of ${step}`, async () => (await page.getByLabel("Text of the scene").inputValue()).length > before.length);
        await page.locator("#failure").waitFor({ state: "hidden" });
        const text = await page.getByLabel("Text of the scene").inputValue();
        assert.ok(text.startsWith(before), "each step goes on from the one before");
        assert.match(text.slice(before.length), /^\n?# \w/);
        before = text;
    }
    await screenshot(page, "web-tutorial");
    assert.deepEqual(errors, []);
    await context.close();
});
