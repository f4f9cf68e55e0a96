// Runs before the first paint, so that a dark page never flashes white: the reader's own choice,
// else the system's.
(() => {
  const system = matchMedia("(prefers-color-scheme: dark)");
  const apply = () => {
    let chosen = null;
    try {
      chosen = localStorage.getItem("surae.theme");
    } catch {
      // Storage may be switched off: then the system's preference counts.
    }
    const own = chosen === "light" || chosen === "dark";
    document.documentElement.dataset.theme = own ? chosen : system.matches ? "dark" : "light";
    dispatchEvent(new Event("themechange"));
  };
  apply();
  system.addEventListener("change", apply);
  addEventListener("storage", (event) => event.key === "surae.theme" && apply());
  addEventListener("themechosen", apply);
  addEventListener("beforeprint", () => { // paper is white
    document.documentElement.dataset.theme = "light";
    dispatchEvent(new Event("themechange"));
  });
  addEventListener("afterprint", apply);
})();
