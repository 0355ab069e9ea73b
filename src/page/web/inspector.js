// The values of one patch, told under the model.
const units = {radiance: "W/(m² sr)", irradiance: "W/m²", luminance: "cd/m²", illuminance: "lx", direct_illuminance: "lx", error_illuminance: "lx", error_total: "cd/m²",
  error_mesh: "cd/m²", error_form_factor: "cd/m²", error_solver: "cd/m²", display_error: "cd/m²"};
const names = {radiance: "Radiance", irradiance: "Irradiance", luminance: "Luminance", illuminance: "Illuminance", direct_illuminance: "Illuminance straight from lamps",
  error_illuminance: "Error bar of illuminance", error_total: "Error bar of luminance", error_mesh: "Error by the size of patches", error_form_factor: "Error by form factors",
  error_solver: "Error by the solver", display_error: "Difference of a point from the patch's mean"};

function rowEntries(model, row, place) {
  const {rows, values} = model;
  const many = rows.patches[row] > 1;
  const material = model.materials[rows.material_id[row]];
  const group = model.groups[rows.group_id[row]];
  const entries = [
    ["patch", many ? "Patches" : "Patch", many ? `${rows.patches[row]} from ${rows.patch[row]}, their means` : String(rows.patch[row]), rows.patch[row]],
    ["material", "Material", material, material],
    ["group", "Object", group === undefined ? "none" : group, group === undefined ? "" : group],
    ["source_polygon", "Face of the file", String(rows.source_polygon[row]) + (rows.side[row] === 1 ? ", its back" : ""), rows.source_polygon[row]],
    ["area", "Area", shown(rows.area[row]) + " m²", rows.area[row]],
    ["place", "Place, m", place.map((value) => shown(value)).join(", "), place.join(" ")],
  ];
  for (const [name, array] of Object.entries(values)) {
    const components = array.length / rows.area.length;
    const own = Array.from(array.subarray(components * row, components * (row + 1)));
    const label = components > 1 ? `${names[name]} (${model.bands.join(", ")})` : names[name];
    entries.push([name, label, own.map((value) => shown(value)).join(", ") + " " + units[name], own.join(" ")]);
  }
  return entries;
}

function tellRow(model, row, place) {
  const parts = rowEntries(model, row, place).map(([name, label, text, value]) => {
    const told = element("dd", {"data-name": name, "data-value": value}, text);
    return element("div", {}, element("dt", {}, label), told);
  });
  byId("values").replaceChildren(element("dl", {}, ...parts));
}
