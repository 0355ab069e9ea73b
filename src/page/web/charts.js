// A chart of curves as SVG: [{name, points: [[x, y], ...]}], each axis linear or logarithmic.
function svg(name, attributes, ...children) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children);
  return made;
}

function axisOf(values, logarithmic) {
  const known = values.filter((value) => Number.isFinite(value) && (!logarithmic || value > 0));
  if (known.length === 0) return null;
  let low = Math.min(...known), high = Math.max(...known);
  if (logarithmic) {
    low = Math.floor(Math.log10(low));
    high = Math.max(low + 1, Math.ceil(Math.log10(high)));
    const step = Math.ceil((high - low) / 6);
    const ticks = [];
    for (let k = low; k <= high; k += step) ticks.push(Math.pow(10, k));
    return {at: (value) => (Math.log10(value) - low) / (high - low), ticks, logarithmic};
  }
  low = Math.min(0, low);
  if (high <= low) high = low + 1;
  const step = roundedUp((high - low) / 5);
  const ticks = [];
  for (let tick = 0; tick <= high * (1 + 1e-9); tick += step) ticks.push(tick);
  return {at: (value) => (value - low) / (high - low), ticks, logarithmic};
}

const tickText = (tick) => tick !== 0 && (tick < 1e-3 || tick >= 1e5) ? tick.toExponential(0) : shown(tick, 3);

const curveColours = ["#3b78c2", "#d06a2c", "#3f9a58", "#b0403f", "#8366b4", "#8a6d4f", "#c769ae", "#7a7a7a", "#a5a52a", "#2aa0a8", "#5560d0", "#c09020"];

function chart(caption, curves, xAxis, yAxis) {
  const width = 720, height = 340, left = 80, right = 220, top = 16, bottom = 48;
  const points = curves.flatMap((curve) => curve.points);
  const x = axisOf(points.map((point) => point[0]), xAxis.logarithmic);
  const y = axisOf(points.map((point) => point[1]), yAxis.logarithmic);
  if (x === null || y === null) return null;
  const toX = (value) => left + x.at(value) * (width - left - right);
  const toY = (value) => height - bottom - y.at(value) * (height - top - bottom);
  const drawn = svg("svg", {viewBox: `0 0 ${width} ${height}`, width, height, role: "img", "aria-label": caption});
  const text = (words, attributes) => svg("text", attributes, words);
  for (const tick of x.ticks) {
    drawn.append(svg("line", {class: "axis", x1: toX(tick), x2: toX(tick), y1: top, y2: height - bottom}));
    drawn.append(text(tickText(tick), {x: toX(tick), y: height - bottom + 16, "text-anchor": "middle"}));
  }
  for (const tick of y.ticks) {
    drawn.append(svg("line", {class: "axis", x1: left, x2: width - right, y1: toY(tick), y2: toY(tick)}));
    drawn.append(text(tickText(tick), {x: left - 6, y: toY(tick) + 4, "text-anchor": "end"}));
  }
  drawn.append(text(xAxis.label, {x: (left + width - right) / 2, y: height - 8, "text-anchor": "middle"}));
  drawn.append(text(yAxis.label, {x: 14, y: (top + height - bottom) / 2, "text-anchor": "middle", transform: `rotate(-90 14 ${(top + height - bottom) / 2})`}));
  curves.forEach((curve, number) => {
    const colour = curveColours[number % curveColours.length];
    const kept = curve.points.filter(([px, py]) => Number.isFinite(px) && Number.isFinite(py) && (!x.logarithmic || px > 0) && (!y.logarithmic || py > 0));
    const path = kept.map(([px, py], k) => (k === 0 ? "M" : "L") + toX(px).toFixed(1) + " " + toY(py).toFixed(1)).join("");
    drawn.append(svg("path", {d: path, fill: "none", stroke: colour, "stroke-width": 2}));
    if (kept.length < 60) kept.forEach(([px, py]) => drawn.append(svg("circle", {cx: toX(px), cy: toY(py), r: 2.5, fill: colour})));
    const row = top + 8 + 17 * number;
    drawn.append(svg("line", {x1: width - right + 10, x2: width - right + 26, y1: row, y2: row, stroke: colour, "stroke-width": 3}));
    drawn.append(text(curve.name, {x: width - right + 32, y: row + 4}));
  });
  return element("figure", {}, drawn, element("figcaption", {}, caption));
}
