// The lecture notes, alive: a course of eight steps in the notes' order, each with something to drag and an exercise, and one step beyond.

import { exerciseForm } from "./exercise.js";
import { ofCamera, ofExam, ofFresnel, ofGenerations, ofSphere, ofTrap, ofTree, ofTriangle } from "./exercises.js";
import { byId, h, replace } from "./html.js";
import { cameraLesson } from "./lesson-camera.js";
import { exerciseLesson } from "./lesson-exercise.js";
import { fresnelLesson } from "./lesson-fresnel.js";
import { generationsLesson } from "./lesson-generations.js";
import { mediumLesson } from "./lesson-medium.js";
import { sphereLesson } from "./lesson-sphere.js";
import { trapLesson } from "./lesson-trap.js";
import { treeLesson } from "./lesson-tree.js";
import { triangleLesson } from "./lesson-triangle.js";

/** @typedef {import("./app.js").App} App */
/** @typedef {{element: HTMLElement, show: () => void, leave?: () => void}} Lesson */
/** @typedef {(app: App) => import("./exercise.js").Exercise | null} Question */

/** @type {readonly [title: string, lesson: (app: App) => Lesson, question?: Question][]} */
const LESSONS = [
    ["Two generations", generationsLesson, ofGenerations],
    ["From the pixel to the world", cameraLesson, ofCamera],
    ["The exercise: M_vw = I", exerciseLesson, ofExam],
    ["A ray and a triangle", triangleLesson, ofTriangle],
    ["A ray and a sphere", sphereLesson, ofSphere],
    ["The numerical trap", trapLesson, ofTrap],
    ["Snell and Fresnel", fresnelLesson, ofFresnel],
    ["The tree, and its sum", treeLesson, ofTree],
    ["Beyond the notes: light through fog", mediumLesson],
];

/** @param {App} app */
export function showNotes(app) {
    const place = byId("notes");
    const lessons = LESSONS.map(([title, create, question], i) => withExercise(app, `${i + 1}. ${title}`, create(app), question));
    const body = h("div", { class: "lesson" });
    let chosen = 0;
    const choice = h("select", { "aria-label": "Lesson" }, LESSONS.map(([title], i) => h("option", { value: i }, `${i + 1}. ${title}`)));
    const next = h("button", { type: "button", onclick: () => choose((chosen + 1) % LESSONS.length) }, "Next");
    choice.addEventListener("change", () => choose(Number(choice.value)));

    /** @param {number} lesson */
    function choose(lesson) {
        leave();
        chosen = lesson;
        choice.value = String(lesson);
        replace(body, lessons[lesson].element);
        lessons[lesson].show();
    }
    const show = () => {
        if (!place.hidden) lessons[chosen].show();
    };
    const leave = () => lessons[chosen].leave?.();
    // On paper there is the whole course.
    window.addEventListener("beforeprint", () => {
        if (place.hidden) return;
        replace(body, lessons.map(({ element }) => element));
        for (const lesson of lessons) lesson.show();
    });
    window.addEventListener("afterprint", () => choose(chosen));
    const print = h("button", { type: "button", onclick: () => window.print() }, "Print");
    replace(place, h("h2", { class: "unseen" }, "Notes, alive"), h("div", { class: "row" }, choice, next, print), body);
    choose(0);
    for (const signal of [app.inspection, app.ray, app.scene, app.pixel]) signal.on(show);
    return { show, leave };
}

/**
 * A lesson with its title, and its exercise below.
 * @param {App} app
 * @param {string} title
 * @param {Lesson} lesson
 * @param {Question} [question]
 * @returns {Lesson}
 */
function withExercise(app, title, lesson, question) {
    const exercise = h("div");
    const element = h("section", { "aria-label": title }, h("h3", {}, title), lesson.element, exercise);
    let before = "";
    function show() {
        lesson.show();
        const asked = question?.(app) ?? null;
        // What has been typed stays while the numbers do.
        const now = JSON.stringify(asked?.answers ?? null);
        if (now === before) return;
        before = now;
        replace(exercise, asked && exerciseForm(asked));
    }
    return { element, show, leave: lesson.leave };
}
