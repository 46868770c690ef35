// Labelled fields of forms.

import { h } from "./html.js";

let lastId = 0;

/**
 * A label beside its control.
 * @param {string} label
 * @param {HTMLElement} control
 * @param {string} [title]
 */
export function field(label, control, title) {
    control.id ||= `field-${++lastId}`;
    return h("div", { class: "field", title }, h("label", { for: control.id }, label), control);
}

/**
 * @param {readonly (readonly [value: string, title: string])[]} options
 * @param {string} value
 * @param {(value: string) => void} change
 * @param {string} [name] for screen readers, where there is no label
 */
export function select(options, value, change, name) {
    const element = h("select", { "aria-label": name }, options.map(([value, title]) => h("option", { value }, title)));
    element.value = value;
    element.addEventListener("change", () => change(element.value));
    return element;
}

/**
 * A number; empty means the scene's own.
 * @param {number | null} value
 * @param {{min?: number, max?: number, step?: number | string, placeholder?: string}} limits
 * @param {(value: number | null) => void} change
 */
export function number(value, limits, change) {
    const element = h("input", { type: "number", inputmode: "decimal", ...limits, step: limits.step ?? "any", value: value ?? "" });
    element.addEventListener("change", () => {
        if (element.value === "") return change(null);
        if (element.reportValidity()) change(element.valueAsNumber);
    });
    return element;
}

/**
 * A slider with its value beside it.
 * @param {string} label
 * @param {{min: number, max: number, step: number | string}} limits
 * @param {number} value
 * @param {(value: number) => void} input
 * @param {(value: number) => string} [format]
 */
export function slider(label, limits, value, input, format = String) {
    const output = h("output", {}, format(value));
    const control = h("input", { type: "range", ...limits, value, "aria-label": label, "aria-valuetext": format(value) });
    control.addEventListener("input", () => {
        const value = control.valueAsNumber;
        output.textContent = format(value);
        control.setAttribute("aria-valuetext", format(value));
        input(value);
    });
    const element = h("div", { class: "slider" }, h("span", { class: "label" }, label), control, output);
    return {
        element,
        /** @param {number} value */
        set(value) {
            control.value = String(value);
            output.textContent = format(value);
            control.setAttribute("aria-valuetext", format(value));
        },
    };
}
