// The scene among files that are dropped.

import assert from "node:assert/strict";
import { test } from "node:test";
import { sceneOf } from "../../assets/dropped.js";

/** Files by their paths, with nothing in them but where there is a text. @param {Record<string, string>} texts */
const files = (texts) => Object.entries(texts).map(([path, text]) => ({ path, bytes: new TextEncoder().encode(text) }));

test("scenes come before models, and the least deep before others", () => {
    assert.equal(sceneOf(files({ "a/b.ply": "", "a/scene.pbrt.gz": "", "z.pbrt": "", "c.glb": "" })), "z.pbrt");
    assert.equal(sceneOf(files({ "bunny.ply.gz": "", "smoke.nvdb": "", "wood.png": "" })), "bunny.ply.gz");
    assert.equal(sceneOf(files({ "wood.png": "" })), null);
});

test("a text of XML is a scene if it is one of Mitsuba", () => {
    const scene = '<?xml version="1.0"?>\n<scene version="3.0.0">';
    assert.equal(sceneOf(files({ "scene.xml": scene, "mesh.ply": "" })), "scene.xml");
    assert.equal(sceneOf(files({ "pom.xml": "<project>", "mesh.ply": "" })), "mesh.ply");
});
