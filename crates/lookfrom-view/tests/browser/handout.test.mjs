// A hand-out of `lookfrom view --export`, opened from a folder.

import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { mkdtemp, readFile, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { promisify } from "node:util";
import { BINARY, SCENES, inspect, inspection, launch, open, pictureHash, placeOf, screenshot, serve, until } from "./browser.mjs";

const SCENE = join(SCENES, "glass-and-mirror.toml");
const SMALL = ["--width", "160", "--height", "120", "--samples", "2", "--depth", "3"];
let browser, folder, page_;

before(async () => {
    browser = await launch();
    folder = await mkdtemp(join(tmpdir(), "lookfrom-handout-"));
    page_ = join(folder, "handout.html");
    await promisify(execFile)(BINARY, ["view", SCENE, "--export", page_, "--pixel", "60,75", ...SMALL]);
});
after(async () => {
    await browser?.close();
    await rm(folder, { recursive: true, force: true });
});

for (const [width, height, colorScheme] of [[1280, 800, "light"], [360, 740, "dark"]]) {
    test(`a file answers for its pixel, ${width} pixels wide`, async () => {
        const { page, context, errors } = await open(browser, pathToFileURL(page_).href, { viewport: { width, height }, colorScheme });
        const asked = [];
        page.on("request", (request) => /^(https?|wss?|file):/.test(request.url()) && asked.push(request.url()));
        await page.locator("#tree li").first().waitFor();
        const sample = Number(/sample=(\d+)/.exec(await page.waitForFunction(() => /sample=\d+/.exec(location.hash)?.[0]).then((found) => found.jsonValue()))[1]);
        const said = await inspection(SCENE, 60, 75, sample, SMALL);
        assert.deepEqual(await page.locator("#tree [role=treeitem]").evaluateAll((items) => items.map((item) => Number(item.dataset.address)).sort((a, b) => a - b)), said.rays.map(({ address }) => address).sort((a, b) => a - b));
        await page.locator("#samples tbody tr").last().getByRole("button").click();
        await page.waitForFunction((sample) => !location.hash.includes(`sample=${sample}`), sample);

        await page.getByRole("tab", { name: "Notes, alive" }).click();
        await page.getByLabel("Lesson").selectOption({ label: "8. The tree, and its sum" });
        assert.equal(await page.locator("#adds-up").textContent(), "It adds up, bit for bit.");
        await page.getByRole("tab", { name: "Scene" }).click();
        assert.equal(await page.locator("pre.source").textContent(), await readFile(SCENE, "utf8"));
        await page.getByRole("tab", { name: "Why this pixel" }).click();

        // Another pixel is not held; the one that is stays.
        await page.locator("#picture-overlay").scrollIntoViewIfNeeded();
        const other = await placeOf(page, 20, 20);
        await page.mouse.click(other.x, other.y);
        await page.waitForFunction(() => document.getElementById("toast").textContent.includes("60, 75"));
        await page.waitForFunction(() => /pixel=60,75/.test(location.hash));
        await page.waitForTimeout(500);
        await screenshot(page, `handout-${width}`);
        assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "the page scrolls sideways");
        assert.deepEqual([errors, asked], [[], []]);
        await context.close();
    });
}

test("a sample that a file does not hold leaves the one that is shown, in its address, too", async () => {
    const file = join(folder, "some.html");
    await promisify(execFile)(BINARY, ["view", SCENE, "--export", file, "--pixel", "60,75", "--width", "160", "--height", "120", "--samples", "12", "--depth", "2"]);
    const { page, context, errors } = await open(browser, pathToFileURL(file).href);
    await page.locator("#tree li").first().waitFor();
    const shown = (await page.locator("#sample-summary h3 >> nth=0").textContent()) ?? "";
    const toast = () => page.locator("#toast").textContent();
    // Eight are held: the darkest is not.
    await page.locator("#samples tbody tr").last().getByRole("button").click();
    await until("a word", async () => /holds these samples/.test((await toast()) ?? ""));
    await until("the address of what is shown", async () => page.url().includes(`sample=${/\d+/.exec(shown)[0]}&`));
    assert.equal(await page.locator("#sample-summary h3 >> nth=0").textContent(), shown);
    assert.deepEqual(errors, []);
    await context.close();
});

test("Share saves the page of the view as it is, with its pixel and sample", async () => {
    const server = await serve(SCENE, SMALL);
    const { page, context, errors } = await open(browser, server.url);
    await page.locator('#picture[data-done="true"]').waitFor();
    await page.locator("#picture-overlay").focus();
    for (let i = 0; i < 3; i++) await page.keyboard.press("ArrowRight");
    await page.waitForFunction(() => /camera=/.test(location.hash));
    await page.locator('#picture[data-done="true"]').waitFor();
    await inspect(page, 60, 75);
    const brightest = await page.locator("#tree").textContent();
    await page.locator("#samples tbody tr").last().getByRole("button").click();
    const sample = await page.locator("#samples tbody tr").last().getAttribute("data-sample");
    await page.waitForFunction((before) => document.getElementById("tree").textContent !== before, brightest);
    const [picture, rays] = [await pictureHash(page), await page.locator("#tree").textContent()];
    await page.getByText("Share").click();
    await screenshot(page, "share");
    const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "Save page" }).click()]);
    assert.equal(download.suggestedFilename(), "glass-and-mirror.html");
    const saved = join(folder, "saved.html");
    await download.saveAs(saved);

    const other = await open(browser, pathToFileURL(saved).href);
    const asked = [];
    other.page.on("request", (request) => /^(https?|wss?|file):/.test(request.url()) && asked.push(request.url()));
    await other.page.locator("#tree li").first().waitFor();
    await other.page.waitForFunction((sample) => location.hash.includes(`pixel=60,75&sample=${sample}`), sample);
    assert.deepEqual([await pictureHash(other.page), await other.page.locator("#tree").textContent()], [picture, rays]);
    await other.page.getByText("Share").click();
    assert.ok(await other.page.locator("#save-page").isHidden());
    await screenshot(other.page, "saved-page");
    assert.deepEqual([...errors, ...other.errors, ...asked], []);
    await other.context.close();
    await context.close();
    await server.stop();
});
