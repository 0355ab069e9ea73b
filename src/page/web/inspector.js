// The values of one patch, below the model.
const units = {radiance: "W/(m² sr)", irradiance: "W/m²", luminance: "cd/m²", illuminance: "lx", direct_illuminance: "lx", error_illuminance: "lx", error_total: "cd/m²",
  error_mesh: "cd/m²", error_form_factor: "cd/m²", error_solver: "cd/m²", display_error: "cd/m²"};
const names = {radiance: "Radiance", irradiance: "Irradiance", luminance: "Luminance", illuminance: "Illuminance", direct_illuminance: "Direct illuminance",
  error_illuminance: "Error bar of illuminance", error_total: "Error bar of luminance", error_mesh: "Error bar, part of the mesh", error_form_factor: "Error bar, part of the form factors",
  error_solver: "Error bar, part of the solver", display_error: "Variation within the patch"};

function rowEntries(model, row, place) {
  const {rows, values} = model;
  const many = rows.patches[row] > 1;
  const material = model.materials[rows.material_id[row]];
  const group = model.groups[rows.group_id[row]];
  const entries = [
    ["patch", many ? "Patches" : "Patch", many ? `mean of ${rows.patches[row]}, from number ${rows.patch[row]}` : String(rows.patch[row]), rows.patch[row]],
    ["material", "Material", material, material],
    ["group", "Object", group === undefined ? "none" : group, group === undefined ? "" : group],
    ["source_polygon", "Face in the model file", String(rows.source_polygon[row]) + (rows.side[row] === 1 ? ", back side" : ""), rows.source_polygon[row]],
    ["area", "Area", shown(rows.area[row]) + " m²", rows.area[row]],
    ["place", "Position, m", place.map((value) => shown(Math.round(1e4 * value) / 1e4)).join(", "), place.join(" ")],
  ];
  for (const [name, array] of Object.entries(values)) {
    const components = array.length / rows.area.length;
    const own = Array.from(array.subarray(components * row, components * (row + 1)));
    const label = components > 1 ? `${names[name]} (${model.bands.join(", ")})` : names[name];
    entries.push([name, label, own.map((value) => shown(value)).join(", ") + " " + units[name], own.join(" ")]);
  }
  return entries;
}

// The values that are read first, each with its error bar.
function headlines(model, row) {
  const lines = [];
  for (const [name, error] of [["illuminance", "error_illuminance"], ["luminance", "error_total"]]) {
    if (!model.values[name]) continue;
    const bar = model.values[error] ? model.values[error][row] : NaN;
    lines.push(element("p", {class: "headline"}, `${names[name]} `, element("strong", {}, withBar(model.values[name][row], bar, units[name]))));
  }
  if (model.rows.dark[row] === 1) lines.push(element("p", {class: "faint"}, "No light reaches this surface. The model shows it in gray."));
  return lines;
}

function showRow(model, row, place) {
  const parts = rowEntries(model, row, place).map(([name, label, text, data]) => {
    const cell = element("dd", {"data-name": name, "data-value": data}, text);
    return element("div", {}, element("dt", {}, label), cell);
  });
  byId("values").replaceChildren(...headlines(model, row), element("dl", {}, ...parts));
}
