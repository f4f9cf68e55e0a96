// Questions that stop what one is doing.

import { button, h } from "../core/dom.js";

/** A dialog with inputs; resolves to true when confirmed. */
export function ask(title, content, { confirm = "OK", danger = false } = {}) {
  return new Promise((resolve) => {
    const form = h(
      "form",
      { method: "dialog" },
      h("h2", { id: "dialog-title" }, title),
      content,
      h(
        "div",
        { class: "button-row" },
        h("button", { type: "submit", value: "yes", class: danger ? "danger" : "primary" }, confirm),
        button("Cancel", () => box.close("no")),
      ),
    );
    const box = h("dialog", { "aria-labelledby": "dialog-title" }, form);
    box.addEventListener("close", () => {
      box.remove();
      resolve(box.returnValue === "yes");
    });
    document.body.append(box);
    box.showModal();
  });
}
