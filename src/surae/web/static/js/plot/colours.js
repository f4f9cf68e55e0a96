// Colours of the page, for canvases: asked for at every drawing, so that a theme may change.

export const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

/** Redraw when the theme changes. */
export const onTheme = (work) => addEventListener("themechange", () => requestAnimationFrame(work));
