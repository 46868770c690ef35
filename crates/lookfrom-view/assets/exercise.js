// An exercise that checks itself: numbers that are typed are compared with those of the program.

import { append, h, replace } from "./html.js";
import { short } from "./format.js";

/**
 * A question, with the numbers that answer it by their names.
 * @typedef {object} Exercise
 * @property {import("./html.js").Child[]} question
 * @property {[name: string, value: number][]} answers
 * @property {string} solution What is said when all are right.
 */

/** The relative error that counts as right: three digits. */
const TOLERANCE = 5e-3;

/** @param {number} typed @param {number} wanted */
export const isRight = (typed, wanted) => Math.abs(typed - wanted) <= TOLERANCE * Math.max(Math.abs(wanted), 1e-6) || (wanted === 0 && Math.abs(typed) < 1e-9);

/** A number as people type it: with a point or a comma, or as a fraction. @param {string} text */
export function numberOf(text) {
    const [above, below = "1", ...rest] = text.trim().replace("−", "-").replaceAll(",", ".").split("/");
    return above === "" || below === "" || rest.length > 0 ? NaN : Number(above) / Number(below);
}

/** @param {Exercise} exercise */
export function exerciseForm({ question, answers, solution }) {
    const verdict = h("p", { class: "verdict", role: "status" });
    const inputs = answers.map(([name]) => h("input", { type: "text", inputmode: "decimal", autocomplete: "off", size: 9, "aria-label": name }));
    const check = (/** @type {Event} */ event) => {
        event.preventDefault();
        const typed = inputs.map((input) => numberOf(input.value));
        const right = answers.map(([, wanted], i) => isRight(typed[i], wanted));
        inputs.forEach((input, i) => input.setAttribute("aria-invalid", String(!right[i])));
        const all = right.every(Boolean);
        verdict.classList.toggle("good", all);
        const wrong = answers.filter((_, i) => !right[i]).map(([name]) => name);
        replace(verdict, all ? `Right. ${solution}` : `Not yet: ${wrong.join(", ")}.`);
    };
    const reveal = () => {
        verdict.classList.remove("good");
        replace(verdict, `The program has ${answers.map(([name, wanted]) => `${name} = ${short(wanted, 5)}`).join(", ")}.`);
    };
    const form = h("form", { class: "exercise", onsubmit: check }, h("h4", {}, "Exercise"));
    append(form, [h("p", {}, ...question),
        h("div", { class: "answers" }, answers.map(([name], i) => h("label", {}, h("span", { "aria-hidden": "true" }, name), inputs[i]))),
        h("div", { class: "row" }, h("button", {}, "Check"), h("button", { type: "button", onclick: reveal }, "Show the program's")), verdict]);
    return form;
}
