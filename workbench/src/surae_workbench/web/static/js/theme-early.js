// Runs before the first paint, so that a dark page never flashes white: the reader's own choice,
// else the system's; and whether what research needs is shown.
(() => {
  const system = matchMedia("(prefers-color-scheme: dark)");
  const apply = () => {
    let chosen = null;
    let research = null;
    try {
      chosen = localStorage.getItem("surae.theme");
      research = localStorage.getItem("surae.research");
    } catch {
      // Storage may be switched off: then the system's preference counts.
    }
    const own = chosen === "light" || chosen === "dark";
    document.documentElement.toggleAttribute("data-research", research === "on");
    document.documentElement.dataset.theme = own ? chosen : system.matches ? "dark" : "light";
    dispatchEvent(new Event("themechange"));
  };
  apply();
  system.addEventListener("change", apply);
  addEventListener("storage", (event) => event.key?.startsWith("surae.") && apply());
  addEventListener("themechosen", apply);
  addEventListener("beforeprint", () => { // paper is white
    document.documentElement.dataset.theme = "light";
    dispatchEvent(new Event("themechange"));
  });
  addEventListener("afterprint", apply);
})();
