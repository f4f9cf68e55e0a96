// The button that chooses between light and dark; `theme-early.js` applies what is chosen.

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
