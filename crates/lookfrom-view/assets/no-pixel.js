// What stands in a lesson while no pixel is selected.

import { h } from "./html.js";

export const noPixel = () => h("p", { class: "hint" }, "Select a pixel of the picture first: click it, or press I in the picture.");
