// Other ways to read the page: enlarged, in colours of one's own, on paper, without scripts, among words that are written from right to left.

import assert from "node:assert/strict";
import { test } from "node:test";
import { finished, inspect, open, screenshot, served } from "./browser.mjs";

const SMALL = ["--width", "160", "--height", "120", "--samples", "2", "--depth", "3"];
const at = served("glass-and-mirror.toml", SMALL);

const background = (page, selector) => page.locator(selector).first().evaluate((element) => getComputedStyle(element).backgroundColor);

/** The controls of the open panel that something else covers while they have the focus, from the last one to the first. */
async function covered(page) {
    const found = [];
    await page.locator('[role="tabpanel"]:not([hidden]) :is(button, input, select, summary)').last().focus();
    for (;;) {
        const { isInPanel, isCovered, name } = await page.evaluate(() => {
            const active = document.activeElement;
            const element = active.matches('[role="treeitem"]') ? active.firstElementChild : active;
            const { x, y, width, height } = element.getBoundingClientRect();
            const met = document.elementFromPoint(x + Math.min(width / 2, 40), y + height / 2);
            return { isInPanel: active.closest('[role="tabpanel"]') !== null, isCovered: !met || !(element.contains(met) || met.contains(element)), name: active.outerHTML.slice(0, 80) };
        });
        if (!isInPanel) return found;
        if (isCovered) found.push(name);
        await page.keyboard.press("Shift+Tab");
    }
}

for (const [width, height] of [[800, 900], [740, 360], [640, 400], [360, 740], [320, 256]]) {
    test(`${width} × ${height} pixels: nothing covers what has the focus`, async () => {
        const { page, context, errors } = await open(at.browser, `${at.url}#pixel=60,75`, { viewport: { width, height } });
        await page.locator("#tree li").first().waitFor();
        await finished(page);
        for (const tab of ["Why this pixel", "Notes, alive", "View"]) {
            await page.getByRole("tab", { name: tab }).click();
            assert.deepEqual(await covered(page), [], tab);
        }
        assert.deepEqual(errors, []);
        await context.close();
    });
}

/** The colours of rays, lights and edges that stand out from what is around them by less than WCAG asks for, 3 : 1. */
function dim() {
    const numbers = (color) => color.match(/[\d.]+/g).slice(0, 3).map(Number);
    const light = (color) => numbers(color).map((x) => (x / 255 <= 0.04045 ? x / 255 / 12.92 : ((x / 255 + 0.055) / 1.055) ** 2.4)).reduce((sum, x, i) => sum + [0.2126, 0.7152, 0.0722][i] * x, 0);
    const probe = document.body.appendChild(document.createElement("i"));
    const style = (name, property, className = "") => {
        [probe.className, probe.style.color] = [className, name];
        return getComputedStyle(probe)[property];
    };
    const contrast = (a, b) => {
        const [high, low] = [light(a), light(b)].sort((x, y) => y - x);
        return (high + 0.05) / (low + 0.05);
    };
    const [ground, surface, soft] = ["--ground", "--surface", "--accent-soft"].map((name) => style(`var(${name})`, "color"));
    const rays = ["camera", "reflected", "refracted", "scattered", "straight-on", "shadow", "blocked"].flatMap((kind) => [surface, soft].map((below) => [kind, style(`var(--ray-${kind})`, "color"), below]));
    const lights = [0, 1, 2, 3, 4, 5, 6, 7].flatMap((i) => [ground, surface].map((below) => [`light ${i}`, style("", "backgroundColor", `light-${i}`), below]));
    const edges = [...document.querySelectorAll("select, input[type=number]")].filter((control) => control.checkVisibility()).map((control) => [control.id, getComputedStyle(control).borderTopColor, surface]);
    probe.remove();
    return [...rays, ...lights, ...edges].map(([name, color, below]) => `${name}: ${contrast(color, below).toFixed(2)}`).filter((found) => Number(found.split(": ")[1]) < 3);
}

for (const colorScheme of ["light", "dark"]) {
    test(`${colorScheme}: rays, lights and fields stand out from what is around them`, async () => {
        const { page, context, errors } = await open(at.browser, at.url, { colorScheme });
        assert.deepEqual(await page.evaluate(dim), []);
        assert.deepEqual(errors, []);
        await context.close();
    });
}

test("forced colours leave those of data, and mark what is selected", async () => {
    const { page, context, errors } = await open(at.browser, at.url, { forcedColors: "active" });
    await finished(page);
    await inspect(page, 60, 75);
    const own = { swatch: await background(page, "#pixel-summary .swatch"), ray: await background(page, "#tree .kind.camera") };
    const selected = await background(page, '#tree [aria-selected="true"] > .ray');
    const others = await background(page, '#tree [aria-selected="false"] > .ray');
    assert.notEqual(selected, others);
    assert.notEqual(await background(page, "#samples tr.selected"), await background(page, "#samples tbody tr:not(.selected)"));
    const edges = await page.locator('[role="tab"]').evaluateAll((tabs) => tabs.map((tab) => getComputedStyle(tab).borderBottomColor));
    assert.notEqual(edges[0], edges[1]);
    await screenshot(page, "forced-colours");
    await page.emulateMedia({ forcedColors: "none" });
    assert.deepEqual({ swatch: await background(page, "#pixel-summary .swatch"), ray: await background(page, "#tree .kind.camera") }, own);
    assert.deepEqual(errors, []);
    await context.close();
});

test("on paper a pixel has the name of its scene and its picture, in the inks of paper", async () => {
    const { page, context, errors } = await open(at.browser, at.url);
    await finished(page);
    await inspect(page, 60, 75);
    await page.locator("#theme").click();
    assert.equal(await page.locator("html").getAttribute("data-theme"), "dark");
    const paper = page.locator("#paper");
    assert.ok(await paper.isHidden());
    await page.evaluate(() => window.dispatchEvent(new Event("beforeprint")));
    await page.emulateMedia({ media: "print" });
    await screenshot(page, "paper");
    assert.ok(await page.locator("#scene-name").isVisible());
    assert.ok(await page.getByRole("button", { name: "Inspect" }).isHidden());
    assert.ok(await paper.isVisible());
    // The pixel's marker lies over the picture: white within black.
    const [marked, bare] = await paper.evaluate((paper) => {
        const colours = (x, y) => {
            const { data } = paper.getContext("2d").getImageData(((x + 0.5) * paper.width) / 160 - 8, ((y + 0.5) * paper.height) / 120 - 8, 16, 16);
            return data.filter((_, i) => i % 4 === 0);
        };
        return [colours(60, 75), colours(20, 20)].map((reds) => reds.some((red) => red === 255) && reds.some((red) => red < 60));
    });
    assert.deepEqual([marked, bare], [true, false]);
    const ink = await page.evaluate(() => getComputedStyle(document.documentElement).getPropertyValue("--ray-shadow"));
    await page.emulateMedia({ media: "screen" });
    assert.notEqual(await page.evaluate(() => getComputedStyle(document.documentElement).getPropertyValue("--ray-shadow")), ink, "the screen is dark");
    assert.deepEqual(errors, []);
    await context.close();
});

test("without scripts the page says that it needs them", async () => {
    const context = await at.browser.newContext({ javaScriptEnabled: false });
    const page = await context.newPage();
    await page.goto(at.url);
    assert.ok(await page.locator(".no-script").isVisible());
    await context.close();
});

test("where words are written from right to left, numbers are not, and the panel is widened toward the picture", async () => {
    const { page, context, errors } = await open(at.browser, at.url);
    await finished(page);
    await inspect(page, 60, 75);
    await page.evaluate(() => (document.documentElement.dir = "rtl"));
    const [column, row] = [await page.locator("#pixel-x").boundingBox(), await page.locator("#pixel-y").boundingBox()];
    assert.ok(column.x < row.x);
    const directions = await page.locator("#pixel-summary dd, #tree .value, #equations .math, #equations .terms, #readout").evaluateAll((elements) => elements.map((element) => getComputedStyle(element).direction));
    assert.deepEqual([...new Set(directions)], ["ltr"]);
    const width = () => page.locator("#panel").evaluate((panel) => panel.getBoundingClientRect().width);
    const [own, edge] = [await width(), await page.locator("#divider").boundingBox()];
    await page.mouse.move(edge.x + 2, 400);
    await page.mouse.down();
    await page.mouse.move(edge.x + 102, 400, { steps: 4 });
    await page.mouse.up();
    assert.ok(Math.abs((await width()) - own - 100) < 6, `${own} became ${await width()}`);
    await page.locator("#divider").press("ArrowRight");
    assert.ok(Math.abs((await width()) - own - 124) < 6);
    assert.deepEqual(errors, []);
    await context.close();
});
