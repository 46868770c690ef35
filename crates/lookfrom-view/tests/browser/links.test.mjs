// The address of the page: links to what is not there, views that are refused, and what an open page does when its address changes.

import assert from "node:assert/strict";
import { test } from "node:test";
import { readFile, writeFile } from "node:fs/promises";
import { join } from "node:path";
import { SCENES, copyOf, finished, inspect, open, pictureHash, screenshot, serve, served, until, visit } from "./browser.mjs";

const SMALL = ["--width", "160", "--height", "160", "--samples", "4"];
const at = served("notes-exercise.toml", SMALL);

const hash = (page) => page.evaluate(() => location.hash);
const toast = (page) => page.locator("#toast").textContent();

test("a link to what the scene lacks shows the scene without it, and tells", async () => {
    const { page, context, errors } = await open(at.browser, `${at.url}#layer=foo&compare=wipe&variant=red&samples=0.5&depth=2`);
    assert.match((await toast(page)) ?? "", /does not have: layer foo, variant red, compare wipe/);
    await until("what there is stays in the link", async () => (await hash(page)) === "#depth=2");
    assert.ok(await page.locator("#undo").isDisabled());
    assert.deepEqual(errors, []);
    await context.close();
});

test("a first view that is refused says so, and the way to the scene's own is open", async () => {
    const { page, context, errors } = await visit(at.browser, `${at.url}#camera=0,0,0/0,0,0/0,1,0`);
    const failure = page.locator("#failure");
    await failure.waitFor();
    assert.match((await failure.textContent()) ?? "", /This view cannot be shown/);
    await screenshot(page, "refused");
    await failure.getByRole("button").click();
    await page.locator("body.has-picture").waitFor();
    await failure.waitFor({ state: "hidden" });
    await until("the scene's own view", async () => (await hash(page)) === "");
    assert.deepEqual(errors, []);
    await context.close();
});

test("a setting that is refused goes back, and the camera still moves", async () => {
    const { page, context, errors } = await open(at.browser, at.url);
    await finished(page);
    const start = await pictureHash(page);
    await page.evaluate(() => (location.hash = "#min_contribution=7"));
    await until("the refusal", async () => /min_contribution/.test((await toast(page)) ?? ""));
    await until("the accepted view", async () => (await hash(page)) === "");
    assert.ok(await page.locator("#undo").isDisabled());
    await page.locator("#picture-overlay").focus();
    await page.keyboard.press("ArrowRight");
    await until("another picture", async () => (await pictureHash(page)) !== start);
    assert.ok(await page.locator("#failure").isHidden());
    assert.deepEqual(errors, []);
    await context.close();
});

test("the link to the picture leaves the address as it is", async () => {
    const { page, context, errors } = await open(at.browser, at.url);
    await inspect(page, 50, 90);
    await until("the pixel is in the address", async () => /pixel=50,90&sample=\d+&ray=\d+/.test(await hash(page)));
    const before = await hash(page);
    await page.locator("#skip").focus();
    await page.keyboard.press("Enter");
    assert.equal(await page.evaluate(() => document.activeElement?.id), "picture-overlay");
    assert.equal(await hash(page), before);
    assert.equal(await page.locator("#pixel-x").inputValue(), "50");
    assert.deepEqual(errors, []);
    await context.close();
});

test("an open page follows the ray of its address, and without a pixel there is neither ray nor sample", async () => {
    const glass = await serve(join(SCENES, "glass-and-mirror.toml"), ["--width", "160", "--height", "120", "--samples", "2", "--depth", "3"]);
    const { page, context, errors } = await open(at.browser, glass.url);
    await inspect(page, 60, 75);
    await until("the ray is in the address", async () => /ray=\d+/.test(await hash(page)));
    const own = Number(/ray=(\d+)/.exec(await hash(page))[1]);
    const addresses = await page.locator("#tree [role=treeitem]").evaluateAll((items) => items.map((item) => Number(item.dataset.address)));
    const other = addresses.find((address) => address !== own);
    await page.evaluate((link) => (location.hash = link), (await hash(page)).replace(`ray=${own}`, `ray=${other}`));
    await page.locator(`#tree [aria-selected="true"][data-address="${other}"]`).waitFor();
    await until("the ray stays", async () => (await hash(page)).endsWith(`ray=${other}`));

    await page.evaluate(() => (location.hash = "#depth=2"));
    await until("no sample", async () => page.locator("body:not(.has-sample)").count());
    await finished(page);
    await page.evaluate(() => (location.hash = "#depth=2&sample=1&ray=1"));
    await until("neither ray nor sample", async () => (await hash(page)) === "#depth=2");
    assert.deepEqual(errors, []);
    await context.close();
    await glass.stop();
});

test("a variant that is renamed in the file leaves the scene as it is without, and no error stays", async () => {
    const folder = join(SCENES, "../docs/guide/scenes/gltf");
    const copy = await copyOf("variants.gltf", folder);
    await writeFile(join(copy.scene, "../ball.bin"), await readFile(join(folder, "ball.bin")));
    const server = await serve(copy.scene, ["--width", "120", "--height", "80", "--samples", "1"]);
    const { page, context, errors } = await open(at.browser, server.url);
    await finished(page);
    const own = await pictureHash(page);
    await page.getByLabel("Variant").selectOption("lacquer");
    await until("the variant's picture", async () => (await pictureHash(page)) !== own);
    await finished(page);
    const lacquer = await pictureHash(page);
    await writeFile(copy.scene, (await readFile(copy.scene, "utf8")).replaceAll('"lacquer"', '"gloss"'));
    await until("the scene without it", async () => (await pictureHash(page)) === own);
    assert.match((await toast(page)) ?? "", /variant lacquer/);
    assert.ok(await page.locator("#failure").isHidden());
    await page.getByLabel("Variant").selectOption("gloss");
    await until("the variant by its new name", async () => (await pictureHash(page)) === lacquer);
    assert.ok(await page.locator("#failure").isHidden());
    assert.deepEqual(errors, []);
    await context.close();
    await server.stop();
    await copy.remove();
});
