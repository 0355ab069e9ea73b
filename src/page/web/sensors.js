// Maps of grids of sensors: cells in false colors with contour lines through the places of the sensors.
function planeOf(axes) {
  const right = new THREE.Vector3(...axes.right), upward = new THREE.Vector3(...axes.above);
  return (numbers, k) => {
    const place = new THREE.Vector3(numbers[k], numbers[k + 1], numbers[k + 2]);
    return [place.dot(right), place.dot(upward)];
  };
}

// The sensors as nodes of a lattice: rows and columns by their places; null where they are no lattice.
function latticeOf(points) {
  const levels = (axis) => {
    const sorted = points.map((point) => point[axis]).sort((a, b) => a - b);
    const span = sorted[sorted.length - 1] - sorted[0];
    return sorted.filter((value, k) => k === 0 || value - sorted[k - 1] > 1e-4 * span);
  };
  const columns = levels(0), rows = levels(1);
  if (columns.length < 2 || rows.length < 2 || columns.length * rows.length > 40 * points.length) return null;
  const nearest = (values, value) => values.reduce((best, other, k) => Math.abs(other - value) < Math.abs(values[best] - value) ? k : best, 0);
  const nodes = new Map();
  points.forEach(([x, y], k) => nodes.set(nearest(columns, x) + "," + nearest(rows, y), k));
  return {columns, rows, at: (column, row) => nodes.get(column + "," + row)};
}

// Marching squares: the pieces of the line where the values, linear along the edges of the lattice, are `level`.
function contour(lattice, points, values, level) {
  const pieces = [];
  for (let row = 0; row + 1 < lattice.rows.length; ++row) {
    for (let column = 0; column + 1 < lattice.columns.length; ++column) {
      const corners = [lattice.at(column, row), lattice.at(column + 1, row), lattice.at(column + 1, row + 1), lattice.at(column, row + 1)];
      if (corners.some((corner) => corner === undefined || Number.isNaN(values[corner]))) continue;
      const crossings = [];
      corners.forEach((from, k) => {
        const to = corners[(k + 1) % 4];
        if ((values[from] < level) === (values[to] < level)) return;
        const part = (level - values[from]) / (values[to] - values[from]);
        crossings.push([0, 1].map((axis) => points[from][axis] + part * (points[to][axis] - points[from][axis])));
      });
      for (let k = 0; k + 1 < crossings.length; k += 2) pieces.push([crossings[k], crossings[k + 1]]);
    }
  }
  return pieces;
}

function sensorMap(name, unit, axes, group, values, errors) {
  const count = values.length;
  const project = planeOf(axes);
  const points = Array.from({length: count}, (_, k) => project(group.places, 3 * k));
  const outlines = Array.from({length: count}, (_, k) => [0, 1, 2, 3].map((corner) => project(group.cells, 12 * k + 3 * corner)));
  const all = outlines.flat();
  const low = [0, 1].map((axis) => all.reduce((least, point) => Math.min(least, point[axis]), Infinity));
  const high = [0, 1].map((axis) => all.reduce((most, point) => Math.max(most, point[axis]), -Infinity));
  const scaleFactor = Math.min(560 / (high[0] - low[0]), 400 / (high[1] - low[1]));
  const width = (high[0] - low[0]) * scaleFactor, height = (high[1] - low[1]) * scaleFactor;
  const to = ([x, y]) => [((x - low[0]) * scaleFactor).toFixed(1), (height - (y - low[1]) * scaleFactor).toFixed(1)];
  const known = Array.from(values).filter((value) => Number.isFinite(value));
  const least = known.reduce((a, b) => Math.min(a, b), Infinity), most = known.reduce((a, b) => Math.max(a, b), -Infinity);
  // Like for patches, a point in the sun or before a lamp does not set the range.
  const order = ranked(values, new Float32Array(values.length).fill(1));
  const {high: top} = usualScale(order);
  const scale = {low: 0, high: top, logarithmic: false};
  const range = least <= most ? `${shown(least)} to ${shown(most)} ${shownUnit(unit)}` : "there are no values";
  const label = `Map of ${name}: ${range}`;
  const drawn = svg("svg", {viewBox: `0 0 ${(width + 90).toFixed(0)} ${(height + 10).toFixed(0)}`, width: (width + 90).toFixed(0), height: (height + 10).toFixed(0), role: "img", "aria-label": label});
  const reading = element("p", {class: "reading", "aria-live": "polite"}, element("span", {class: "faint"}, "Click a cell of the map to see its value and error bar."));
  outlines.forEach((outline, k) => {
    const colour = "rgb(" + falseColour(shareOf(values[k], scale)).join(",") + ")";
    const cell = svg("polygon", {points: outline.map((point) => to(point).join(",")).join(" "), fill: colour, stroke: colour, "stroke-width": 0.5});
    const words = Number.isNaN(values[k]) ? "inside a wall" : withBar(values[k], errors[k], unit);
    cell.append(svg("title", {}, words));
    cell.addEventListener("click", () => {
      const [x, y, z] = group.places.subarray(3 * k, 3 * k + 3);
      reading.replaceChildren("At " + [x, y, z].map((part) => shown(part, 3)).join(", ") + " m: ", element("strong", {}, words));
    });
    drawn.append(cell);
  });
  const lattice = latticeOf(points);
  const levels = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9].map((share) => share * top);
  if (lattice) {
    for (const level of levels) {
      const path = contour(lattice, points, values, level).map(([from, end]) => "M" + to(from).join(" ") + "L" + to(end).join(" ")).join("");
      if (path !== "") drawn.append(svg("path", {d: path, class: "contour"}));
    }
  }
  [0, 0.2, 0.4, 0.6, 0.8, 1].forEach((share) => {
    const y = height - share * (height - 12) - 2;
    drawn.append(svg("rect", {x: width + 8, y: y - 10, width: 14, height: 12, fill: "rgb(" + falseColour(share).join(",") + ")"}));
    drawn.append(svg("text", {x: width + 27, y}, shown(share * top, 3)));
  });
  const words = `${name}: ${range}` + (lattice ? `. Contour lines every ${shown(top / 10)} ${shownUnit(unit)}.` : ".");
  return element("figure", {}, drawn, reading, element("figcaption", {}, words));
}

async function mapsOf(group) {
  const arrays = await unpackedAll({places: group.places, cells: group.cells, values: group.values, errors: group.standard_errors, ...(group.daylight_factors ? {factors: group.daylight_factors} : {})});
  const maps = [sensorMap(group.name, group.unit, group, arrays, arrays.values, arrays.errors)];
  if (arrays.factors) maps.push(sensorMap(group.name + ", daylight factor", "%", group, arrays, arrays.factors, new Float32Array(arrays.factors.length)));
  return maps;
}
