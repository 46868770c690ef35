// The lecture notes, alive: each lesson shows the numbers of the selected pixel, and can be moved by hand.

import { byId, h, replace } from "./html.js";
import { cameraLesson } from "./lesson-camera.js";
import { triangleLesson } from "./lesson-triangle.js";
import { sphereLesson } from "./lesson-sphere.js";
import { fresnelLesson } from "./lesson-fresnel.js";
import { treeLesson } from "./lesson-tree.js";
import { exerciseLesson } from "./lesson-exercise.js";
import { mediumLesson } from "./lesson-medium.js";

/** @typedef {import("./app.js").App} App */
/** @typedef {{element: HTMLElement, show: () => void}} Lesson */

/** @type {readonly [string, (app: App) => Lesson][]} */
const LESSONS = [
    ["From the pixel to the world", cameraLesson],
    ["The exercise: M_vw = I", exerciseLesson],
    ["A ray and a triangle", triangleLesson],
    ["A ray and a sphere", sphereLesson],
    ["Snell and Fresnel", fresnelLesson],
    ["The tree, and its sum", treeLesson],
    ["Light through fog", mediumLesson],
];

/** @param {App} app */
export function showNotes(app) {
    const place = byId("notes");
    const lessons = LESSONS.map(([, create]) => create(app));
    const body = h("div", { class: "lesson" });
    let chosen = 0;
    const choice = h("select", { "aria-label": "Lesson" }, LESSONS.map(([title], i) => h("option", { value: i }, `${i + 1}. ${title}`)));
    const next = h("button", { type: "button", onclick: () => choose((chosen + 1) % LESSONS.length) }, "Next");
    choice.addEventListener("change", () => choose(Number(choice.value)));

    /** @param {number} lesson */
    function choose(lesson) {
        chosen = lesson;
        choice.value = String(lesson);
        replace(body, lessons[lesson].element);
        lessons[lesson].show();
    }
    const show = () => {
        if (!place.hidden) lessons[chosen].show();
    };
    replace(place, h("div", { class: "row" }, choice, next), body);
    choose(0);
    for (const signal of [app.inspection, app.ray, app.scene, app.pixel]) signal.on(show);
    return { show };
}

/** What stands where no pixel is selected. */
export const noPixel = () => h("p", { class: "hint" }, "Select a pixel of the picture first: click it, or press I in the picture.");
