"use strict";
// Plots of a report: drag to zoom, double-click for all; the values at the cursor stand below each.
(() => {
  const NONE = 65535, STEPS = 65534;
  const [INK, MUTED, BLUE, RED, OCHRE] = ["#1b1f24", "#57606a", "#1f4e8c", "#a8321f", "#b8860b"];
  const looks = { // as in the drawn figures
    measured: ["#a3abb5", 3.5], modelled: [BLUE, 1.2], tissue: [RED, 2], neural: [BLUE, 1.2], inertial: [INK, 1, [2, 2]], gravitational: [OCHRE, 1.5, [6, 3]],
    reflex: [INK, 1.2, [5, 2, 1, 2]], zero: [MUTED, 2, [2, 4]], TA: [RED, 1.2], GL: [BLUE, 1.2, [6, 3]], SOL: [INK, 1.2], GM: [OCHRE, 1.2, [2, 2]],
  };
  const numbers = (text, Kind) => new Kind(Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer);
  const width = (host) => Math.max(host.clientWidth, 240);
  document.documentElement.classList.add("live");
  JSON.parse(document.querySelector("script#signals")?.textContent ?? "[]").forEach((recording, which) => {
    const host = document.getElementById(`explore-${which}`);
    const time = Array.from(numbers(recording.index, Uint32Array), (index) => recording.start + index / recording.rate);
    const plots = [];
    let following = false; // by another panel
    const together = (plot, scale) => {
      if (scale !== "x" || following) return;
      following = true;
      const { min, max } = plot.scales.x;
      for (const other of plots) if (other !== plot) other.setScale("x", { min, max });
      following = false;
    };
    const leftOut = (plot) => {
      plot.ctx.fillStyle = "#e3e6ea";
      for (const [from, to] of recording.left) {
        const [a, b] = [plot.valToPos(from, "x", true), plot.valToPos(to, "x", true)];
        plot.ctx.fillRect(a, plot.bbox.top, Math.max(b - a, 1), plot.bbox.height);
      }
    };
    const shown = (value) => (value == null ? "–" : value.toFixed(Math.abs(value) < 10 ? 3 : 2).replace("-", "−"));
    recording.panels.forEach(([title, unit, lines], row) => {
      const series = lines.map(([name]) => {
        const [stroke, thick, dash] = looks[name] ?? [INK, 1];
        return { label: name, stroke, width: thick, dash, points: { show: false }, value: (_, value) => shown(value) };
      });
      const values = lines.map(([, low, high, steps]) =>
        Array.from(numbers(steps, Uint16Array), (step) => (step === NONE ? null : low + ((high - low) * step) / STEPS)));
      const last = row === recording.panels.length - 1;
      plots.push(new uPlot({
        title: `${title} [${unit}]`, width: width(host), height: row ? 150 : 230,
        scales: { x: { time: false } }, cursor: { sync: { key: `recording-${which}` }, drag: { x: true, y: false } },
        axes: [{ label: last ? "Time [s]" : undefined, labelSize: 18, size: 26 }, { size: 54 }],
        series: [{ label: "at [s]", value: (_, value) => shown(value) }, ...series],
        hooks: { setScale: [together], drawClear: [leftOut] },
      }, [time, ...values], host));
    });
    addEventListener("resize", () => plots.forEach((plot) => plot.setSize({ width: width(host), height: plot.height })));
    // What was closed had no width.
    host.closest("details")?.addEventListener("toggle", () => dispatchEvent(new Event("resize")));
    document.getElementById(`whole-${which}`).addEventListener("click", () => plots[0].setScale("x", { min: time[0], max: time[time.length - 1] }));
  });
})();
