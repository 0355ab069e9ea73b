// Faces of one opacity and layer together, opaque ones first: {opacity, layer, faces}.
function grouped(faces, opacityOf, layerOf, dark) {
  const groups = new Map();
  faces.row.forEach((row, face) => {
    const opacity = opacityOf(row), layer = layerOf(row) + dark[row], key = `${1 - opacity} ${layer}`;
    if (!groups.has(key)) groups.set(key, {opacity, layer, faces: []});
    groups.get(key).faces.push(face);
  });
  return [...groups.values()].sort((a, b) => b.opacity - a.opacity || a.layer - b.layer);
}

// Per corner of a face, the vector in its plane that moves both adjacent edges outward by one. At sharp corners its
// length is limited to two.
function outwardOf(corners, normal) {
  const ways = corners.map((corner, k) => new THREE.Vector3().subVectors(corners[(k + 1) % corners.length], corner).cross(normal).normalize());
  return ways.map((way, k) => {
    const before = ways[(k + ways.length - 1) % ways.length];
    return new THREE.Vector3().addVectors(way, before).divideScalar(Math.max(1 + way.dot(before), 0.5)).clampLength(0, 2);
  });
}

// The faces of the page as triangles, three corners each, relative to the center of their bounds. `groups` gives the
// opacity and layer of ranges of triangles. A face with others over it is lowered by two steps, layer by layer, and a
// dark one once more. Opaque faces with light have an `outward` vector for each corner, in units of 1/63.5, by which
// the shader makes neighbors overlap.
function triangles(faces, opacityOf, layerOf, dark) {
  const {low, high} = faces;
  const middle = low.map((value, axis) => (value + high[axis]) / 2);
  const longest = Math.max(...low.map((value, axis) => high[axis] - value));
  const step = longest / 65535;
  const at = (vertex) => new THREE.Vector3(...[0, 1, 2].map((axis) => low[axis] - middle[axis] + faces.positions[3 * vertex + axis] / faces.steps * (high[axis] - low[axis])));
  const count = faces.row.length;
  let triangleCount = 0;
  for (let face = 0; face < count; ++face) triangleCount += faces.corners[4 * face + 2] === faces.corners[4 * face + 3] ? 1 : 2;
  const positions = new Float32Array(9 * triangleCount), outward = new Int8Array(9 * triangleCount);
  const vertices = new Uint32Array(3 * triangleCount);
  const faceOf = new Uint32Array(triangleCount);
  let next = 0;
  const add = (face, corners, places, ways) => {
    corners.forEach((corner, k) => {
      vertices[3 * next + k] = faces.corners[4 * face + corner];
      positions.set(places[corner].toArray(), 9 * next + 3 * k);
      if (ways) outward.set(ways[corner].toArray().map((part) => Math.round(63.5 * part)), 9 * next + 3 * k);
    });
    faceOf[next++] = face;
  };
  const groups = grouped(faces, opacityOf, layerOf, dark).map(({opacity, layer, faces: own}) => {
    const first = next;
    for (const face of own) {
      const [a, b, c, d] = faces.corners.subarray(4 * face, 4 * face + 4);
      const places = (c === d ? [a, b, c] : [a, b, c, d]).map(at);
      const normal = new THREE.Vector3().subVectors(places[2], places[0]).cross(new THREE.Vector3().subVectors(places[places.length - 1], places[1])).normalize();
      const ways = opacity === 1 && dark[faces.row[face]] === 0 ? outwardOf(places, normal) : null;
      for (const place of places) place.addScaledVector(normal, -2 * step * layer);
      add(face, [0, 1, 2], places, ways);
      if (c !== d) add(face, [0, 2, 3], places, ways);
    }
    return {opacity, layer, first, count: next - first};
  });
  return {positions, outward, vertices, faceOf, groups, middle, rounding: longest / faces.steps, size: Math.hypot(...low.map((value, axis) => high[axis] - value)) || 1};
}

// The lines around faces, two ends each.
function outlines(faces, mesh, chosen) {
  const ends = [];
  const at = (vertex) => [0, 1, 2].map((axis) => faces.low[axis] - mesh.middle[axis] + faces.positions[3 * vertex + axis] / faces.steps * (faces.high[axis] - faces.low[axis]));
  for (const face of chosen) {
    const corners = Array.from(faces.corners.subarray(4 * face, 4 * face + 4));
    corners.forEach((vertex, k) => {
      const other = corners[(k + 1) % 4];
      if (vertex !== other) ends.push(...at(vertex), ...at(other));
    });
  }
  return new Float32Array(ends);
}

// Marks of luminaires: an octahedron of this size around each place, and a line along its aim.
function luminaireMarks(luminaires, inside, size) {
  const ends = [];
  for (const {position_m: place, aim, kind} of luminaires) {
    const middle = inside(place);
    const corners = [0, 1, 2].flatMap((axis) => [-1, 1].map((sign) => middle.clone().setComponent(axis, middle.getComponent(axis) + sign * size)));
    corners.forEach((corner, k) => {
      for (const other of corners.slice(k + 1)) {
        if (corners.indexOf(other) !== (k ^ 1)) ends.push(...corner.toArray(), ...other.toArray());
      }
    });
    if (kind === "ies" || kind === "spot") ends.push(...middle.toArray(), ...middle.clone().addScaledVector(new THREE.Vector3(...aim), 4 * size).toArray());
  }
  return new Float32Array(ends);
}

// Surfaces without light are gray; they show only where the model is cut. Mirrors have one color, as the page has no rays.
const unlit = [150, 150, 146], mirrored = [172, 186, 198];

// Colors of the corners of all triangles, a byte per channel.
function naturalColours(faces, mesh, ofVertices, dark, isMirror) {
  const colours = new Uint8Array(3 * mesh.vertices.length);
  mesh.vertices.forEach((vertex, k) => {
    const row = faces.row[mesh.faceOf[Math.floor(k / 3)]];
    colours.set(dark[row] === 1 ? unlit : isMirror(row) ? mirrored : ofVertices.subarray(3 * vertex, 3 * vertex + 3), 3 * k);
  });
  return colours;
}

// Rings of directions as triangles of a sphere, seen from inside.
function dome(directions, inARing) {
  const rings = directions.length / 3 / inARing;
  const corners = [];
  for (let ring = 0; ring + 1 < rings; ++ring) {
    for (let k = 0; k < inARing; ++k) {
      const a = ring * inARing + k, b = ring * inARing + (k + 1) % inARing;
      corners.push(a, b, b + inARing, a, b + inARing, a + inARing);
    }
  }
  return corners;
}

function falseColours(faces, mesh, values, scale, dark) {
  const ofRow = Array.from(values, (value, row) => dark[row] === 1 ? unlit : falseColour(shareOf(value, scale)));
  const colours = new Uint8Array(3 * mesh.vertices.length);
  mesh.faceOf.forEach((face, triangle) => {
    for (let corner = 0; corner < 3; ++corner) colours.set(ofRow[faces.row[face]], 9 * triangle + 3 * corner);
  });
  return colours;
}
