// The page without a server: the scenes that it holds, files that are dropped on it, and a worker that renders.

import { byId, h } from "../../lookfrom-view/assets/html.js";
import { showPage } from "../../lookfrom-view/assets/page.js";
import { connect } from "../../lookfrom-view/assets/socket.js";
import { SCENES_OWN } from "../../lookfrom-view/assets/state.js";
import { filesOfDrop, filesOfList, isPicture, sceneOf } from "./dropped.js";
import { addEditorTab, attachEditor } from "./editor.js";
import { examples, program, workerScript } from "./embedded.js";
import { linked, ofExample, ofText } from "./link.js";
import { workerTransport } from "./worker-transport.js";

/** @typedef {import("./worker-transport.js").File} File */

/** The first scene: the one of the notes. */
const FIRST = "scenes/notes-exercise.toml";

const worker = workerTransport(program(), workerScript());
const linkedScene = linked(location.hash);
addEditorTab();
const app = showPage(connect(worker));
const held = await examples();
const editor = attachEditor(app, (path, text) => {
    const bytes = new TextEncoder().encode(text);
    worker.change([{ path, bytes }]);
    choice.value = "";
    keepLink(path, bytes);
});

/** Says in the link which scene it is. @param {string} path @param {Uint8Array<ArrayBuffer>} bytes */
async function keepLink(path, bytes) {
    app.source.set(await ofText(path, bytes, isHeld || worker.count() === 1));
}
/** Whether all files of the scene, but its own text, are held by the page. */
let isHeld = false;

/** Opens a scene. @param {string} path @param {File[]} files @param {boolean} keepsView */
function open(path, files, keepsView) {
    if (!keepsView) {
        app.pixel.set(null);
        app.view.reset({ ...SCENES_OWN });
    }
    worker.openScene(path, files);
    editor.open(path, files.find((file) => file.path === path)?.bytes ?? new Uint8Array());
}

/** Opens a scene that the page holds. @param {string} path @param {boolean} keepsView */
function openExample(path, keepsView) {
    isHeld = true;
    open(path, held.files, keepsView);
    choice.value = path;
    app.source.set(path === FIRST ? "" : ofExample(path));
}

/** Opens what was dropped: a scene, what one lacks, or a picture to compare with. @param {File[]} files */
function take(files) {
    const scene = sceneOf(files);
    const isBroken = !byId("failure").hidden;
    // A model is what the scene lacks where the failure names it.
    const isLacking = isBroken && files.some(({ path }) => byId("failure").textContent?.includes(path.split("/").at(-1) ?? path));
    if (scene !== null && !isLacking) {
        isHeld = false;
        open(scene, files, false);
        choice.value = "";
        return keepLink(scene, files.find((file) => file.path === scene)?.bytes ?? new Uint8Array());
    }
    if (files.length === 1 && isPicture(files[0].path) && !isBroken && app.scene.get() !== null) {
        app.toast(`${files[0].path} can be compared with, under View`);
        return worker.compareWith(files[0]);
    }
    if (files.length === 0) return;
    worker.change(files);
    return keepLink(worker.scene(), worker.file(worker.scene())?.bytes ?? new Uint8Array());
}

const groups = [...new Set(held.scenes.map(({ group }) => group))];
const choice = h("select", { id: "examples", "aria-label": "Scene", onchange: () => openExample(choice.value, false) },
    h("option", { value: "", disabled: true }, "Scenes"),
    groups.map((group) => h("optgroup", { label: group }, held.scenes.filter((scene) => scene.group === group).map(({ path, title }) => h("option", { value: path }, title)))));
const chooser = h("input", { type: "file", multiple: true, hidden: true, onchange: () => void (chooser.files && filesOfList(chooser.files).then(take, app.complain)) });
byId("pause").before(choice, h("button", { type: "button", id: "open", onclick: () => chooser.click() }, "Open …"), chooser);

document.addEventListener("dragover", (event) => event.preventDefault());
document.addEventListener("drop", (event) => {
    event.preventDefault();
    if (event.dataTransfer) filesOfDrop(event.dataTransfer).then(take, app.complain);
});

/** Opens what the link says. @param {import("./link.js").Linked | null} said */
function openLinked(said) {
    if (said && "text" in said) {
        const bytes = new TextEncoder().encode(said.text);
        // What it names may be held by the page.
        isHeld = true;
        open(said.path, [...held.files, { path: said.path, bytes }], true);
        choice.value = "";
        return keepLink(said.path, bytes);
    }
    if (said && "absent" in said) app.toast(`The link is of ${said.absent}, which is not in it: drop that file on the page`);
    openExample(said && "example" in said && held.scenes.some(({ path }) => path === said.example) ? said.example : FIRST, true);
}
openLinked(await linkedScene);
window.addEventListener("hashchange", async () => {
    const said = await linked(location.hash);
    const path = said && "example" in said ? said.example : FIRST;
    if (said === null || "example" in said ? path !== worker.scene() : "text" in said) openLinked(said);
});
