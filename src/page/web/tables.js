// Tables of the report, by the keys of docs/reference/outputs/report-json.md.
function materialsTable(report) {
  const rows = report.materials.map((material) => [material.name, material.area_m2, spectrum(material.reflectance), spectrum(material.flux_emitted_W), spectrum(material.flux_absorbed_W), spectrum(material.irradiance_mean_W_m2)]);
  return table("Materials, with a value for each band", ["material", "area, m²", "reflectance", "emitted, W", "absorbed, W", "mean irradiance, W/m²"], rows);
}

function energyTable(balance) {
  const parts = [["emitted by surfaces", "emitted_W"], ["direct light of luminaires, sun and sky", "arriving_W"], ["absorbed", "absorbed_W"], ["lost through openings", "escaped_W"], ["lost at sides without patches", "lost_at_backs_W"], ["error of the form factors' sums", "defect_W"]];
  const rows = parts.filter(([, key]) => balance[key] !== null).map(([words, key]) => [words, spectrum(balance[key])]);
  rows.push(["relative imbalance, left by the solver", percent(balance.imbalance)]);
  return table("Flux in W, with a value for each band", ["", "flux"], rows);
}

function planTable(plan) {
  const facts = [["longest patch edge", shown(plan.max_edge_m) + " m"], ["method", plan.storage === "tiles" ? "pairs" : plan.storage], ["solver", plan.solver], ["tolerance of the solver", shown(plan.tolerance)], ["shadow rays for each pair", String(plan.samples)], ["closure", plan.close ? "yes" : "no"], ["seed", String(plan.seed)]];
  const decisions = plan.decisions.map((decision) => [decision.effect, (decision.simulate ? "yes" : "no") + (decision.forced ? ", by option" : ""), decision.reason, decision.saving]);
  return [table("Settings", ["setting", "value"], facts), table("Effects", ["effect", "simulated", "reason", "cost or saving"], decisions)];
}

function convergenceParts(solution) {
  const points = (key) => solution.iterations.map((iteration) => [iteration.number, iteration[key] === null ? NaN : iteration[key]]);
  const words = solution.unfinished ? "The run was stopped early. Its values are preliminary." : solution.converged ? "The solver converged." : "The solver did not converge.";
  const last = solution.iterations[solution.iterations.length - 1];
  const rows = last ? [[last.number, last.relative_residual, last.error_bound, last.work, last.seconds]] : [];
  return [element("p", solution.converged ? {} : {class: "warning"}, words + (solution.singular ? " " + solution.singular : "")),
    table("Last iteration", ["iteration", "relative residual", "error bound", "matrix products", "wall time, s"], rows),
    chart("Error of the solver (" + solution.solver + ") after each iteration", [{name: "residual", points: points("relative_residual")}, {name: "bound", points: points("error_bound")}], {label: "iteration"}, {label: "relative error", logarithmic: true})];
}

function accuracyParts(report) {
  if (report.accuracy.length === 0) return [];
  const rows = report.accuracy.map((step) => [step.patches, step.samples, percent(step.mesh), percent(step.form_factor), percent(step.solver), percent(step.total), percent(step.display), duration(step.seconds), duration(step.cpu_seconds)]);
  const curve = (name, key) => ({name, points: report.accuracy.map((step) => [step.patches, step[key]])});
  return [table("Meshes, with errors relative to the reflected light", ["patches", "samples", "mesh", "form factors", "solver", "total", "within patches", "wall time, s", "CPU time, s"], rows),
    report.accuracy.length > 1 ? chart("Error and number of patches", [curve("total", "total"), curve("mesh", "mesh"), curve("form factors", "form_factor"), curve("solver", "solver")], {label: "patches", logarithmic: true}, {label: "relative error", logarithmic: true}) : null];
}

function roomParts(light) {
  const marked = (surface, value) => surface.coarse ? "~ " + shown(value) : value;
  const row = (room, name) => [room.name, name, room[name].area_m2, marked(room[name], room[name].min), room[name].mean, marked(room[name], room[name].uniformity)];
  const rows = light.rooms.flatMap((room) => ["floor", "walls", "ceiling"].filter((name) => room[name]).map((name) => row(room, name)));
  return [table(`${light.unit === "lx" ? "Illuminance" : "Irradiance"} of the surfaces of each room, ${shownUnit(light.unit)}`, ["room", "surface", "area, m²", "minimum", "mean", "uniformity"], rows),
    light.note ? element("p", {}, "~ marks a coarse mesh: " + light.note) : null];
}

function sensorTable(sensors) {
  const {unit, groups} = sensors;
  const daylight = groups.some((group) => group.mean_daylight_factor_percent !== undefined);
  const heads = ["sensors", "number", "inside walls", "mean", "minimum", "maximum", "uniformity", "largest error bar"];
  const rows = groups.map((group) => [group.name, group.sensors, group.inside_walls, withBar(group.mean, group.standard_error_of_mean, unit), group.min, group.max, group.uniformity, group.largest_standard_error, ...(daylight ? [group.mean_daylight_factor_percent] : [])]);
  return table(`${unit === "lx" ? "Illuminance" : "Irradiance"}, ${shownUnit(unit)}; ± is one standard error`, daylight ? [...heads, "mean daylight factor, %"] : heads, rows);
}

// Groups of so many sensors are listed one by one.
const mostListed = 40;

async function eachSensor(group) {
  const {places, values, standard_errors: errors} = await unpackedAll({places: group.places, values: group.values, standard_errors: group.standard_errors});
  const rows = Array.from(values, (value, k) => [k + 1, ...Array.from(places.subarray(3 * k, 3 * k + 3), (part) => shown(part)), withBar(value, errors[k], group.unit)]);
  return table(`Each sensor of ${group.name}`, ["sensor", "x, m", "y, m", "z, m", "value"], rows);
}

async function sensorParts(sensors, groups) {
  const parts = [sensorTable(sensors)];
  try {
    for (const group of groups) {
      if (group.cells) parts.push(...await mapsOf(group));
      else if (group.values && (await unpacked(group.values)).length <= mostListed) parts.push(await eachSensor(group));
    }
  } catch (fault) {
    parts.push(element("p", {}, "The browser cannot draw the maps: " + fault.message));
  }
  return parts;
}

function comparisonParts(comparison) {
  const rows = comparison.runs.map((run) => [run.solver + (run.reached ? "" : " (not reached)"), run.true_error, run.error_bound, run.iterations, run.applications, run.seconds, run.seconds_with_assembly, run.rate]);
  const curves = (key) => comparison.runs.map((run) => ({name: run.solver, points: run.history.map((entry) => [entry[key], entry.true_error === null ? NaN : entry.true_error])}));
  return [element("p", {}, `All solvers use the same ${comparison.patches} patches and form factors. The spectral radius of the operator is ${shown(comparison.spectral_radius, 6)}.`),
    table("Solvers at the same true error", ["solver", "true error", "bound", "iterations", "matrix products", "wall time, s", "with assembly, s", "rate"], rows),
    chart("True error after each matrix product", curves("applications"), {label: "matrix products", logarithmic: true}, {label: "true error", logarithmic: true}),
    chart("True error over time", curves("seconds"), {label: "wall time, s", logarithmic: true}, {label: "true error", logarithmic: true})];
}

function studyParts(study) {
  const rows = study.settings.map((setting) => [setting.sweep, setting.patches, setting.samples, setting.tolerance, setting.seconds, setting.cpu_seconds, percent(setting.error), percent(setting.display_error), percent(setting.own_error)]);
  const sweeps = [...new Set(study.settings.map((setting) => setting.sweep))];
  const curves = sweeps.map((name) => ({name, points: study.settings.filter((setting) => setting.sweep === name).map((setting) => [setting.cpu_seconds, setting.error === null ? NaN : setting.error])}));
  return [element("p", {}, study.conclusion), table("Settings and their errors, against the reference", ["sweep", "patches", "samples", "tolerance", "wall time, s", "CPU time, s", "error", "within patches", "own estimate"], rows),
    chart("Error and CPU time", curves, {label: "CPU time, s", logarithmic: true}, {label: "relative error", logarithmic: true})];
}

function repeatParts(data) {
  const rows = [["patchlight", data.version], ["scene file", data.file], ["SHA-256 of its files", data.sha256]];
  if (data.scene_hash) rows.push(["hash of faces, materials and lights", data.scene_hash]);
  const changes = data.changes.length === 0 ? [] : [element("p", {}, "Changes made in Python, which the command does not include:"), list(data.changes)];
  return [element("pre", {}, data.command_line || "The command is not known."), ...changes, table(`The command gives identical results with the same version${changes.length > 0 ? ", files and changes" : " and files"}`, ["input", "value"], rows)];
}
