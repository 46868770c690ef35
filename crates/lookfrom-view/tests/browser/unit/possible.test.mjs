// What a scene has of a view, without a browser.

import assert from "node:assert/strict";
import { test } from "node:test";
import { possible } from "../../../assets/possible.js";
import { SCENES_OWN } from "../../../assets/state.js";

const scene = { integrators: ["path"], tonemaps: ["srgb"], layers: [{ name: "color" }, { name: "albedo" }], variants: ["red"], animations: [{ name: "", seconds: 1 }], reference: null };

test("what the scene lacks is left out, and told", () => {
    const link = { ...SCENES_OWN, depth: 3, integrator: "none", tonemap: "none", layer: "foo", variant: "blue", animation: 1, compare: "wipe" };
    const { view, absent } = possible(link, scene);
    assert.deepEqual(view, { ...SCENES_OWN, depth: 3 });
    assert.deepEqual(absent.sort(), ["animation 1", "compare wipe", "integrator none", "layer foo", "tonemap none", "variant blue"]);
});

test("what the scene has stays", () => {
    const link = { ...SCENES_OWN, integrator: "path", tonemap: "srgb", layer: "albedo", variant: "red", animation: 0, compare: "wipe" };
    assert.deepEqual(possible(link, { ...scene, reference: "reference.exr" }), { view: link, absent: [] });
});
