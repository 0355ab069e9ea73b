// Shows the data of the page: words first, then the model and the tables.
const data = JSON.parse(byId("data").textContent);

function writeHead() {
  byId("title").textContent = data.file.split("/").pop() || "Scene";
  const {report, model} = data;
  const parts = [];
  if (report) {
    const error = report.relative_error;
    parts.push(`${report.mesh.patches.toLocaleString("en")} patches, ${shown(report.mesh.area_m2)} m².`);
    parts.push(error ? `Estimated error of the reflected light${error.inside ? " indoors" : ""}: ${percent(error.total)}.` : "This run has no error bars.");
  } else if (model) {
    parts.push(`${model.patches.toLocaleString("en")} patches.`);
  }
  parts.push(`patchlight ${data.version}.`);
  byId("lead").textContent = parts.join(" ");
}

function diagnosticParts(show) {
  const {report} = data;
  const all = [...data.diagnostics, ...(report ? report.plan.notes : []), ...(report && report.sensors ? report.sensors.warnings : [])];
  const isFirst = (found, k) => all.findIndex((other) => other.text === found.text) === k;
  return all.filter(isFirst).map((found) => {
    const isGrave = found.severity === "error" || found.severity === "warning";
    const line = element("p", isGrave ? {class: "warning"} : {}, `${found.severity}: ${found.code}: ${found.text} `);
    if (show && found.outlines && found.outlines.length > 0) {
      const button = element("button", {type: "button"}, "Show in the model");
      button.addEventListener("click", () => show(found.outlines));
      line.append(button);
    }
    return line;
  });
}

function writePictures() {
  for (const picture of data.pictures) {
    const image = element("img", {src: "data:image/png;base64," + picture.png, width: picture.width, height: picture.height, alt: picture.caption});
    byId("pictures").append(element("figure", {}, image, element("figcaption", {}, picture.caption)));
  }
  byId("pictures").hidden = data.pictures.length === 0;
}

async function writeTables(show) {
  const {report} = data;
  if (report && report.room_surfaces && report.room_surfaces.rooms.length > 0) section("rooms", "Rooms", ...roomParts(report.room_surfaces));
  if (report && report.sensors) section("sensors", "Sensors", ...await sensorParts(report.sensors, data.sensors || []));
  if (data.comparison) section("comparison", "Comparison of solvers", ...comparisonParts(data.comparison));
  if (data.study) section("study", "Convergence study", ...studyParts(data.study));
  section("notes", "Notes and problems", ...diagnosticParts(show));
  if (report) {
    section("accuracy", "Refinement", ...accuracyParts(report));
    section("materials", "Materials", materialsTable(report));
    section("energy", "Energy balance", energyTable(report.energy_balance));
    section("convergence", "Convergence of the solver", ...convergenceParts(report.solution));
    section("plan", "Simulated effects and settings", ...planTable(report.plan));
    section("costs", "Run time", table("Time of each stage", ["stage", "wall time, s", "CPU time, s"], report.costs.map((cost) => [cost.stage, duration(cost.seconds), duration(cost.cpu_seconds)])));
  }
  section("repeat", "Reproduce this result", ...repeatParts(data));
}

function writeContents() {
  for (const part of document.querySelectorAll("main section:not([hidden])")) {
    byId("contents").append(element("a", {href: "#" + part.id}, part.querySelector("h2").textContent), " ");
  }
}

// The views to start from: that of the first picture, from above, and all from outside.
function views(model) {
  const {low, high} = model.faces;
  const middle = low.map((value, axis) => (value + high[axis]) / 2);
  const size = Math.hypot(...low.map((value, axis) => high[axis] - value)) || 1;
  const up = model.up;
  const away = (direction) => {
    const length = Math.hypot(...direction);
    return middle.map((value, axis) => value + 1.2 * size * direction[axis] / length);
  };
  const level = Math.abs(up[2]) > 0.7 ? [0.35, -1, 0] : Math.abs(up[1]) > 0.7 ? [0.35, 0, 1] : [0, 0.35, 1];
  const outside = [away(level.map((value, axis) => value + 0.45 * up[axis])), middle, 50];
  const above = [away(up.map((value, axis) => value + 0.001 * level[axis])), middle, 50];
  const camera = data.pictures.length > 0 ? data.pictures[0].camera : null;
  const usable = camera && camera.projection === "perspective";
  return {outside, above, home: usable ? [camera.eye, camera.target, camera.vertical_field_of_view] : outside};
}

async function unpackedModel() {
  const {model} = data;
  const arrays = await unpackedAll({positions: model.positions, corners: model.corners, row: model.row});
  const looks = [];
  for (const {name, colours, sky} of model.looks) looks.push({name, ...await unpackedAll(sky ? {colours, sky} : {colours})});
  const sky = model.sky ? {inARing: model.sky.in_a_ring, directions: await unpacked(model.sky.directions)} : null;
  return {...model, looks, sky, faces: {...arrays, low: model.positions.low, high: model.positions.high, steps: model.positions.steps}, rows: await unpackedAll(model.rows), values: await unpackedAll(model.values)};
}

// The values beyond the range.
function extremes(model, order, scale, unit) {
  if (order.length === 0) return "There are no values.";
  const least = order[0], most = order[order.length - 1];
  const words = ({row, value}) => `${shown(value)} ${unit} (patch ${model.rows.patch[row]})`;
  const inside = order.length < model.rows.area.length && model.rows.enclosed;
  return `Lowest ${words(least)}, highest ${words(most)}${inside ? ", both of patches inside. The range is that of the inside" : ""}. ${percent(shareBeyond(order, scale))} of the area ${inside ? "inside " : ""}is outside the range.`
    + (model.rows.dark.includes(1) ? " Gray: no light reaches the surface." : "");
}

function listenToColours(model, view) {
  const looks = model.looks.map((look, k) => [k === 0 ? "natural" : `natural-${k}`, look.name]);
  const choices = [...looks, ...Object.keys(model.values).filter((name) => model.values[name].length === model.rows.area.length).map((name) => [name, `${names[name]}, ${units[name]}`])];
  for (const [value, words] of choices) byId("quantity").append(element("option", {value}, words));
  let scale = null, order = [];
  const paint = () => {
    const name = byId("quantity").value;
    const look = model.looks[looks.findIndex(([value]) => value === name)];
    byId("legend").hidden = look !== undefined;
    if (look) return view.colour(naturalColours(model.faces, view.mesh, look.colours, model.rows.dark, (row) => model.mirrors.includes(model.rows.material_id[row])), true, look.sky);
    view.colour(falseColours(model.faces, view.mesh, model.values[name], scale, model.rows.dark), false);
    byId("ticks").replaceChildren(...[0, 0.25, 0.5, 0.75, 1].map((share) => element("span", {}, shown(valueAt(share, scale), 3))));
    byId("extremes").textContent = extremes(model, order, scale, units[name]);
  };
  const setScale = (to) => {
    scale = {...to, logarithmic: byId("logarithmic").checked};
    byId("low").value = Number(scale.low.toPrecision(4));
    byId("high").value = Number(scale.high.toPrecision(4));
    paint();
  };
  const fromInputs = () => setScale({low: Number(byId("low").value) || 0, high: Number(byId("high").value) || 0});
  const chosen = () => model.values[byId("quantity").value];
  byId("quantity").addEventListener("change", () => {
    if (!chosen()) return paint();
    order = ranked(chosen(), model.rows.area, model.rows.enclosed);
    setScale(usualScale(order));
  });
  for (const id of ["low", "high", "logarithmic"]) byId(id).addEventListener("change", fromInputs);
  byId("wider-range").addEventListener("click", () => order.length > 0 && setScale(widerScale(order)));
  byId("whole-range").addEventListener("click", () => order.length > 0 && setScale({low: order[0].value, high: order[order.length - 1].value}));
  drawBar(byId("bar"));
  paint();
}

function listenToCut(model, view) {
  const cut = () => {
    const axis = byId("cut-axis").value === "" ? null : Number(byId("cut-axis").value);
    byId("cut-at").disabled = byId("cut-other").disabled = axis === null;
    const {low, high} = model.faces;
    const at = axis === null ? 0 : low[axis] + byId("cut-at").value / 1000 * (high[axis] - low[axis]);
    byId("cut-place").textContent = axis === null ? "" : shown(at) + " m";
    view.setCut(axis, at, byId("cut-other").checked);
  };
  for (const id of ["cut-axis", "cut-at", "cut-other"]) byId(id).addEventListener("input", cut);
}

function listenToView(model, view) {
  const from = views(model);
  let marked = null, edges = null, pressed = null;
  const choose = (x, y) => {
    const hit = view.pick(x, y);
    if (marked) marked.remove();
    marked = null;
    if (!hit) return byId("values").replaceChildren(element("p", {class: "faint"}, "There is no patch here."));
    const same = [];
    model.faces.row.forEach((row, face) => { if (row === hit.row) same.push(face); });
    marked = view.lines(outlines(model.faces, view.mesh, same), 0xff2fd0);
    showRow(model, hit.row, hit.place);
  };
  view.canvas.addEventListener("pointerdown", (event) => { pressed = [event.clientX, event.clientY]; });
  view.canvas.addEventListener("click", (event) => {
    if (pressed && Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) > 5) return;
    const box = view.canvas.getBoundingClientRect();
    choose(2 * (event.clientX - box.left) / box.width - 1, 1 - 2 * (event.clientY - box.top) / box.height);
  });
  // A view from above is that of a plan: ceilings and roofs are cut away, unless there is a section already.
  const upright = model.up.findIndex((part) => Math.abs(part) > 0.7);
  let isPlan = false;
  const section = (axis) => {
    byId("cut-axis").value = axis;
    byId("cut-at").value = model.up[upright] < 0 ? 250 : 750;
    byId("cut-other").checked = model.up[upright] < 0;
    byId("cut-axis").dispatchEvent(new Event("input"));
    isPlan = axis !== "";
  };
  byId("cut-axis").addEventListener("input", () => { isPlan = false; });
  // The whole model from outside is exposed for the outside, where the model has both.
  const outdoors = model.looks.findIndex(({name}) => name.endsWith("outside"));
  for (const name of ["home", "above", "outside"]) {
    byId(name).addEventListener("click", () => {
      if (name === "above" && upright >= 0 && byId("cut-axis").value === "") section(String(upright));
      else if (name !== "above" && isPlan) section("");
      view.look(...from[name]);
      const quantity = byId("quantity");
      if (outdoors < 0 || quantity.selectedIndex >= model.looks.length) return;
      quantity.selectedIndex = name === "outside" ? outdoors : 0;
      quantity.dispatchEvent(new Event("change"));
    });
  }
  byId("edges").addEventListener("change", () => {
    if (edges) edges.remove();
    edges = byId("edges").checked ? view.lines(outlines(model.faces, view.mesh, model.faces.row.keys()), 0x555555) : null;
  });
  const luminaires = data.report ? data.report.input.luminaires : [];
  if (luminaires.length > 0) view.lines(luminaireMarks(luminaires, view.inside, view.size / 100), 0xff9000, false);
  listenToKeys(view, {home: () => view.look(...from.home), choose: () => choose(0, 0)});
  view.look(...from.home);
}

function showOutlines(view) {
  let shownLines = null;
  return (places) => {
    const ends = [];
    for (const outline of places) {
      outline.forEach((corner, k) => ends.push(...view.inside(corner).toArray(), ...view.inside(outline[(k + 1) % outline.length]).toArray()));
    }
    if (shownLines) shownLines.remove();
    shownLines = view.lines(new Float32Array(ends), 0xff3020);
    const corners = places.flat();
    const middle = [0, 1, 2].map((axis) => corners.reduce((sum, corner) => sum + corner[axis], 0) / corners.length);
    view.controls.target.copy(view.inside(middle));
    view.controls.update();
    view.canvas.scrollIntoView({block: "center"});
    view.canvas.focus();
  };
}

function explainDrawing(model) {
  if (!model.photometric) byId("fewer").textContent = "The lights of this scene are given in watts. Photometric values assume 179 lm/W. ";
  if (model.textured.length > 0) byId("fewer").textContent += `Textured surfaces (${model.textured.join(", ")}) show the mean color of each patch. `;
  if (model.mirrors.length > 0) byId("fewer").textContent += `Mirrors (${model.mirrors.map((k) => model.materials[k]).join(", ")}) have one color, without reflections. `;
  if (data.report && data.report.input.luminaires.length > 0) byId("fewer").textContent += "Orange lines mark luminaires. ";
  const left = model.patches_left_out;
  if (model.faces.row.length + model.patches_covered === model.patches) return;
  byId("fewer").textContent += `The model has ${model.patches.toLocaleString("en")} patches. The page draws ${model.faces.row.length.toLocaleString("en")} faces: where patches differ least, one face with their mean replaces them.`
    + (left > 0 ? ` ${left.toLocaleString("en")} patches of the smallest faces are not drawn.` : "");
}

async function showModel() {
  if (!data.model) return null;
  byId("model").hidden = false;
  try {
    const model = await unpackedModel();
    await loadThree(data.three);
    explainDrawing(model);
    const view = modelView(byId("canvas"), model);
    listenToColours(model, view);
    listenToCut(model, view);
    listenToView(model, view);
    return showOutlines(view);
  } catch (error) {
    byId("lost").hidden = false;
    byId("lost").textContent = "This browser cannot draw the model. It needs WebGL and DecompressionStream, which browsers have since 2023 (" + error.message + "). The tables and images below are complete.";
    for (const control of document.querySelectorAll(".controls *")) control.disabled = true;
    return null;
  }
}

async function start() {
  writeHead();
  writePictures();
  const show = await showModel();
  await writeTables(show);
  writeContents();
  document.documentElement.dataset.state = "ready";
}

start();
