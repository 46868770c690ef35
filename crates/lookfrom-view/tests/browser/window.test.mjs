// The size of the picture, which is the window's: it follows the window and the scene's shape, and nothing else.

import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { after, before, test } from "node:test";
import { readFile, writeFile } from "node:fs/promises";
import { join } from "node:path";
import { promisify } from "node:util";
import { BINARY, copyOf, finished, launch, open, pictureHash, screenshot, serve, until } from "./browser.mjs";

let browser, copy, server;

before(async () => {
    browser = await launch();
    copy = await copyOf("notes-exercise.toml");
    const reference = join(copy.scene, "../reference.exr");
    await promisify(execFile)(BINARY, ["render", copy.scene, "--samples", "1", "-o", reference]);
    server = await serve(copy.scene, ["--samples", "2", "--reference", reference]);
});
after(async () => {
    await browser?.close();
    await server?.stop();
    await copy?.remove();
});

const width = (page) => page.locator("#picture").evaluate((canvas) => canvas.width);
const height = (page) => page.locator("#picture").evaluate((canvas) => canvas.height);
/** The size that fits, as the list of sizes names it. */
const fitting = async (page) => {
    const titles = await page.getByLabel("Size").locator("option").allTextContents();
    return Number.parseInt(titles.find((title) => title.includes("fits the window")) ?? "");
};

test("the values under a resting pointer do not move the picture", async () => {
    const { page, context, errors } = await open(browser, server.url, { viewport: { width: 960, height: 700 } });
    await finished(page);
    const frame = () => page.locator("#picture-overlay").evaluate((overlay) => overlay.getBoundingClientRect().height);
    const [before, size] = [await frame(), await width(page)];
    const box = await page.locator("#picture").boundingBox();
    await page.mouse.move(box.x + 0.75 * box.width, box.y + 0.6 * box.height);
    await until("all values", async () => /σ .*reference .*sample/.test((await page.locator("#readout").textContent()) ?? ""));
    await screenshot(page, "readout");
    assert.deepEqual([await frame(), await width(page)], [before, size]);
    assert.ok(await page.locator("#undo").isDisabled());
    assert.deepEqual(errors, []);
    await context.close();
});

test("a picture that fits follows the window, which is nothing to undo, also in what undo returns to", async () => {
    const { page, context, errors } = await open(browser, server.url);
    await finished(page);
    const first = await width(page);
    await page.setViewportSize({ width: 1100, height: 620 });
    await until("a smaller picture", async () => (await width(page)) < first);
    assert.ok(await page.locator("#undo").isDisabled());
    await page.locator("#picture-overlay").focus();
    await page.keyboard.press("ArrowRight");
    await until("a step", async () => page.locator("#undo").isEnabled());
    const second = await width(page);
    await page.setViewportSize({ width: 1280, height: 800 });
    await until("a larger picture", async () => (await width(page)) > second);
    await page.keyboard.press("Control+z");
    await until("no further step", async () => page.locator("#undo").isDisabled());
    assert.deepEqual([await width(page), await fitting(page)], [first, first]);
    assert.deepEqual(errors, []);
    await context.close();
});

test("a picture that fits follows the scene's shape", async () => {
    const { page, context, errors } = await open(browser, server.url);
    await finished(page);
    assert.equal(await width(page), await height(page));
    const text = await readFile(copy.scene, "utf8");
    await writeFile(copy.scene, text.replace("height = 480", "height = 240"));
    await until("twice as wide as high", async () => Math.abs((await width(page)) - 2 * (await height(page))) <= 2);
    await until("the size that fits", async () => (await fitting(page)) === (await width(page)));
    await writeFile(copy.scene, text);
    await until("as wide as high", async () => (await width(page)) === (await height(page)));
    assert.deepEqual(errors, []);
    await context.close();
});

test("Ctrl Z undoes the view from a slider and from a choice, which keep the focus", async () => {
    const { page, context, errors } = await open(browser, server.url);
    await finished(page);
    const start = await pictureHash(page);
    const isFocused = (locator) => locator.evaluate((control) => control === document.activeElement);
    const exposure = page.getByRole("slider", { name: "Exposure" });
    await exposure.focus();
    await page.keyboard.press("ArrowRight");
    await until("a brighter picture", async () => (await pictureHash(page)) !== start);
    await page.keyboard.press("Control+z");
    await until("the first picture again", async () => (await pictureHash(page)) === start);
    assert.deepEqual([await exposure.inputValue(), await isFocused(exposure)], ["0", true]);

    const layer = page.getByLabel("Layer");
    await layer.focus();
    await layer.selectOption("albedo");
    await until("the layer", async () => (await pictureHash(page)) !== start);
    await page.keyboard.press("Control+z");
    await until("the light again", async () => (await pictureHash(page)) === start);
    assert.deepEqual([await layer.inputValue(), await isFocused(layer)], ["color", true]);

    // In a field, the keys are the field's.
    const samples = page.getByLabel("Samples", { exact: true });
    await samples.fill("3");
    await samples.press("Control+z");
    assert.equal(await samples.inputValue(), "");
    assert.deepEqual(errors, []);
    await context.close();
});
