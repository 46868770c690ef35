// `lookfrom view` in a browser, used as a person uses it.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { readFile, writeFile } from "node:fs/promises";
import { join } from "node:path";
import { SCENES, copyOf, finished, inspect, inspection, launch, open, pictureHash, placeOf, screenshot, serve, until } from "./browser.mjs";

const SMOKE = ["--width", "240", "--height", "150", "--samples", "2"];
const SMALL = ["--width", "160", "--height", "160", "--samples", "4"];
let browser, copy, server;

before(async () => {
    browser = await launch();
    copy = await copyOf("notes-exercise.toml");
    server = await serve(copy.scene, SMALL);
});
after(async () => {
    await browser?.close();
    await server?.stop();
    await copy?.remove();
});

test("a drag orbits, undo goes back, and the link keeps the view", async () => {
    const { page, context, errors } = await open(browser, server.url);
    await finished(page);
    const start = await pictureHash(page);
    const { x, y } = await placeOf(page, 80, 80);
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 60, y + 20, { steps: 4 });
    await page.mouse.up();
    await until("another picture", async () => (await pictureHash(page)) !== start);
    await until("the camera is in the link", async () => page.url().includes("camera="));
    const link = page.url();
    await finished(page);
    const moved = await pictureHash(page);
    await screenshot(page, "orbit");

    await page.keyboard.press("Control+z");
    await until("the first picture again", async () => (await pictureHash(page)) === start);
    await page.keyboard.press("Control+Shift+z");
    await until("the moved picture again", async () => (await pictureHash(page)) === moved);

    const other = await open(browser, link);
    await until("the link's picture", async () => (await pictureHash(other.page)) === moved);
    assert.deepEqual([...errors, ...other.errors], []);
    await other.context.close();
    await context.close();
});

test("a click shows the numbers of `lookfrom inspect --json`", async () => {
    const { page, context, errors } = await open(browser, server.url);
    await finished(page);
    await inspect(page, 50, 90);
    await until("the pixel is in the link", async () => /pixel=50,90.*sample=\d+/.test(page.url()));
    const sample = Number(/sample=(\d+)/.exec(page.url())[1]);
    const said = await inspection(copy.scene, 50, 90, sample, SMALL);

    const rows = await page.locator("#equations .candidate.nearest .twice tbody tr").evaluateAll((rows) => rows.map((row) => [...row.children].map((cell) => cell.textContent)));
    const nearest = said.rays[0].candidates.find((candidate) => candidate.is_nearest);
    const numbers = Object.values(nearest.test)[0].numbers;
    assert.deepEqual(rows, numbers.map(([name, value]) => [name, String(value.f32), String(value.f64), String(value.bits)]));
    assert.doesNotMatch((await page.locator("#equations").textContent()) ?? "", /\[object/);

    await page.getByRole("tab", { name: "Notes, alive" }).click();
    await page.getByLabel("Lesson").selectOption({ label: "8. The tree, and its sum" });
    assert.equal(await page.locator("#adds-up").textContent(), "It adds up, bit for bit.");
    const sums = await page.locator("#sum tfoot tr").evaluateAll((rows) => rows.map((row) => [...row.querySelectorAll("td")].map((cell) => Number(cell.textContent))));
    assert.deepEqual(sums, [said.radiance.lanes, said.radiance.lanes, said.film]);
    await screenshot(page, "sum");
    assert.deepEqual(errors, []);
    await context.close();
});

test("a pixel: its mean and all of its samples, and from a contribution to its ray", async () => {
    const { page, context, errors } = await open(browser, server.url);
    await finished(page);
    await inspect(page, 120, 100);
    await page.locator("#samples tbody tr").first().waitFor();
    const said = await inspection(copy.scene, 120, 100, "all", SMALL);
    const rows = await page.locator("#samples tbody tr").evaluateAll((rows) => rows.map((row) => [row.dataset.sample, row.querySelector(".expression").textContent]));
    assert.deepEqual(rows, said.all.map(({ sample, expression }) => [String(sample), expression]));
    assert.match((await page.locator("#pixel-summary .numbers").textContent()) ?? "", new RegExp(`8 bit${said.color8.join(" ")}samples${said.samples}$`));

    const last = page.locator("#samples tbody tr").last();
    await last.getByRole("button").click();
    const sample = await last.getAttribute("data-sample");
    await until("the sample is in the link", async () => page.url().includes(`sample=${sample}`));
    const largest = said.contributions[0];
    await page.locator("#pixel-summary .contributions button").first().click();
    await until("the contribution's ray is in the link", async () => page.url().endsWith(`sample=${largest.sample}&ray=${largest.address}`));
    assert.match((await page.locator('#tree [aria-selected="true"] > .ray .name').textContent()) ?? "", new RegExp(`^${largest.address} `));
    assert.deepEqual(errors, []);
    await context.close();
});

test("the lesson on the tree prunes it for itself: outside, the sample is that of the picture", async () => {
    const glass = await serve(join(SCENES, "glass-and-mirror.toml"), ["--width", "160", "--height", "120", "--samples", "2", "--depth", "3"]);
    const { page, context, errors } = await open(browser, glass.url);
    await inspect(page, 60, 75);
    await page.locator("#pixel-summary .numbers").waitFor();
    const rays = () => page.locator("#tree [role=treeitem]").count();
    const whole = await rays();
    await page.getByRole("tab", { name: "Notes, alive" }).click();
    await page.getByLabel("Lesson").selectOption({ label: "8. The tree, and its sum" });
    await page.getByRole("slider", { name: "Depth" }).fill("0");
    await until("a tree of one ray", async () => (await rays()) === 1);
    await page.getByRole("tab", { name: "Why this pixel" }).click();
    assert.notEqual(whole, 1);
    assert.equal(await rays(), whole);
    assert.equal(await page.locator("#tree [aria-selected=true]").count(), 1);
    assert.deepEqual(errors, []);
    await context.close();
    await glass.stop();
});

test("a pixel's colour in 8 bits follows exposure and tone map, and its rays stay as they are", async () => {
    const { page, context, errors } = await open(browser, server.url);
    await finished(page);
    await inspect(page, 120, 80);
    const color = async () => /8 bit([\d ]+)samples/.exec((await page.locator("#pixel-summary .numbers").textContent()) ?? "")?.[1];
    const before = await color();
    await page.locator("#tree li").first().evaluate((item) => item.setAttribute("data-is-old", ""));
    await page.getByRole("slider", { name: "Exposure" }).fill("1");
    await until("a brighter colour", async () => (await color()) !== before);
    const bright = await color();
    await page.getByLabel("Tone map").selectOption({ index: 1 });
    await until("another tone", async () => (await color()) !== bright);
    assert.equal(await page.locator("#tree li[data-is-old]").count(), 1);
    assert.deepEqual(errors, []);
    await context.close();
});

test("the words at the plot of samples do not overlap", async () => {
    // Twelve depths or less have a tick each, of more the last may have one.
    const deep = await serve(join(SCENES, "cornell.toml"), ["--width", "60", "--height", "60", "--samples", "8"]);
    const { page, context, errors } = await open(browser, deep.url);
    await inspect(page, 30, 40);
    await page.locator(".scatter").waitFor();
    await page.locator(".scatter").scrollIntoViewIfNeeded();
    await screenshot(page, "scatter");
    const overlaps = await page.locator(".scatter").evaluate((plot) => {
        const texts = [...plot.querySelectorAll("text")];
        const unit = texts.find(({ textContent }) => textContent === "bounces").getBBox();
        return texts.map((text) => [text.textContent, text.getBBox()]).filter(([name, box]) => name !== "bounces" && box.y + box.height > unit.y + 3 && box.y < unit.y + unit.height && /^\d+$/.test(name) && box.x > 50).map(([name]) => name);
    });
    assert.deepEqual(overlaps, []);
    assert.deepEqual(errors, []);
    await context.close();
    await deep.stop();
});

test("the exercise of the notes: M_vw = I", async () => {
    const { page, context, errors } = await open(browser, server.url);
    await inspect(page, 50, 90);
    await page.getByRole("tab", { name: "Notes, alive" }).click();
    await page.getByLabel("Lesson").selectOption({ label: "3. The exercise: M_vw = I" });
    assert.match((await page.locator("#exercise-verdict").textContent()) ?? "", /^M_vw = I/);
    await page.locator("#picture-overlay").focus();
    await page.keyboard.press("ArrowLeft");
    await until("another camera's matrix", async () => /not the identity/.test((await page.locator("#exercise-verdict").textContent()) ?? ""));
    await page.getByRole("button", { name: "Look from there" }).click();
    await until("the identity again", async () => /^M_vw = I/.test((await page.locator("#exercise-verdict").textContent()) ?? ""));
    assert.deepEqual(errors, []);
    await context.close();
});

test("each step of the course has something to drag, by keys too", async () => {
    const { page, context, errors } = await open(browser, server.url);
    await inspect(page, 120, 80);
    await page.getByRole("tab", { name: "Notes, alive" }).click();
    const text = () => page.locator(".lesson").evaluate((lesson) => lesson.textContent + [...lesson.querySelectorAll("svg")].map((figure) => figure.innerHTML).join());
    for (let lesson = 0; lesson < 8; lesson++) {
        await page.getByLabel("Lesson").selectOption(String(lesson));
        const before = await text();
        await page.locator('.lesson [role="slider"], .lesson input[type="range"]').first().press("ArrowLeft");
        await until(`step ${lesson + 1} changes`, async () => (await text()) !== before);
    }
    // The sphere of step 5, off its ray and back to its origin.
    await page.getByLabel("Lesson").selectOption({ label: "5. A ray and a sphere" });
    // A new depth has asked for the sample anew; its answer draws the step again.
    await until("the step rests", async () => {
        const before = await text();
        await new Promise((resolve) => setTimeout(resolve, 500));
        return (await text()) === before && (await page.locator("body:not(.is-tracing) #picture[data-done=true]").count()) === 1;
    });
    const box = await page.getByRole("slider", { name: "The centre of the sphere" }).boundingBox();
    const drag = async (right, down) => {
        const [x, y] = [box.x + box.width / 2, box.y + box.height / 3];
        await page.mouse.move(x, y);
        await page.mouse.down();
        await page.mouse.move(x + right, y + down, { steps: 3 });
        await page.mouse.up();
    };
    const words = () => page.locator(".lesson .number.centred").textContent();
    assert.match((await words()) ?? "", /two roots, the nearer one counts/);
    await drag(0, -90);
    await until("the ray misses", async () => /no real root/.test((await words()) ?? ""));
    await drag(-box.width, 90);
    await until("the sphere is at the origin", async () => /the origin is in the sphere|behind the origin/.test((await words()) ?? ""));
    // The camera of step 3, which the picture follows.
    await page.getByLabel("Lesson").selectOption({ label: "3. The exercise: M_vw = I" });
    const verdict = page.locator("#exercise-verdict");
    await page.getByRole("button", { name: "Look from there" }).click();
    await until("the identity", async () => /^M_vw = I/.test((await verdict.textContent()) ?? ""));
    const shown = await pictureHash(page);
    await page.getByRole("slider", { name: "Direction of the camera" }).press("ArrowRight");
    assert.match((await verdict.textContent()) ?? "", /not the identity/);
    await until("another picture", async () => (await pictureHash(page)) !== shown);
    assert.deepEqual(errors, []);
    await context.close();
});

test("the lesson on fog: its exercise checks itself", async () => {
    const { page, context, errors } = await open(browser, server.url);
    await page.getByRole("tab", { name: "Notes, alive" }).click();
    await page.getByLabel("Lesson").selectOption({ label: "9. Beyond the notes: light through fog" });
    const verdict = page.locator("#medium-verdict");
    assert.match((await verdict.textContent()) ?? "", /too long/);
    const way = page.getByRole("slider", { name: "Length of the way through the medium" });
    await way.focus();
    // From 3 to 1.75, where exp(−0.4 · 1.75) is nearly a half.
    for (let step = 0; step < 25; step++) await page.keyboard.press("ArrowLeft");
    assert.match((await verdict.textContent()) ?? "", /ln2|ln 2/);
    for (let step = 0; step < 4; step++) await page.keyboard.press("ArrowLeft");
    assert.match((await verdict.textContent()) ?? "", /too short/);
    assert.deepEqual(errors, []);
    await context.close();
});

test("an exercise checks what is typed against the program's numbers", async () => {
    const { page, context, errors } = await open(browser, server.url);
    await inspect(page, 50, 90);
    await page.getByRole("tab", { name: "Notes, alive" }).click();
    const verdict = page.locator(".exercise .verdict");
    await page.getByLabel("rays", { exact: true }).fill("15");
    await page.getByRole("textbox", { name: "shadow rays" }).fill("31");
    await page.getByRole("button", { name: "Check" }).click();
    assert.equal(await verdict.textContent(), "Not yet: shadow rays.");
    await page.getByRole("textbox", { name: "shadow rays" }).fill("60/2");
    await page.getByRole("button", { name: "Check" }).click();
    assert.match((await verdict.textContent()) ?? "", /^Right/);
    // The exam: the axes of this camera, which looks along z.
    await page.getByLabel("Lesson").selectOption({ label: "3. The exercise: M_vw = I" });
    for (const [axis, numbers] of [["u", [1, 0, 0]], ["v", [0, 1, 0]], ["w", [0, 0, 1]]]) {
        for (const [i, number] of numbers.entries()) await page.getByLabel(`${axis} ${"xyz"[i]}`, { exact: true }).fill(String(number));
    }
    await page.getByRole("button", { name: "Check" }).click();
    assert.match((await verdict.textContent()) ?? "", /^Right/);
    // Each step that asks something knows its answer as a number.
    for (let lesson = 0; lesson < 8; lesson++) {
        await page.getByLabel("Lesson").selectOption(String(lesson));
        await page.getByRole("button", { name: "Show the program's" }).click();
        assert.doesNotMatch((await verdict.textContent()) ?? "", /NaN|undefined|Infinity/);
    }
    await page.emulateMedia({ media: "print" });
    await page.evaluate(() => window.dispatchEvent(new Event("beforeprint")));
    assert.equal(await page.locator(".lesson > section").count(), 9);
    assert.deepEqual(await Promise.all(["#scene-name", ".buttons", ".progress"].map((part) => page.locator(part).isVisible())), [true, false, false]);
    await screenshot(page, "print");
    assert.deepEqual(errors, []);
    await context.close();
});

test("a ray in smoke has a plot of the density with its collisions", async () => {
    const smoke = await serve(join(SCENES, "media.toml"), SMOKE);
    const { page, context, errors } = await open(browser, smoke.url);
    await inspect(page, 179, 75);
    await until("the sample is in the link", async () => /sample=\d+/.test(page.url()));
    const sample = Number(/sample=(\d+)/.exec(page.url())?.[1]);
    const said = await inspection(join(SCENES, "media.toml"), 179, 75, sample, SMOKE);
    const ray = said.rays.find(({ tracking }) => tracking?.profile && tracking.collisions.length > 0);
    // The row itself: what comes after the ray is inside of its item.
    await page.locator(`#ray-${ray.address}`).click({ position: { x: 60, y: 8 } });
    const plot = page.locator("#equations svg.density");
    await plot.waitFor();
    assert.equal(await plot.locator("circle").count(), ray.tracking.collisions.length);
    assert.deepEqual([await plot.locator("polyline.curve").count(), await plot.locator("polyline.stairs").count()], [1, 1]);
    await plot.scrollIntoViewIfNeeded();
    assert.deepEqual(errors, []);
    await screenshot(page, "density");
    await context.close();
    await smoke.stop();
});

test("in fog, the observer keeps the points of the fog in sight, and the legend has their colour", async () => {
    const fog = await serve(join(SCENES, "../docs/guide/scenes/media-fog.toml"), ["--size", "150x100", "--depth", "3", "--samples", "16"]);
    const { page, context, errors } = await open(browser, fog.url);
    await finished(page);
    await inspect(page, 75, 30);
    const rows = await page.locator("#samples tbody tr").evaluateAll((rows) => rows.map((row) => row.dataset.sample));
    const legend = () => page.locator("#rays-legend li:visible").allTextContents();
    const kinds = new Set();
    for (const sample of rows) {
        await page.locator(`#samples tr[data-sample="${sample}"] button`).click();
        await until("the sample's rays", async () => (await page.locator("#sample-summary h3 >> nth=0").textContent()) === `Sample ${sample}`);
        const drawn = await page.locator("#tree .kind").evaluateAll((marks) => marks.map((mark) => mark.classList[1]));
        const shown = await legend();
        assert.equal(shown.includes("scattered"), drawn.includes("scattered"), `${shown} of ${drawn}`);
        for (const kind of shown) kinds.add(kind);
    }
    assert.ok(kinds.has("scattered") && kinds.has("camera"), [...kinds].join());
    await page.waitForTimeout(1500);
    await screenshot(page, "fog");
    assert.deepEqual(errors, []);
    await context.close();
    await fog.stop();
});

test("an edit of the file reloads it, a broken one shows the error over the last picture", async () => {
    const { page, context, errors } = await open(browser, server.url);
    await finished(page);
    const before = await pictureHash(page);
    const text = await readFile(copy.scene, "utf8");
    await writeFile(copy.scene, text.replace("center = [-0.8, 0, 4]", "center = [-0.8, 0.5, 4]"));
    await until("the edited picture", async () => (await pictureHash(page)) !== before);
    await finished(page);
    const edited = await pictureHash(page);

    await writeFile(copy.scene, text.replace("radius = 1", "radius = one"));
    await page.locator("#failure").waitFor();
    assert.match((await page.locator("#failure pre").textContent()) ?? "", /radius = one[\s\S]*\^/);
    assert.equal(await pictureHash(page), edited);
    await screenshot(page, "error");

    await writeFile(copy.scene, text);
    await page.locator("#failure").waitFor({ state: "hidden" });
    await until("the first picture again", async () => (await pictureHash(page)) === before);
    assert.deepEqual(errors, []);
    await context.close();
});

test("two windows have views of their own", async () => {
    const [one, two] = [await open(browser, server.url), await open(browser, server.url)];
    await finished(one.page);
    await finished(two.page);
    const start = await pictureHash(one.page);
    assert.equal(await pictureHash(two.page), start);
    await two.page.locator("#picture-overlay").focus();
    await two.page.keyboard.press("ArrowRight");
    await until("the second moves", async () => (await pictureHash(two.page)) !== start);
    await finished(two.page);
    assert.equal(await pictureHash(one.page), start);
    assert.deepEqual([...one.errors, ...two.errors], []);
    await one.context.close();
    await two.context.close();
});

test("a scene with keyframes has a slider of time", async () => {
    const moving = await copyOf("notes-exercise.toml");
    const text = await readFile(moving.scene, "utf8");
    await writeFile(moving.scene, text.replace("radius = 1", "radius = { keyframes = [[0, 1], [2, 0.5]] }"));
    const server = await serve(moving.scene, SMALL);
    const { page, context, errors } = await open(browser, server.url);
    await finished(page);
    const start = await pictureHash(page);
    await page.getByRole("tab", { name: "View" }).click();
    const time = page.getByLabel("Time");
    assert.equal(await time.getAttribute("max"), "2");
    await time.fill("2");
    await until("another picture", async () => (await pictureHash(page)) !== start);
    await until("the time is in the link", async () => page.url().includes("at=2"));
    await time.fill("0");
    await until("the first picture again", async () => (await pictureHash(page)) === start);
    assert.deepEqual(errors, []);
    await context.close();
    await server.stop();
    await moving.remove();
});

test("a slow network delays pictures and breaks nothing", async () => {
    const { page, context, errors } = await open(browser, server.url);
    await finished(page);
    const start = await pictureHash(page);
    const session = await context.newCDPSession(page);
    await session.send("Network.enable");
    await session.send("Network.emulateNetworkConditions", { offline: false, latency: 200, downloadThroughput: 60_000, uploadThroughput: 30_000 });
    await page.locator("#picture-overlay").focus();
    for (let i = 0; i < 10; i++) await page.keyboard.press("ArrowRight");
    await until("another picture", async () => (await pictureHash(page)) !== start);
    for (let i = 0; i < 10; i++) await page.keyboard.press("ArrowLeft");
    await until("the way back", async () => (await pictureHash(page)) !== start);
    await inspect(page, 50, 90);
    assert.deepEqual(errors, []);
    await context.close();
});

test("a hand that moves the camera sees no messages of the inside", async () => {
    const { page, context, errors } = await open(browser, server.url);
    await finished(page);
    await page.evaluate(() => {
        window.toasts = [];
        new MutationObserver(() => window.toasts.push(document.getElementById("toast").textContent)).observe(document.getElementById("toast"), { childList: true });
    });
    await inspect(page, 50, 90);
    const at = await placeOf(page, 60, 60);
    for (let round = 0; round < 4; round++) {
        await page.mouse.move(at.x, at.y);
        await page.mouse.down();
        for (let i = 0; i < 30; i++) await page.mouse.move(at.x + 3 * i, at.y + i);
        await page.mouse.up();
        for (let i = 0; i < 30; i++) {
            await page.mouse.move(at.x + 2 * i, at.y - i);
            await page.waitForTimeout(15);
        }
    }
    await finished(page);
    assert.deepEqual(await page.evaluate(() => window.toasts), []);
    assert.deepEqual(errors, []);
    await context.close();
});

test("a picture may be larger than the scene's, and formulas fit the panel", async () => {
    const { page, context, errors } = await open(browser, server.url, { viewport: { width: 1440, height: 900 } });
    await finished(page);
    const width = () => page.locator("#picture").evaluate((canvas) => canvas.width);
    const own = await width();
    await page.getByRole("tab", { name: "View" }).click();
    const options = await page.getByLabel("Size").locator("option").allTextContents();
    assert.ok(options.some((title) => title.includes("fits the window")), options.join());
    await page.getByLabel("Size").selectOption({ label: options.find((title) => title.includes("2 ×")) });
    await until("twice the width", async () => (await width()) === 2 * own);
    await finished(page);
    await page.getByRole("tab", { name: "Why this pixel" }).click();
    await inspect(page, 50, 90);
    await page.locator("#equations details").first().waitFor();
    const wide = await page.locator("#equations .math").evaluateAll((all) => all.filter((math) => math.scrollWidth > math.clientWidth + 1 && math.clientWidth > 0).map((math) => math.textContent));
    assert.deepEqual(wide, []);
    assert.deepEqual(errors, []);
    await context.close();
});
