// Without a mouse, on a small screen, in both themes.

import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { test } from "node:test";
import { join } from "node:path";
import { PATIENCE, SCENES, inspect, open, placeOf, screenshot, serve, served } from "./browser.mjs";

const SMALL = ["--width", "160", "--height", "120", "--samples", "2", "--depth", "3"];
/** The checks of accessibility of Deque's axe. */
const AXE = await readFile(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const at = served("glass-and-mirror.toml", SMALL);

/**
 * What axe finds wrong, as its rules and where. A branch of a tree is named by its own row, as the ARIA authoring practices ask; axe
 * compares the name with the text of all items below, too.
 */
async function violations(page) {
    await page.evaluate(AXE);
    const { violations } = await page.evaluate(() => window.axe.run({ rules: { "target-size": { enabled: true } } }));
    const isBranch = (id, html) => id === "label-content-name-mismatch" && /^<li role="treeitem"[^>]*aria-expanded/.test(html);
    return violations.flatMap(({ id, nodes }) => nodes.filter(({ html }) => !isBranch(id, html)).map(({ target, failureSummary }) => `${id}: ${target.join(" ")} ${failureSummary}`));
}

test("keys alone lead from the picture to a ray's equations", async () => {
    const { page, context, errors } = await open(at.browser, at.url);
    await page.locator('#picture[data-done="true"]').waitFor();
    const isAt = (selector) => page.evaluate((selector) => document.activeElement?.matches(selector) ?? false, selector);
    for (let i = 0; !(await isAt("#picture-overlay")); i++) {
        assert.ok(i < 40, "Tab never reaches the picture");
        await page.keyboard.press("Tab");
    }
    await page.keyboard.press("i");
    await page.locator("#tree li").first().waitFor();
    await page.waitForFunction(() => /pixel=80,60/.test(location.hash));
    await page.keyboard.press("Control+Shift+ArrowRight");
    await page.waitForFunction(() => /pixel=90,60/.test(location.hash));
    await page.locator("#tree li").first().waitFor();
    for (let i = 0; !(await isAt('#tree [role="treeitem"]')); i++) {
        assert.ok(i < 80, "Tab never reaches the tree");
        await page.keyboard.press("Tab");
    }
    await page.keyboard.press("Home");
    assert.match((await page.locator("#equations summary").first().textContent()) ?? "", /^Ray 1: camera/);
    await page.keyboard.press("ArrowDown");
    assert.match((await page.locator("#equations summary").first().textContent()) ?? "", /^Ray 2|^Ray 3/);
    assert.equal(await page.locator('#tree [aria-selected="true"]').count(), 1);
    assert.deepEqual(errors, []);
    await context.close();
});

test("every control has a name", async () => {
    const { page, context } = await open(at.browser, at.url);
    await inspect(page, 60, 75);
    for (const tab of ["Why this pixel", "Notes, alive", "View"]) {
        await page.getByRole("tab", { name: tab }).click();
        const nameless = await page.locator("button, input, select, [role=slider], [role=application]").evaluateAll((controls) =>
            controls
                .filter((control) => control.checkVisibility())
                .filter((control) => !(control.getAttribute("aria-label") || control.labels?.length || control.textContent.trim()))
                .map((control) => control.outerHTML));
        assert.deepEqual(nameless, [], tab);
    }
    await context.close();
});

test("fingers: a tap selects a pixel, two come nearer", async () => {
    const { page, context, errors } = await open(at.browser, at.url, { viewport: { width: 360, height: 740 }, hasTouch: true });
    await page.locator('#picture[data-done="true"]').waitFor();
    const { x, y } = await placeOf(page, 60, 75);
    await page.touchscreen.tap(x, y);
    await page.waitForFunction(() => /pixel=60,75/.test(location.hash));
    const session = await context.newCDPSession(page);
    const fingers = (type, ...points) => session.send("Input.dispatchTouchEvent", { type, touchPoints: points.map(([x, y], id) => ({ x, y, id })) });
    await fingers("touchStart", [x - 20, y], [x + 20, y]);
    for (let reach = 25; reach <= 60; reach += 5) await fingers("touchMove", [x - reach, y], [x + reach, y]);
    await fingers("touchEnd");
    await page.waitForFunction(() => /camera=/.test(location.hash));
    const [eye, target] = /camera=([^&]*)/.exec(await page.evaluate(() => location.hash))[1].split("/").map((v) => v.split(",").map(Number));
    // The scene's own camera is 9.7 away.
    assert.ok(Math.hypot(...eye.map((c, i) => c - target[i])) < 6);
    assert.deepEqual(errors, []);
    await context.close();
});

test("the panel is widened by dragging its edge and by keys", async () => {
    const { page, context, errors } = await open(at.browser, at.url);
    const width = () => page.locator("#panel").evaluate((panel) => panel.getBoundingClientRect().width);
    const own = await width();
    const edge = await page.locator("#divider").boundingBox();
    await page.mouse.move(edge.x + 2, 400);
    await page.mouse.down();
    await page.mouse.move(edge.x - 98, 400, { steps: 4 });
    await page.mouse.up();
    assert.ok(Math.abs((await width()) - own - 100) < 6, `${own} became ${await width()}`);
    await page.locator("#divider").focus();
    await page.keyboard.press("Home");
    assert.equal(await width(), 320);
    await page.keyboard.press("ArrowLeft");
    assert.equal(await width(), 344);
    await page.reload();
    await page.locator("body.has-picture").waitFor();
    assert.equal(await width(), 344, "it is kept");
    await page.locator("#divider").dblclick();
    assert.equal(await width(), own);
    assert.deepEqual(errors, []);
    await context.close();
});

test("a picture has a pixel for each of the window, unless someone says its size", async () => {
    const free = await serve(join(SCENES, "notes-exercise.toml"), ["--samples", "1"]);
    const { page, context, errors } = await open(at.browser, free.url, { viewport: { width: 1100, height: 700 } });
    const size = () => page.locator("#picture").evaluate((canvas) => [canvas.width, Math.round(canvas.getBoundingClientRect().width)]);
    const [own, shown] = await size();
    assert.equal(own, shown);
    await page.setViewportSize({ width: 1300, height: 800 });
    await page.waitForFunction((own) => document.getElementById("picture").width > own, own);
    const [larger, wide] = await size();
    assert.equal(larger, wide);
    assert.deepEqual(errors, []);
    await context.close();
    await free.stop();
    const told = await open(at.browser, at.url);
    assert.equal(await told.page.locator("#picture").evaluate((canvas) => canvas.width), 160);
    await told.context.close();
});

for (const [width, height, colorScheme] of [[360, 740, "light"], [360, 740, "dark"], [800, 900, "light"], [1280, 800, "dark"]]) {
    test(`${width} pixels, ${colorScheme}: nothing is cut off, and text is legible`, async () => {
        const { page, context, errors } = await open(at.browser, at.url, { viewport: { width, height }, colorScheme, reducedMotion: "reduce" });
        await page.locator('#picture[data-done="true"]').waitFor();
        await inspect(page, 60, 75);
        await page.waitForTimeout(500);
        await screenshot(page, `why-${width}-${colorScheme}`);
        assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "the page scrolls sideways");
        assert.deepEqual(await page.evaluate(faint), []);
        assert.deepEqual(await violations(page), []);
        for (let lesson = 0; lesson < 9; lesson++) {
            await page.getByRole("tab", { name: "Notes, alive" }).click();
            await page.getByLabel("Lesson").selectOption(String(lesson));
            await page.waitForTimeout(100);
            await screenshot(page, `lesson-${lesson + 1}-${width}-${colorScheme}`);
            assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), `lesson ${lesson + 1} scrolls sideways`);
            assert.deepEqual(await violations(page), [], `lesson ${lesson + 1}`);
        }
        await page.getByRole("tab", { name: "View" }).click();
        await screenshot(page, `view-${width}-${colorScheme}`);
        assert.deepEqual(await violations(page), [], "view");
        const outside = await page.evaluate(() =>
            [...document.querySelectorAll("button, input, select, summary")].filter((control) => control.checkVisibility() && !control.closest(".skip") && (control.getBoundingClientRect().right > innerWidth + 1 || control.getBoundingClientRect().left < 0)).map((control) => control.outerHTML));
        assert.deepEqual(outside, [], "controls outside of the window");
        assert.deepEqual(errors, []);
        await context.close();
    }, { timeout: 4 * PATIENCE });
}

/** Texts with less contrast than WCAG's level AA asks for, 4.5 : 1. */
function faint() {
    const parse = (color) => {
        const numbers = color.match(/[\d.]+/g).map(Number);
        return color.startsWith("color(") ? numbers.slice(-4).map((x, i) => (i < 3 ? 255 * x : x)) : numbers;
    };
    const light = (rgb) => {
        const [r, g, b] = rgb.slice(0, 3).map((x) => (x / 255 <= 0.04045 ? x / 255 / 12.92 : ((x / 255 + 0.055) / 1.055) ** 2.4));
        return 0.2126 * r + 0.7152 * g + 0.0722 * b;
    };
    const ground = (element) => {
        for (let at = element; at; at = at.parentElement) {
            const color = getComputedStyle(at).backgroundColor;
            if (color !== "rgba(0, 0, 0, 0)" && (parse(color)[3] ?? 1) > 0.95) return parse(color);
        }
        return [255, 255, 255];
    };
    return [...document.querySelectorAll("p, td, th, label, button, dt, dd, summary, h3, h4, span")]
        .filter((element) => element.checkVisibility() && !element.closest(":disabled, #toast, .unseen, .rays-legend") && [...element.childNodes].some((node) => node.nodeType === 3 && node.textContent.trim()))
        .map((element) => {
            const [a, b] = [light(parse(getComputedStyle(element).color)), light(ground(element))].sort((x, y) => y - x);
            return [element.textContent.slice(0, 30), (a + 0.05) / (b + 0.05)];
        })
        .filter(([, contrast]) => contrast < 4.5)
        .map(([text, contrast]) => `${text}: ${contrast.toFixed(2)}`);
}
