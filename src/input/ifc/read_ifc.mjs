// Reads an IFC file from the standard input with web-ifc and writes its faces as lines of JSON, one object per line:
//   {"unit": 0.001, "north": [0, 1]}                                     metres per unit; true north if stated
//   {"material": "glass", "color": [r, g, b], "transparency": 0.9}       numbered from 0
//   {"element": "IfcWall_South_2O2Fr...", "material": 0, "points": [x, y, z, ...], "triangles": [a, b, c, ...]}
//   {"space": "A102", "long_name": "Living room", "id": 17, "storey": "Level 1", "points": ..., "triangles": ...}
//   {"without_faces": "IfcWall_East_1xS3..."}                            an element whose shape gave no faces
//   {"end": true}
// or {"refusal": "..."} alone. Points are in meters, z up. web-ifc cuts the openings.
import { readFileSync, writeSync } from 'node:fs';
import { createRequire } from 'node:module';
import { setFlagsFromString } from 'node:v8';

const require = createRequire(import.meta.url);

// Most functions of web-ifc run for less time than the optimizing compiler takes for them. This compiler starts later,
// so that it compiles the hot functions of large models alone.
setFlagsFromString('--wasm-tiering-budget=500000000');

function write(line) {
  const bytes = Buffer.from(JSON.stringify(line) + '\n');
  for (let done = 0; done < bytes.length;) done += writeSync(1, bytes, done);
}

function list(vector) {
  return Array.from({ length: vector.size() }, (_, k) => vector.get(k));
}

const value = (attribute) => (attribute && attribute.value !== undefined ? attribute.value : attribute ?? null);
const text = (attribute) => String(value(attribute) ?? '').trim();
const references = (attribute) => [attribute ?? []].flat().filter((one) => one && one.type === 5).map((one) => one.value);

// The lines of a model, each read once; null for a dangling reference.
class Lines {
  constructor(ifc, model) {
    this.ifc = ifc;
    this.model = model;
    this.known = new Map();
  }

  get(id) {
    if (!this.known.has(id)) {
      let line = null;
      try {
        line = this.ifc.GetLine(this.model, id) ?? null;
      } catch {
        // A damaged line counts as missing.
      }
      this.known.set(id, line);
    }
    return this.known.get(id);
  }

  all(type, derived = false) {
    return list(this.ifc.GetLineIDsWithType(this.model, type, derived)).map((id) => this.get(id)).filter(Boolean);
  }

  className(line) {
    return this.ifc.GetNameFromTypeCode(line.type) ?? 'IfcProduct';
  }
}

// Names of styles by item, material and element.
class Styles {
  constructor(web, lines) {
    this.web = web;
    this.lines = lines;
    this.ofItem = new Map();
    this.ofMaterial = new Map();
    this.materialsOf = new Map();
    for (const styled of lines.all(web.IFCSTYLEDITEM))
      for (const item of references(styled.Item)) this.ofItem.set(item, this.surfaceStyles(styled));
    for (const definition of lines.all(web.IFCMATERIALDEFINITIONREPRESENTATION)) this.addMaterial(definition);
    for (const relation of lines.all(web.IFCRELASSOCIATESMATERIAL)) {
      for (const element of references(relation.RelatedObjects))
        this.materialsOf.set(element, references(relation.RelatingMaterial));
    }
  }

  addMaterial(definition) {
    const items = references(definition.Representations).flatMap((id) => references(this.lines.get(id)?.Items));
    const styles = items.flatMap((id) => this.surfaceStyles(this.lines.get(id)));
    for (const material of references(definition.RepresentedMaterial)) this.ofMaterial.set(material, styles);
  }

  // The surface styles of a styled item; IFC2x3 has an assignment in between.
  surfaceStyles(styled) {
    const found = [];
    for (const id of references(styled?.Styles)) {
      const style = this.lines.get(id);
      if (style?.type === this.web.IFCSURFACESTYLE) found.push(this.surfaceStyle(style));
      else if (style) found.push(...this.surfaceStyles(style));
    }
    return found;
  }

  surfaceStyle(style) {
    const colors = [];
    for (const id of references(style.Styles)) {
      const shading = this.lines.get(id);
      for (const color of [...references(shading?.SurfaceColour), ...references(shading?.DiffuseColour)]) {
        const rgb = this.lines.get(color);
        colors.push([rgb?.Red, rgb?.Green, rgb?.Blue].map((part) => Number(value(part))));
      }
    }
    return { name: text(style.Name), colors };
  }

  // The styles of an element's material, its layers and constituents.
  ofMaterials(id, depth = 0) {
    const line = this.lines.get(id);
    if (!line || depth > 8) return [];
    const parts = ['ForLayerSet', 'ForProfileSet', 'MaterialLayers', 'MaterialProfiles', 'MaterialConstituents',
                   'Materials', 'Material'];
    const below = parts.flatMap((part) => references(line[part]));
    return [...(this.ofMaterial.get(id) ?? []), ...below.flatMap((part) => this.ofMaterials(part, depth + 1))];
  }

  // The styles of an item and of its parts, outermost first.
  ofShape(id, depth = 0) {
    const line = this.lines.get(id);
    if (!line || depth > 16) return [];
    const parts = ['Representations', 'Items', 'MappingSource', 'MappedRepresentation', 'FirstOperand',
                   'TreeRootExpression'];
    const below = parts.flatMap((part) => references(line[part]));
    return [...(this.ofItem.get(id) ?? []), ...below.flatMap((part) => this.ofShape(part, depth + 1))];
  }

  // The style of a color from web-ifc; null for white, the color of faces without a style.
  of(element, item, color) {
    const line = this.lines.get(element);
    const styles = [...(this.ofItem.get(item) ?? []),
                    ...references(line?.Representation).flatMap((id) => this.ofShape(id)),
                    ...(this.materialsOf.get(element) ?? this.materialsOfType(element)).flatMap((id) => this.ofMaterials(id))];
    const has = (style) => style.colors.some((rgb) => rgb.every((part, k) => Math.abs(part - color[k]) < 1e-3));
    const found = styles.find(has);
    if (found) return { name: found.name, color };
    const isDefault = color.every((part) => part === 1);
    return isDefault ? null : { name: styles[0]?.name ?? '', color };
  }

  materialsOfType(element) {
    if (!this.typeOf) {
      this.typeOf = new Map();
      for (const relation of this.lines.all(this.web.IFCRELDEFINESBYTYPE)) {
        for (const one of references(relation.RelatedObjects)) this.typeOf.set(one, references(relation.RelatingType)[0]);
      }
    }
    return this.materialsOf.get(this.typeOf.get(element)) ?? [];
  }
}

// The numbers of materials; each material is written at its first use.
class Materials {
  constructor() {
    this.numbers = new Map();
  }

  number(style, opacity) {
    const line = style === null
      ? { material: '', color: null, transparency: 0 }
      : { material: style.name, color: style.color, transparency: Math.min(Math.max(1 - opacity, 0), 1) };
    const key = JSON.stringify(line);
    if (!this.numbers.has(key)) {
      this.numbers.set(key, this.numbers.size);
      write(line);
    }
    return this.numbers.get(key);
  }
}

// Points without duplicates, and triangles of a placed geometry. web-ifc uses y as the vertical axis.
function faces(ifc, model, placed) {
  const geometry = ifc.GetGeometry(model, placed.geometryExpressID);
  const vertices = ifc.GetVertexArray(geometry.GetVertexData(), geometry.GetVertexDataSize());
  const indices = ifc.GetIndexArray(geometry.GetIndexData(), geometry.GetIndexDataSize());
  geometry.delete();
  const m = placed.flatTransformation;
  const mirrored = m[0] * (m[5] * m[10] - m[6] * m[9]) - m[4] * (m[1] * m[10] - m[2] * m[9]) +
                   m[8] * (m[1] * m[6] - m[2] * m[5]) < 0;
  const numbers = new Map();
  const points = [];
  const numberOf = (vertex) => {
    const [x, y, z] = vertices.subarray(6 * vertex, 6 * vertex + 3);
    const key = `${x},${y},${z}`;
    if (!numbers.has(key)) {
      numbers.set(key, numbers.size);
      const at = (row) => m[row] * x + m[row + 4] * y + m[row + 8] * z + m[row + 12];
      points.push(at(0), -at(2), at(1));
    }
    return numbers.get(key);
  };
  const triangles = [];
  for (let k = 0; k + 2 < indices.length; k += 3) {
    const [a, b, c] = [numberOf(indices[k]), numberOf(indices[k + 1]), numberOf(indices[k + 2])];
    if (a !== b && b !== c && c !== a) triangles.push(...(mirrored ? [a, c, b] : [a, b, c]));
  }
  return { points, triangles };
}

// The stories of elements and spaces, through all levels of decomposition.
function storeys(web, lines) {
  const above = new Map();
  for (const relation of lines.all(web.IFCRELCONTAINEDINSPATIALSTRUCTURE)) {
    for (const one of references(relation.RelatedElements)) above.set(one, references(relation.RelatingStructure)[0]);
  }
  for (const relation of lines.all(web.IFCRELAGGREGATES)) {
    for (const one of references(relation.RelatedObjects)) above.set(one, references(relation.RelatingObject)[0]);
  }
  return (id) => {
    for (let depth = 0; id !== undefined && depth < 64; ++depth, id = above.get(id)) {
      const line = lines.get(id);
      if (line?.type === web.IFCBUILDINGSTOREY) return text(line.Name) || text(line.LongName);
    }
    return '';
  };
}

function trueNorth(web, lines) {
  for (const context of lines.all(web.IFCGEOMETRICREPRESENTATIONCONTEXT)) {
    for (const direction of references(context.TrueNorth)) {
      const ratios = (lines.get(direction)?.DirectionRatios ?? []).map((ratio) => Number(value(ratio)));
      if (ratios.length >= 2 && ratios.every(Number.isFinite)) return ratios.slice(0, 2);
    }
  }
  return null;
}

// Meters per unit of length, if the project states it.
function lengthUnit(web, lines) {
  const prefixes = { KILO: 1e3, HECTO: 1e2, DECA: 10, DECI: 0.1, CENTI: 0.01, MILLI: 1e-3, MICRO: 1e-6 };
  const factor = (unit, depth = 0) => {
    if (!unit || depth > 4) return 1;
    if (unit.type === web.IFCSIUNIT) return prefixes[text(unit.Prefix)] ?? 1;
    const measure = lines.get(references(unit.ConversionFactor)[0]);
    const size = Number(value(measure?.ValueComponent));
    return (size > 0 ? size : 1) * factor(lines.get(references(measure?.UnitComponent)[0]), depth + 1);
  };
  for (const assignment of lines.all(web.IFCUNITASSIGNMENT)) {
    for (const unit of references(assignment.Units).map((id) => lines.get(id)))
      if (text(unit?.UnitType) === 'LENGTHUNIT') return factor(unit);
  }
  return 1;
}

// Spaces are air, and zones are groups of spaces; openings and voids are already cut.
const noBodies = ['IFCSPACE', 'IFCSPATIALZONE', 'IFCEXTERNALSPATIALELEMENT', 'IFCOPENINGELEMENT',
                  'IFCOPENINGSTANDARDCASE', 'IFCVOIDINGFEATURE', 'IFCVIRTUALELEMENT', 'IFCANNOTATION', 'IFCGRID'];

function writeElements(web, ifc, model, lines) {
  const styles = new Styles(web, lines);
  const materials = new Materials();
  const left = new Set(noBodies.map((name) => web[name]));
  const written = new Set();
  ifc.StreamAllMeshes(model, (mesh) => {
    const element = lines.get(mesh.expressID);
    if (!element || left.has(element.type)) return;
    const name = nameOf(lines, element);
    for (const placed of list(mesh.geometries)) {
      const shape = faces(ifc, model, placed);
      if (shape.triangles.length === 0) continue;
      const { x, y, z, w } = placed.color;
      const material = materials.number(styles.of(mesh.expressID, placed.geometryExpressID, [x, y, z]), w);
      written.add(mesh.expressID);
      write({ element: name, material, ...shape });
    }
  });
  writeMissing(web, lines, (element) => left.has(element.type) || written.has(element.expressID));
}

// "IfcWall_South_2O2Fr$t4X7Zf8NOew3FNr2"
const nameOf = (lines, line) => `${lines.className(line)}_${text(line.Name)}_${text(line.GlobalId)}`;

function writeMissing(web, lines, isKnown) {
  const bodies = new Set(['Body', 'Facetation', 'Body-FallBack']);
  for (const element of lines.all(web.IFCELEMENT, true)) {
    if (isKnown(element)) continue;
    const shapes = references(element.Representation).flatMap((id) => references(lines.get(id)?.Representations));
    if (shapes.some((id) => bodies.has(text(lines.get(id)?.RepresentationIdentifier))))
      write({ without_faces: nameOf(lines, element) });
  }
}

function writeSpaces(web, ifc, model, lines) {
  const storeyOf = storeys(web, lines);
  ifc.StreamAllMeshesWithTypes(model, [web.IFCSPACE], (mesh) => {
    const space = lines.get(mesh.expressID);
    for (const placed of list(mesh.geometries)) {
      const shape = faces(ifc, model, placed);
      if (!space || shape.triangles.length === 0) continue;
      write({ space: text(space.Name), long_name: text(space.LongName), id: mesh.expressID,
              storey: storeyOf(mesh.expressID), ...shape });
    }
  });
}

async function main() {
  const bytes = new Uint8Array(readFileSync(0));
  const web = require('web-ifc');
  const ifc = new web.IfcAPI();
  await ifc.Init();
  ifc.SetLogLevel(web.LogLevel.LOG_LEVEL_OFF);
  const start = Buffer.from(bytes.subarray(0, 4096)).toString('latin1');
  const model = start.includes('ISO-10303-21') ? ifc.OpenModel(bytes, { COORDINATE_TO_ORIGIN: false }) : -1;
  if (model < 0) {
    write({ refusal: 'is not an IFC file in STEP format (ISO-10303-21)' });
    return;
  }
  const lines = new Lines(ifc, model);
  write({ unit: lengthUnit(web, lines), north: trueNorth(web, lines) });
  writeElements(web, ifc, model, lines);
  writeSpaces(web, ifc, model, lines);
  write({ end: true });
}

// web-ifc and the module loader write to the console, which must contain only the lines of this script.
for (const level of ['log', 'info', 'warn', 'error', 'debug']) console[level] = () => {};
main().catch((error) => {
  const reason = /out of memory|could not allocate|allocation failed|\bOOM\b/i.test(error?.message)
    ? 'the IFC library gets too little memory; it reserves 10 GB of address space (ulimit -v)'
    : 'the IFC library ends with an error; the file may be damaged';
  write({ refusal: `cannot be read: ${reason}` });
});
