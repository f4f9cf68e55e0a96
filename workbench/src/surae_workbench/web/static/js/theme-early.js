// Runs before the first paint, so that a dark page never flashes white: as the system is, light or
// dark; and whether what research needs is shown.
(() => {
  const system = matchMedia("(prefers-color-scheme: dark)");
  const apply = (dark) => {
    document.documentElement.dataset.theme = dark ? "dark" : "light";
    dispatchEvent(new Event("themechange"));
  };
  apply(system.matches);
  system.addEventListener("change", () => apply(system.matches));
  addEventListener("beforeprint", () => apply(false)); // paper is white
  addEventListener("afterprint", () => apply(system.matches));
  try {
    document.documentElement.toggleAttribute("data-research", localStorage.getItem("surae.research") === "on");
  } catch {
    // Storage may be switched off.
  }
})();
