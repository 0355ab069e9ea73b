// Tables of the report, by the keys of docs/reference/outputs/report-json.md.
function materialsTable(report) {
  const rows = report.materials.map((material) => [material.name, material.area_m2, spectrum(material.reflectance), spectrum(material.flux_emitted_W), spectrum(material.flux_absorbed_W), spectrum(material.irradiance_mean_W_m2)]);
  return table("Materials, with a value for each band", ["material", "area, m²", "reflectance", "emitted, W", "absorbed, W", "mean irradiance, W/m²"], rows);
}

function energyTable(balance) {
  const parts = [["emitted by patches", "emitted_W"], ["straight from luminaires, sun and sky", "arriving_W"], ["absorbed", "absorbed_W"], ["escaped into the open", "escaped_W"], ["lost at sides without patches", "lost_at_backs_W"], ["left by form factors that do not add up", "defect_W"]];
  const rows = parts.filter(([, key]) => balance[key] !== null).map(([words, key]) => [words, spectrum(balance[key])]);
  rows.push(["what does not add up, by the solver", percent(balance.imbalance)]);
  return table("Where the light goes, W per band", ["", "flux"], rows);
}

function planTable(plan) {
  const facts = [["patch edges up to", shown(plan.max_edge_m) + " m"], ["form factors as", plan.storage], ["solver", plan.solver], ["its tolerance", shown(plan.tolerance)], ["shadow rays of a pair", String(plan.samples)], ["closure", plan.close ? "yes" : "no"], ["seed", String(plan.seed)]];
  const decisions = plan.decisions.map((decision) => [decision.effect, (decision.simulate ? "simulated" : "left out") + (decision.forced ? ", as asked" : ""), decision.reason, decision.saving]);
  return [table("What was chosen", ["", ""], facts), table("Effects, and the fact that decides on each", ["effect", "", "because", "cost or saving"], decisions)];
}

function convergenceParts(solution) {
  const points = (key) => solution.iterations.map((iteration) => [iteration.number, iteration[key] === null ? NaN : iteration[key]]);
  const words = solution.unfinished ? "The run was stopped before its end." : solution.converged ? "The solver has converged." : "The solver has not converged.";
  const last = solution.iterations[solution.iterations.length - 1];
  const rows = last ? [[last.number, last.relative_residual, last.error_bound, last.work, last.seconds]] : [];
  return [element("p", solution.converged ? {} : {class: "warning"}, words + (solution.singular ? " " + solution.singular : "")),
    table("The last iteration", ["iteration", "relative residual", "error bound", "applications of the matrix", "seconds"], rows),
    chart("Error of the solver (" + solution.solver + ") by iteration", [{name: "residual", points: points("relative_residual")}, {name: "bound", points: points("error_bound")}], {label: "iteration"}, {label: "relative error", logarithmic: true})];
}

function accuracyParts(report) {
  if (report.accuracy.length === 0) return [];
  const rows = report.accuracy.map((step) => [step.patches, step.samples, percent(step.mesh), percent(step.form_factor), percent(step.solver), percent(step.total), percent(step.display), duration(step.seconds), duration(step.cpu_seconds)]);
  const curve = (name, key) => ({name, points: report.accuracy.map((step) => [step.patches, step[key]])});
  return [table("Meshes on the way; errors as shares of the reflected light", ["patches", "samples", "mesh", "form factors", "solver", "total", "of points", "seconds", "CPU s"], rows),
    report.accuracy.length > 1 ? chart("What accuracy cost", [curve("total", "total"), curve("mesh", "mesh"), curve("form factors", "form_factor"), curve("solver", "solver")], {label: "patches", logarithmic: true}, {label: "relative error", logarithmic: true}) : null];
}

function roomParts(light) {
  const marked = (surface, value) => surface.coarse ? "~ " + shown(value) : value;
  const row = (room, name) => [room.name, name, room[name].area_m2, marked(room[name], room[name].min), room[name].mean, marked(room[name], room[name].uniformity)];
  const rows = light.rooms.flatMap((room) => ["floor", "walls", "ceiling"].filter((name) => room[name]).map((name) => row(room, name)));
  return [table("Illuminance of what bounds each room, in " + light.unit, ["room", "surface", "area, m²", "min", "mean", "uniformity"], rows),
    light.note ? element("p", {}, "~ marks what is coarse: " + light.note) : null];
}

function sensorTable(sensors) {
  const daylight = sensors.groups.some((group) => group.mean_daylight_factor_percent !== undefined);
  const heads = ["group", "sensors", "inside walls", "min", "mean", "its standard error", "max", "uniformity", "largest standard error"];
  const rows = sensors.groups.map((group) => [group.name, group.sensors, group.inside_walls, group.min, group.mean, group.standard_error_of_mean, group.max, group.uniformity, group.largest_standard_error, ...(daylight ? [group.mean_daylight_factor_percent] : [])]);
  return table("Values in " + sensors.unit, daylight ? [...heads, "mean daylight factor, %"] : heads, rows);
}

function comparisonParts(comparison) {
  const rows = comparison.runs.map((run) => [run.solver + (run.reached ? "" : " (not reached)"), run.true_error, run.error_bound, run.iterations, run.applications, run.seconds, run.seconds_with_assembly, run.rate]);
  const curves = (key) => comparison.runs.map((run) => ({name: run.solver, points: run.history.map((entry) => [entry[key], entry.true_error === null ? NaN : entry.true_error])}));
  return [element("p", {}, `The same ${comparison.patches} patches and form factors for all; the spectral radius of the light's operator is ${shown(comparison.spectral_radius, 6)}.`),
    table("Every solver, until its true error is the same", ["solver", "true error", "bound", "iterations", "applications", "seconds", "with assembly, s", "rate"], rows),
    chart("True error by application of the matrix", curves("applications"), {label: "applications", logarithmic: true}, {label: "true error", logarithmic: true}),
    chart("True error by second", curves("seconds"), {label: "seconds", logarithmic: true}, {label: "true error", logarithmic: true})];
}

function studyParts(study) {
  const rows = study.settings.map((setting) => [setting.sweep, setting.patches, setting.samples, setting.tolerance, setting.seconds, setting.cpu_seconds, percent(setting.error), percent(setting.display_error), percent(setting.own_error)]);
  const sweeps = [...new Set(study.settings.map((setting) => setting.sweep))];
  const curves = sweeps.map((name) => ({name, points: study.settings.filter((setting) => setting.sweep === name).map((setting) => [setting.cpu_seconds, setting.error === null ? NaN : setting.error])}));
  return [element("p", {}, study.conclusion), table("Settings, and their errors against the reference", ["sweep", "patches", "samples", "tolerance", "seconds", "CPU s", "error", "of points", "own"], rows),
    chart("Error by CPU seconds", curves, {label: "CPU seconds", logarithmic: true}, {label: "relative error", logarithmic: true})];
}

function repeatParts(data) {
  const rows = [["patchlight", data.version], ["scene file", data.file], ["SHA-256 of its files", data.sha256]];
  if (data.scene_hash) rows.push(["hash of faces, materials and lights", data.scene_hash]);
  const changes = data.changes.length === 0 ? [] : [element("p", {}, "Done by Python besides, which the command does not say:"), list(data.changes)];
  return [element("pre", {}, data.command_line || "no command is recorded"), ...changes, table(changes.length > 0 ? "With the same version, files and changes the same command gives the same bits" : "With the same version and files the same command gives the same bits", ["", ""], rows)];
}
