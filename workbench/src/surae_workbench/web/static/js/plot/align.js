// Series with times of their own, brought to one row of times as uPlot wants them.

/** [{t, v}] → [times, values…]; factors as they are shown. */
export function aligned(series, factors = []) {
  const tables = series.map(({ t, v }, i) => {
    const factor = factors[i] ?? 1;
    return [t, factor === 1 ? v : v.map((y) => (y === null ? null : y * factor))];
  });
  if (tables.length === 1 || tables.every(([t]) => same(t, tables[0][0]))) {
    return [tables[0][0], ...tables.map(([, v]) => v)];
  }
  return uPlot.join(tables);
}

function same(a, b) {
  return a === b || (a.length === b.length && a[0] === b[0] && a[a.length - 1] === b[b.length - 1] && a.every((x, i) => x === b[i]));
}
