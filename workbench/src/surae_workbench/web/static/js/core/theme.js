// Light and dark, which `theme-early.js` applies, and the colours of the page for canvases.

const dark = () => document.documentElement.dataset.theme === "dark";

export function themeButton(knob) {
  const say = () => (knob.textContent = dark() ? "Light theme" : "Dark theme");
  knob.addEventListener("click", () => {
    try {
      localStorage.setItem("surae.theme", dark() ? "light" : "dark");
    } catch {
      return;
    }
    dispatchEvent(new Event("themechosen"));
  });
  addEventListener("themechange", say);
  say();
}

/** A colour of the page: asked for at every drawing, so that the theme may change. */
export const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

/** Redraw when the theme changes. */
export const onTheme = (work) => addEventListener("themechange", () => requestAnimationFrame(work));
