// The screenshots of docs/guide/view.md: LOOKFROM_BINARY=… LOOKFROM_SHARED=… CHROMIUM=… node pictures.mjs [why exercise 360 error firefly]
//
// All, or those that are named. Pictures of noise are large files: `pngquant --force --ext .png docs/guide/img/view-*.png` makes them
// small. The story of the firefly in view.md tells the numbers that its screenshots show: where they change, it does.

import { readFile, writeFile } from "node:fs/promises";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { SCENES, copyOf, inspect, launch, open, serve } from "./browser.mjs";

const FOLDER = join(dirname(fileURLToPath(import.meta.url)), "../../../../docs/guide/img");
const DONE = '#picture[data-done="true"]';

const browser = await launch();

/** Serves a scene, and calls `visit` with its page, if its pictures are wanted. */
async function at(name, scene, options, size, visit) {
    if (process.argv.length > 2 && !process.argv.includes(name)) return;
    const server = await serve(scene, options);
    const { page, context, errors } = await open(browser, server.url, { viewport: { width: size[0], height: size[1] }, colorScheme: size[2] ?? "dark" });
    page.setDefaultTimeout(600_000);
    await page.locator(DONE).waitFor();
    await visit(page, (name) => page.screenshot({ path: join(FOLDER, `view-${name}.png`) }));
    if (errors.length > 0) throw new Error(errors.join("\n"));
    await context.close();
    await server.stop();
}

/** Waits until the second view has come, and shows the panel from an element on. */
async function settle(page, selector) {
    await page.mouse.move(5, 790);
    await page.waitForTimeout(4000);
    if (selector) await page.locator(selector).evaluate((element) => element.scrollIntoView({ block: "start" }));
    await page.waitForTimeout(300);
}

await at("why", join(SCENES, "cornell.toml"), ["--size", "400x400", "--samples", "32"], [1280, 800, "light"], async (page, keep) => {
    await inspect(page, 271, 262);
    await settle(page);
    await keep("why");
});

await at("exercise", join(SCENES, "notes-exercise.toml"), ["--size", "400x400"], [1280, 640, "light"], async (page, keep) => {
    await inspect(page, 275, 200);
    await page.getByRole("tab", { name: "Notes, alive" }).click();
    await page.getByLabel("Lesson").selectOption("2");
    await settle(page, "#exercise svg");
    await keep("exercise");
});

await at("360", join(SCENES, "glass-and-mirror.toml"), ["--size", "320x240", "--samples", "16"], [360, 740], async (page, keep) => {
    await inspect(page, 120, 150);
    await settle(page);
    await keep("360");
});

const copy = await copyOf("notes-exercise.toml");
await at("error", copy.scene, ["--size", "400x400"], [900, 420], async (page, keep) => {
    await writeFile(copy.scene, (await readFile(copy.scene, "utf8")).replace("radius = 1", "radius = one"));
    await page.locator("#failure").waitFor();
    // The name of a temporary folder says nothing.
    await page.locator("#failure p").first().evaluate((element) => (element.textContent = element.textContent.replace(/\S*\/notes/, "scenes/notes")));
    await keep("error");
});
await copy.remove();

if (process.env.LOOKFROM_SHARED) {
    const scene = join(process.env.LOOKFROM_SHARED, "scenes/veach-bidir/scene.pbrt");
    await at("firefly", scene, ["--size", "200x200", "--samples", "32"], [1280, 800], async (page, keep) => {
        await inspect(page, 97, 102);
        await settle(page);
        await keep("firefly-1");
        await page.locator('.scatter circle.selected').click();
        await settle(page, "#sample-summary");
        await keep("firefly-2");
        await page.locator("#ray-2 > .ray").click();
        await settle(page, "#tree");
        await page.locator("#equations details", { hasText: "Sampled light" }).last().evaluate((element) => element.scrollIntoView({ block: "end" }));
        await keep("firefly-3");
    });
}
await browser.close();
