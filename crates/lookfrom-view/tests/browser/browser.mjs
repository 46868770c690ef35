// A server, a browser and a page for a test, and what a person does with them.

import { execFile, spawn } from "node:child_process";
import { cp, mkdtemp, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { createInterface } from "node:readline";
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

/** A copy of an example scene that a test may edit, in a folder of its own. @param {string} name */
export async function copyOf(name) {
    const folder = await mkdtemp(join(tmpdir(), "lookfrom-view-"));
    const scene = join(folder, name);
    await cp(join(SCENES, name), scene);
    return { scene, remove: () => rm(folder, { recursive: true, force: true }) };
}

/** Starts `lookfrom view`; its first line is the address. @param {string} scene @param {string[]} options */
export async function serve(scene, options = []) {
    const server = spawn(BINARY, ["view", scene, "--port", "0", ...options], { stdio: ["ignore", "pipe", "pipe"] });
    let complaints = "";
    server.stderr.on("data", (data) => (complaints += data));
    const url = await new Promise((resolve, reject) => {
        createInterface({ input: server.stdout }).once("line", resolve);
        server.once("exit", (code) => reject(new Error(`the server ended with ${code}: ${complaints}`)));
    });
    return { url, stop: () => new Promise((resolve) => void (server.once("exit", resolve), server.kill("SIGINT"))) };
}

/** A page that shows a picture. Errors of its scripts and its policy fail the test. */
export async function open(browser, url, options = {}) {
    const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, ...options });
    const page = await context.newPage();
    page.setDefaultTimeout(PATIENCE);
    const errors = [];
    page.on("pageerror", (error) => errors.push(error.message));
    page.on("console", (message) => message.type() === "error" && errors.push(message.text()));
    await page.goto(url);
    await page.locator("body.has-picture").waitFor();
    return { page, context, errors };
}

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
