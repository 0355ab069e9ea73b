// Faces of one opacity together, opaque ones first: {opacity, faces}.
function byOpacity(faces, opacityOf) {
  const groups = new Map([[1, []]]);
  faces.row.forEach((row, face) => {
    const opacity = opacityOf(row);
    if (!groups.has(opacity)) groups.set(opacity, []);
    groups.get(opacity).push(face);
  });
  return [...groups].map(([opacity, own]) => ({opacity, faces: own}));
}

// The faces of the page as triangles, three corners each, around the middle of their bounds. `groups` says which
// triangles have which opacity.
function triangles(faces, opacityOf) {
  const {low, high} = faces;
  const middle = low.map((value, axis) => (value + high[axis]) / 2);
  const at = (vertex, axis) => low[axis] - middle[axis] + faces.positions[3 * vertex + axis] / 65535 * (high[axis] - low[axis]);
  const count = faces.row.length;
  let triangleCount = 0;
  for (let face = 0; face < count; ++face) triangleCount += faces.corners[4 * face + 2] === faces.corners[4 * face + 3] ? 1 : 2;
  const positions = new Float32Array(9 * triangleCount);
  const vertices = new Uint32Array(3 * triangleCount);
  const faceOf = new Uint32Array(triangleCount);
  let next = 0;
  const add = (face, corners) => {
    corners.forEach((vertex, corner) => {
      vertices[3 * next + corner] = vertex;
      for (let axis = 0; axis < 3; ++axis) positions[9 * next + 3 * corner + axis] = at(vertex, axis);
    });
    faceOf[next++] = face;
  };
  const groups = byOpacity(faces, opacityOf).map(({opacity, faces: own}) => {
    const first = next;
    for (const face of own) {
      const [a, b, c, d] = faces.corners.subarray(4 * face, 4 * face + 4);
      add(face, [a, b, c]);
      if (c !== d) add(face, [a, c, d]);
    }
    return {opacity, first, count: next - first};
  });
  return {positions, vertices, faceOf, groups, middle, size: Math.hypot(...low.map((value, axis) => high[axis] - value)) || 1};
}

// The lines around faces, two ends each.
function outlines(faces, mesh, chosen) {
  const ends = [];
  const at = (vertex) => [0, 1, 2].map((axis) => faces.low[axis] - mesh.middle[axis] + faces.positions[3 * vertex + axis] / 65535 * (faces.high[axis] - faces.low[axis]));
  for (const face of chosen) {
    const corners = Array.from(faces.corners.subarray(4 * face, 4 * face + 4));
    corners.forEach((vertex, k) => {
      const other = corners[(k + 1) % 4];
      if (vertex !== other) ends.push(...at(vertex), ...at(other));
    });
  }
  return new Float32Array(ends);
}

// Colours of the corners of all triangles, a byte per channel.
function naturalColours(ofVertices, mesh) {
  const colours = new Uint8Array(3 * mesh.vertices.length);
  mesh.vertices.forEach((vertex, k) => colours.set(ofVertices.subarray(3 * vertex, 3 * vertex + 3), 3 * k));
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

function falseColours(faces, mesh, values, scale) {
  const ofRow = Array.from(values, (value) => falseColour(shareOf(value, scale)));
  const colours = new Uint8Array(3 * mesh.vertices.length);
  mesh.faceOf.forEach((face, triangle) => {
    for (let corner = 0; corner < 3; ++corner) colours.set(ofRow[faces.row[face]], 9 * triangle + 3 * corner);
  });
  return colours;
}
