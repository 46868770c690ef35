// A server, a browser and a page for a test, and what a person does with them.

import assert from "node:assert/strict";
import { execFile, spawn } from "node:child_process";
import { cp, mkdtemp, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { createInterface } from "node:readline";
import { after, before } from "node:test";
import { fileURLToPath } from "node:url";
import { promisify } from "node:util";
import { chromium } from "playwright-core";

export const BINARY = process.env.LOOKFROM_BINARY ?? "";
export const SCENES = join(dirname(fileURLToPath(import.meta.url)), "../../../../scenes");
/** Longer than any answer takes in a debug build on a busy machine. */
export const PATIENCE = 60_000;

// The sandbox of Chromium does not start for root, as which containers run; the others keep it from asking the network.
const FLAGS = ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"];

export const launch = () => chromium.launch({ executablePath: process.env.CHROMIUM, args: FLAGS });

/** A copy of an example scene that a test may edit, in a folder of its own. @param {string} name @param {string} [from] */
export async function copyOf(name, from = SCENES) {
    const folder = await mkdtemp(join(tmpdir(), "lookfrom-view-"));
    const scene = join(folder, name);
    await cp(join(from, name), scene);
    return { scene, remove: () => rm(folder, { recursive: true, force: true }) };
}

/** Starts `lookfrom view`; its first line is the address. @param {string} scene @param {string[]} options @param {string} port */
export async function serve(scene, options = [], port = "0") {
    const server = spawn(BINARY, ["view", scene, "--port", port, ...options], { stdio: ["ignore", "pipe", "pipe"] });
    let complaints = "";
    server.stderr.on("data", (data) => (complaints += data));
    const url = await new Promise((resolve, reject) => {
        createInterface({ input: server.stdout }).once("line", resolve);
        server.once("exit", (code) => reject(new Error(`the server ended with ${code}: ${complaints}`)));
    });
    return { url, stop: () => new Promise((resolve) => void (server.once("exit", resolve), server.kill("SIGINT"))) };
}

/**
 * A browser and the server of an example scene, for all tests of a file: there while they run.
 * @param {string} scene @param {string[]} options
 */
export function served(scene, options) {
    const at = {};
    before(async () => {
        at.browser = await launch();
        at.server = await serve(join(SCENES, scene), options);
        at.url = at.server.url;
    });
    after(async () => {
        await at.browser?.close();
        await at.server?.stop();
    });
    return at;
}

/**
 * A page that may have no picture to show. Errors of its scripts and its policy fail the test.
 * @param {(page: import("playwright-core").Page) => Promise<unknown>} [prepare] What is done before the page is there.
 */
export async function visit(browser, url, options = {}, prepare = async () => {}) {
    const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, ...options });
    const page = await context.newPage();
    page.setDefaultTimeout(PATIENCE);
    const errors = [];
    page.on("pageerror", (error) => errors.push(error.message));
    page.on("console", (message) => message.type() === "error" && errors.push(message.text()));
    await prepare(page);
    await page.goto(url);
    return { page, context, errors };
}

/** A page that shows a picture. */
export async function open(browser, url, options = {}, prepare = async () => {}) {
    const visited = await visit(browser, url, options, prepare);
    await visited.page.locator("body.has-picture").waitFor();
    return visited;
}

/** Waits until something is true. */
export async function until(what, isTrue) {
    const start = Date.now();
    while (!(await isTrue())) {
        if (Date.now() - start > PATIENCE) assert.fail(`never: ${what}`);
        await new Promise((resolve) => setTimeout(resolve, 50));
    }
}

/** Waits until the picture has all of its samples. */
export const finished = (page) => page.locator('#picture[data-done="true"]').waitFor();

/** A place on the screen in the middle of a pixel of the picture. */
export const placeOf = (page, x, y) =>
    page.locator("#picture").evaluate((canvas, [x, y]) => {
        const box = canvas.getBoundingClientRect();
        return { x: box.left + ((x + 0.5) * box.width) / canvas.width, y: box.top + ((y + 0.5) * box.height) / canvas.height };
    }, [x, y]);

/** Clicks a pixel, and waits until its rays are there. */
export async function inspect(page, x, y) {
    const place = await placeOf(page, x, y);
    await page.mouse.click(place.x, place.y);
    await page.locator("#tree li").first().waitFor();
}

/** A number that changes with the picture. */
export const pictureHash = (page) =>
    page.locator("#picture").evaluate((canvas) => {
        const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
        let hash = 0;
        for (let i = 0; i < data.length; i += 4) hash = (Math.imul(hash, 31) + data[i] + 256 * data[i + 1] + 65536 * data[i + 2]) | 0;
        return hash;
    });

/** What `lookfrom inspect` says of a sample. */
export async function inspection(scene, x, y, sample, options = []) {
    const { stdout } = await promisify(execFile)(BINARY, ["inspect", scene, String(x), String(y), "--sample", String(sample), "--json", ...options], { maxBuffer: 2 ** 28 });
    return JSON.parse(stdout);
}

/** Keeps a screenshot where the person who runs the tests wants to look at them. */
export async function screenshot(page, name) {
    const folder = process.env.LOOKFROM_SCREENSHOTS;
    if (folder) await page.screenshot({ path: join(folder, `${name}.png`) });
}
