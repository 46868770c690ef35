// What a screen reader is told, and what a voice that types must not do.

import assert from "node:assert/strict";
import { test } from "node:test";
import { finished, inspect, open, served, until } from "./browser.mjs";

const SMALL = ["--width", "160", "--height", "160", "--samples", "2"];
const at = served("notes-exercise.toml", SMALL);

async function lesson(page, number) {
    await page.getByRole("tab", { name: "Notes, alive" }).click();
    await page.getByLabel("Lesson").selectOption(String(number - 1));
}

test("formulas are named as a line: with their fractions, roots, exponents and matrices", async () => {
    const { page, context, errors } = await open(at.browser, at.url);
    await finished(page);
    await inspect(page, 110, 80);
    const names = () => page.locator("#notes .math").evaluateAll((formulas) => formulas.map((formula) => formula.getAttribute("aria-label")));
    await lesson(page, 5);
    assert.equal((await names())[0], "A t² + 2 B t + C = 0 , t = ( − B ± √( B² − A C ) ) / A");
    await lesson(page, 4);
    assert.match((await names())[0], /^β = D_1 \/ D ,/);
    await lesson(page, 1);
    assert.match((await names())[0], /k_s Σ \( N · H_j \)ⁿ I_j/);
    await lesson(page, 3);
    assert.ok((await names()).some((name) => name.includes("[ 1, 0, 0, 0; 0, 1, 0, 0; 0, 0, 1, 0; 0, 0, 0, 1 ]")), String(await names()));
    assert.deepEqual(errors, []);
    await context.close();
});

test("what a slider tells of itself, no live region repeats", async () => {
    const { page, context, errors } = await open(at.browser, at.url);
    await finished(page);
    await inspect(page, 110, 80);
    for (const number of [1, 4, 5, 6, 7, 9]) {
        await lesson(page, number);
        for (const slider of await page.locator("#notes :is([role=slider], input[type=range])").all()) {
            await slider.press("ArrowRight");
            const told = await slider.getAttribute("aria-valuetext");
            const live = await page.locator("#notes :is(output, [role=status])").allTextContents();
            assert.ok(!live.includes(told), `lesson ${number}: ${told}`);
        }
    }
    assert.deepEqual(errors, []);
    await context.close();
});

test("a pixel that is selected is told with its colour", async () => {
    const { page, context, errors } = await open(at.browser, at.url);
    await finished(page);
    await page.locator("#picture-overlay").press("i");
    await page.locator("#pixel-summary .numbers").waitFor();
    const [red, green, blue] = ((await page.locator("#pixel-summary dt", { hasText: "8 bit" }).locator("+ dd").textContent()) ?? "").split(" ");
    assert.equal(await page.locator("#announcements").textContent(), `Pixel 80 80: red ${red}, green ${green}, blue ${blue}; 2 samples`);
    assert.deepEqual(errors, []);
    await context.close();
});

test("letters alone do something in the picture only", async () => {
    const { page, context, errors } = await open(at.browser, at.url);
    await finished(page);
    const loupe = () => page.locator("#loupe-button").getAttribute("aria-pressed");
    const isHelpOpen = () => page.locator("#help").evaluate((dialog) => dialog.open);
    await page.locator("#tab-view").focus();
    await page.keyboard.press("l");
    await page.keyboard.press("?");
    assert.deepEqual([await loupe(), await isHelpOpen()], ["false", false]);
    await page.locator("#picture-overlay").focus();
    await page.keyboard.press("l");
    await page.keyboard.press("?");
    assert.deepEqual([await loupe(), await isHelpOpen()], ["true", true]);
    assert.deepEqual(errors, []);
    await context.close();
});

test("the eye looks around by keys, too", async () => {
    const { page, context, errors } = await open(at.browser, at.url);
    await finished(page);
    await page.locator("#picture-overlay").focus();
    await page.keyboard.press("Shift+A");
    await page.keyboard.press("Shift+W");
    await until("another target", async () => /camera=/.test(page.url()));
    const [eye, target] = /camera=([^&]*)/.exec(page.url())[1].split("/").map((v) => v.split(",").map(Number));
    // The eye stays; its left is x, y is up.
    assert.deepEqual(eye, [0, 0, 0]);
    assert.ok(target[0] > 0.05 && target[1] > 0.05, String(target));
    assert.deepEqual(errors, []);
    await context.close();
});

test("what a field means stands below it", async () => {
    const { page, context, errors } = await open(at.browser, at.url);
    const depth = page.getByRole("spinbutton", { name: "Depth" });
    const meaning = page.getByText("Bounces at most");
    assert.ok(await meaning.isVisible());
    assert.equal(await depth.getAttribute("aria-describedby"), await meaning.getAttribute("id"));
    assert.deepEqual(errors, []);
    await context.close();
});

test("a long message stays longer than a short one", async () => {
    const { page, context, errors } = await open(at.browser, at.url, {}, (page) => page.clock.install());
    const toast = page.locator("#toast.shown");
    await page.evaluate(() => (location.hash = "#layer=foo&variant=red&compare=wipe&animation=7&tonemap=none-that-is-known"));
    await page.reload();
    await toast.waitFor();
    assert.ok(((await toast.textContent()) ?? "").length > 60);
    await page.clock.runFor(4300);
    assert.equal(await toast.count(), 1);
    await page.clock.runFor(60_000);
    assert.equal(await toast.count(), 0);
    assert.deepEqual(errors, []);
    await context.close();
});
