// The colours of the page for canvases; `theme-early.js` makes it light or dark.

/** A colour of the page: asked for at every drawing, so that the theme may change. */
export const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

/** Redraw when the theme changes. */
export const onTheme = (work) => addEventListener("themechange", () => requestAnimationFrame(work));
