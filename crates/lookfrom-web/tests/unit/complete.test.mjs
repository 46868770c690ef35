// Completion in texts of scenes, each with its caret as "|".

import assert from "node:assert/strict";
import { test } from "node:test";
import { completions } from "../../assets/complete.js";

const TABLES = [
    { title: "a scene", keys: ["import", "variables", "camera", "materials", "textures", "objects", "light", "sphere", "solid"] },
    { title: "[camera]", keys: ["lookfrom", "lookat", "up", "fov", "window"] },
    { title: "window", keys: ["x", "y"] },
    { title: "a picture", keys: ["file", "layer"] },
    { title: "keyframes", keys: ["keyframes", "interpolation"] },
    { title: "[objects.NAME]", keys: ["sphere", "solid"] },
    { title: "[[sphere]]", keys: ["center", "radius", "material"] },
    { title: "[[solid]]", keys: ["operation", "of"] },
    { title: "[[solid.of]]", keys: ["type", "material"] },
    { title: "[materials.NAME] whitted", keys: ["type", "diffuse", "specular"] },
    { title: "[materials.NAME] dielectric", keys: ["type", "ior"] },
    { title: "[textures.NAME] image", keys: ["type", "file", "wrap"] },
    { title: "[[light]] point", keys: ["type", "position", "power"] },
    { title: "[[light]] distant", keys: ["type", "direction"] },
];

/** The text after the first completion, or all of them. @param {string} text */
function of(text) {
    const caret = text.indexOf("|");
    const found = completions(TABLES, text.replace("|", ""), caret);
    return found && { options: found.options, first: text.slice(0, found.from) + found.options[0] + text.replace("|", "").slice(found.to) };
}

test("keys of the table of the caret, without those that it has", () => {
    for (const [text, options] of [
        ["[camera]\nlookfrom = [0, 1, 5]\nlo|", ["lookat = "]],
        ["[camera]\nlo|\nlookfrom = [\n0, 1, # the eye\n5]", ["lookat = "]],
        ["[camera]\nlook|from = 1", ["lookat"]],
        ["camera = { fov = 30, lo|", ["lookfrom = ", "lookat = "]],
        ["camera = { fov = 30, | }", ["lookfrom = ", "lookat = ", "up = ", "window = "]],
        ["camera.fo|", ["fov = "]],
        ["[camera]\nwindow = { x = [0, 1], |", ["y = "]],
        ["[camera]\nwindow.|", ["x = ", "y = "]],
        ["[[sphere]]\nra|", ["radius = "]],
        ["[[objects.tree.sphere]]\nra|", ["radius = "]],
        ["sphere = [{ radius = 1 }, { radius = 2, c|", ["center = "]],
        ["[[solid.of]]\nm|", ["material = ", "[materials.NAME]"]],
        ["solid = [{ of = [{ type = \"box\", m|", ["material = "]],
        ["[[sphere]]\nradius = { i|", ["interpolation = "]],
        ["[materials.red]\ndiffuse = { type = \"image\", w|", ["wrap = "]],
    ]) assert.deepEqual(of(text)?.options, options, text);
});

test("where the type is known, keys of that type; else of all", () => {
    assert.deepEqual(of("[materials.glass]\ntype = \"dielectric\"\ni|")?.options, ["ior = "]);
    assert.deepEqual(of("[materials.glass]\nd|\ntype = \"whitted\"")?.options, ["diffuse = "]);
    assert.equal(of("[materials.glass]\ntype = \"dielectric\"\nd|"), null);
    assert.deepEqual(of("[[light]]\n|")?.options.slice(0, 4), ["type = ", "position = ", "power = ", "direction = "]);
    assert.deepEqual(of("light = [{ type = \"point\", p|")?.options, ["position = ", "power = "]);
});

test("names of tables, in brackets or without", () => {
    assert.equal(of("[ca|")?.first, "[camera]");
    assert.equal(of("a = 1\n[[li|]]\nx = 2")?.first, "a = 1\n[[light]]\nx = 2");
    assert.equal(of("[mat|")?.first, "[materials.NAME]");
    assert.equal(of("sph|")?.first, "[[sphere]]");
    assert.equal(of("[camera]\nfov = 3\nlig|")?.first, "[camera]\nfov = 3\n[[light]]");
    assert.equal(of("im|")?.first, "import = ");
    assert.equal(of("[var|")?.first, "[variables]");
});

test("words in quotes: types, and names that the text defines", () => {
    assert.deepEqual(of("[[light]]\ntype = \"|\"")?.options, ["point", "distant"]);
    assert.deepEqual(of("[[light]]\ntype = \"di|\nposition = 3")?.first, "[[light]]\ntype = \"distant\nposition = 3");
    assert.deepEqual(of("[materials.red]\n[materials.glass]\n[[sphere]]\nmaterial = \"|")?.options, ["red", "glass"]);
    assert.equal(of("[[sphere]]\nradius = 1|"), null);
});

test("nothing in comments, in other values and in tables of one's own names", () => {
    for (const text of ["# ca|", "[camera]\nfov = 3 # lo|", "[camera]\nlookfrom = [|", "[camera]\nfov = |", "[variables]\nra|", "name = \"\"\"\nca|"]) assert.equal(of(text), null, text);
    for (let length = 0; length < 60; length++) completions(TABLES, "[[[a.\"]]={[{'''\n#}=\"\"\"x]].,\n\\[materials.][{}]".slice(0, length), length);
});
