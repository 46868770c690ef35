// A server that is not there for a while, and one that has no scene yet.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { mkdtemp, readFile, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { SCENES, finished, inspect, launch, open, placeOf, screenshot, serve, until, visit } from "./browser.mjs";

const SCENE = join(SCENES, "notes-exercise.toml");
const SMALL = ["--width", "160", "--height", "160", "--samples", "4"];
let browser, server;

before(async () => {
    browser = await launch();
    server = await serve(SCENE, SMALL);
});
after(async () => {
    await browser?.close();
    await server?.stop();
});

/** A way to the server that can be cut. */
function wire() {
    let isCut = false;
    const ends = new Set();
    return {
        prepare: (page) => page.routeWebSocket(/\/socket/, (socket) => {
            if (isCut) return socket.close();
            const there = socket.connectToServer();
            ends.add(() => {
                socket.close();
                there.close();
            });
        }),
        cut() {
            isCut = true;
            for (const end of ends) end();
            ends.clear();
        },
        mend: () => void (isCut = false),
    };
}

/** The errors of the page: what was on its way to the server when the wire was cut, the wire itself complains of. */
const ofPage = (errors) => errors.filter((text) => !text.includes("CLOSING or CLOSED"));

const toast = (page) => page.locator("#toast").textContent();

test("what is asked for without a connection is told, and a pixel is traced when it is back", async () => {
    const { prepare, cut, mend } = wire();
    const { page, context, errors } = await open(browser, server.url, {}, prepare);
    await finished(page);
    await page.evaluate(() => {
        window.toasts = [];
        new MutationObserver(() => window.toasts.push(document.getElementById("toast").textContent)).observe(document.getElementById("toast"), { childList: true });
    });
    const pause = page.locator("#pause");
    await pause.click();
    assert.equal(await pause.getAttribute("aria-label"), "Continue rendering");
    cut();
    await page.locator("body.is-offline").waitFor();
    await page.getByText("Share").click();
    await page.getByRole("button", { name: "Save PNG" }).click();
    await until("a word", async () => /no connection/i.test((await toast(page)) ?? ""));
    const place = await placeOf(page, 50, 90);
    await page.mouse.click(place.x, place.y);
    await until("why there is no answer", async () => /no connection/.test((await page.locator("#pixel-summary").textContent()) ?? ""));
    await screenshot(page, "offline");
    mend();
    await page.locator("#pixel-summary .numbers").waitFor();
    await page.locator("#tree li").first().waitFor();
    assert.deepEqual([await pause.getAttribute("aria-label"), await pause.getAttribute("aria-pressed")], ["Pause rendering", "false"]);
    assert.deepEqual(await page.evaluate(() => window.toasts), ["There is no connection"]);
    assert.deepEqual(ofPage(errors), []);
    await context.close();
});

test("a pixel that is shown stays when the connection comes back", async () => {
    const { prepare, cut, mend } = wire();
    const { page, context, errors } = await open(browser, server.url, {}, prepare);
    await inspect(page, 50, 90);
    await page.locator("#pixel-summary .numbers").waitFor();
    await page.evaluate(() => document.getElementById("pixel-summary").firstChild.setAttribute("data-is-old", ""));
    cut();
    await page.locator("body.is-offline").waitFor();
    mend();
    await page.locator("#pixel-summary .numbers:not([data-is-old])").waitFor();
    assert.equal(await toast(page), "");
    assert.deepEqual(ofPage(errors), []);
    await context.close();
});

test("a server that was started anew is told as such, and each news once", async () => {
    const first = await serve(SCENE, SMALL);
    const { page, context } = await open(browser, first.url);
    await finished(page);
    await page.evaluate(() => {
        window.said = [];
        const place = document.getElementById("announcements");
        new MutationObserver(() => window.said.push(place.textContent)).observe(place, { childList: true });
    });
    await first.stop();
    await page.locator("body.is-offline").waitFor();
    await page.waitForTimeout(2000);
    const second = await serve(SCENE, SMALL, new URL(first.url).port);
    await until("the reason", async () => /started anew/.test((await page.locator("#progress-text").textContent()) ?? ""));
    assert.deepEqual(await page.evaluate(() => window.said), ["The server is not there; trying again …", "The server was started anew: open the address that it has printed."]);
    await page.goto(second.url);
    await finished(page);
    assert.equal(await page.locator("body.is-offline").count(), 0);
    await context.close();
    await second.stop();
});

test("a window too many is told why it is empty, and shows the scene when another one is closed", async () => {
    const server = await serve(SCENE, SMALL);
    const { page: first, context: others } = await open(browser, server.url);
    // Fifteen more.
    await first.evaluate(() => {
        const url = `ws://${location.host}/socket${location.search}`;
        window.sockets = Array.from({ length: 15 }, () => new WebSocket(url));
        return Promise.all(window.sockets.map((socket) => new Promise((resolve) => (socket.onopen = resolve))));
    });
    let attempts = 0;
    const { page, context } = await visit(browser, server.url, {}, async (page) => void page.on("websocket", () => attempts++));
    await until("the reason", async () => (await page.locator("#progress-text").textContent()) === "16 windows are open: close one");
    assert.ok(await page.locator("#failure").isHidden());
    await page.waitForTimeout(4000);
    assert.ok(attempts <= 6, `${attempts} attempts`);
    await first.evaluate(() => window.sockets[0].close());
    await page.locator("body.has-picture").waitFor();
    assert.equal(await page.locator("body.is-offline").count(), 0);
    await context.close();
    await others.close();
    await server.stop();
});

test("while there is no file, the header says that there is no scene", async () => {
    const folder = await mkdtemp(join(tmpdir(), "lookfrom-view-"));
    const scene = join(folder, "later.toml");
    const server = await serve(scene, SMALL);
    const { page, context, errors } = await visit(browser, server.url);
    await page.locator("#failure").waitFor();
    assert.deepEqual([await page.locator("#scene-name").textContent(), await page.title()], ["no scene", "no scene · lookfrom"]);
    await writeFile(scene, await readFile(SCENE, "utf8"));
    await page.locator("body.has-picture").waitFor();
    await page.locator("#failure").waitFor({ state: "hidden" });
    assert.deepEqual([await page.locator("#scene-name").textContent(), await page.title()], ["later.toml", "later.toml · lookfrom"]);
    assert.deepEqual(errors, []);
    await context.close();
    await server.stop();
    await rm(folder, { recursive: true, force: true });
});
