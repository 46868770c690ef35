// Where the focus is after what a person does with keys: a page that loses it starts anew from its top.

import assert from "node:assert/strict";
import { test } from "node:test";
import { finished, inspect, open, served, until } from "./browser.mjs";

const SMALL = ["--width", "160", "--height", "120", "--samples", "2", "--depth", "3"];
const at = served("glass-and-mirror.toml", SMALL);

/** The name of what has the focus. */
const focused = (page) => page.evaluate(() => {
    const element = document.activeElement;
    return element === document.body ? "the page" : element.getAttribute("aria-label") ?? element.labels?.[0]?.textContent ?? (element.id || element.textContent);
});
const toast = (page) => page.locator("#toast").textContent();

test("Tab leads from a number that was typed to the next field", async () => {
    const { page, context, errors } = await open(at.browser, at.url);
    await finished(page);
    for (const [field, typed, part, next] of [["Depth", "5", "depth=5", "Samples"], ["lookfrom x", "1", "camera=1,", "lookfrom y"], ["fov", "50", "/50", "The scene's own camera"]]) {
        await page.getByRole("spinbutton", { name: field }).fill(typed);
        await page.keyboard.press("Tab");
        await until("the view", async () => page.url().includes(part));
        await finished(page);
        assert.equal(await focused(page), next);
    }
    assert.deepEqual(errors, []);
    await context.close();
});

test("a number that is refused goes back while its field has the focus, and what is being typed stays", async () => {
    const { page, context, errors } = await open(at.browser, at.url);
    await finished(page);
    const up = page.getByRole("spinbutton", { name: "up y" });
    await up.fill("0");
    await up.press("Enter");
    await until("the refusal", async () => /up/.test((await toast(page)) ?? ""));
    await until("the accepted value", async () => (await up.inputValue()) === "1");
    assert.equal(await focused(page), "up y");
    await up.fill("3");
    // An undone view says nothing of what is being typed.
    await page.evaluate(() => (location.hash = "#depth=2"));
    await until("the depth", async () => (await page.getByRole("spinbutton", { name: "Depth" }).inputValue()) === "2");
    assert.equal(await up.inputValue(), "3");
    await up.press("Enter");
    await until("the camera", async () => /0,3,0/.test(page.url()));
    assert.deepEqual(errors, []);
    await context.close();
});

test("the menu closes when the focus leaves it, and what it does brings the focus back to its button", async () => {
    const { page, context, errors } = await open(at.browser, at.url);
    await finished(page);
    const isOpen = () => page.locator("#menu").evaluate((menu) => menu.open);
    await page.locator("#menu summary").focus();
    await page.keyboard.press("Enter");
    await page.keyboard.press("Shift+Tab");
    assert.equal(await isOpen(), false);
    await page.locator("#menu summary").focus();
    await page.keyboard.press("Enter");
    for (let i = 0; i < 3; i++) await page.keyboard.press("Tab");
    assert.equal(await focused(page), "copy-command");
    await page.keyboard.press("Enter");
    await until("the command, in the clipboard or a dialog", async () => /clipboard/.test((await toast(page)) ?? "") || (await page.locator("#text[open]").count()) === 1);
    await page.keyboard.press("Escape");
    assert.deepEqual([await focused(page), await isOpen()], ["Share", false]);
    assert.deepEqual(errors, []);
    await context.close();
});

test("the last step of undo, another pixel and another triangle leave the focus where it is", async () => {
    const { page, context, errors } = await open(at.browser, at.url);
    await finished(page);
    await page.locator("#picture-overlay").focus();
    await page.keyboard.press("ArrowRight");
    await until("a camera", async () => /camera=/.test(page.url()));
    await page.locator("#undo").focus();
    await page.keyboard.press("Enter");
    await until("the scene's own", async () => !/camera=/.test(page.url()));
    assert.ok(await page.locator("#undo").isDisabled());
    assert.equal(await focused(page), "Undo the view");
    await finished(page);
    await inspect(page, 60, 75);
    await page.getByRole("spinbutton", { name: "Column" }).fill("61");
    await page.keyboard.press("Enter");
    await until("the pixel", async () => /pixel=61,75/.test(page.url()));
    assert.equal(await focused(page), "Column");
    await page.locator("#tree li").first().waitFor();
    await page.getByRole("tab", { name: "Notes, alive" }).click();
    await page.getByLabel("Lesson").selectOption("4");
    await page.getByLabel("Tested sphere").focus();
    await page.keyboard.press("ArrowDown");
    assert.equal(await focused(page), "Tested sphere");
    await page.getByLabel("Lesson").selectOption("1");
    await page.getByLabel("The point on the image").press("Shift+ArrowRight");
    await page.getByRole("button", { name: "Inspect this pixel" }).press("Enter");
    await until("the pixel", async () => /pixel=7\d,7\d/.test(page.url()));
    assert.equal(await page.evaluate(() => document.activeElement.closest("#notes")?.id), "notes");
    assert.deepEqual(errors, []);
    await context.close();
});

test("the value beside a slider is the slider's", async () => {
    const { page, context, errors } = await open(at.browser, at.url);
    await finished(page);
    await inspect(page, 60, 75);
    await page.getByRole("tab", { name: "Notes, alive" }).click();
    await page.getByLabel("Lesson").selectOption("7");
    const share = page.getByLabel("Smallest share");
    await share.press("End");
    assert.deepEqual([await share.getAttribute("aria-valuetext"), await page.locator(".slider", { has: share }).locator(".value").textContent()], ["1", "1"]);
    assert.deepEqual(errors, []);
    await context.close();
});

test("the help begins at its top on a small screen, and goes back to its button", async () => {
    const { page, context, errors } = await open(at.browser, at.url, { viewport: { width: 740, height: 360 } });
    await page.locator("#help-button").press("Enter");
    assert.equal(await page.evaluate(() => document.activeElement.id), "help-title");
    assert.ok(await page.locator("#help-title").evaluate((title) => title.getBoundingClientRect().top > 0));
    await page.keyboard.press("Escape");
    assert.equal(await page.evaluate(() => document.activeElement.id), "help-button");
    assert.deepEqual(errors, []);
    await context.close();
});
