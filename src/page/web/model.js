// By how much fillers extend beyond the edges of faces, in pixels. A rounded corner on a neighbor's edge leaves smaller gaps.
const overlap = 0.15;

// How far faces under others are drawn behind them, layer by layer.
const behind = (layer) => layer / 16;

// Faces once more, larger by the rounding of positions and a part of a pixel, and farther away by a few times that: they
// fill gaps between faces and are hidden elsewhere. `reach` holds both.
function underneath(material, reach) {
  material.onBeforeCompile = (shader) => {
    shader.uniforms.reach = reach;
    shader.vertexShader = "attribute vec3 outward;\nuniform vec2 reach;\n" + shader.vertexShader
      .replace("#include <begin_vertex>", "#include <begin_vertex>\nfloat away = length((modelViewMatrix * vec4(position, 1.0)).xyz);"
        + "\nfloat larger = reach.x + reach.y * away;\ntransformed += 2.0 * outward * larger;")
      .replace("#include <project_vertex>", "#include <project_vertex>\nmvPosition.xyz *= 1.0 + 8.0 * larger / max(away, 1e-6);\ngl_Position = projectionMatrix * mvPosition;");
  };
  return material;
}

// A material for each group of faces, all opaque or with their own opacity. A pane adds its reflection to the light
// through it. Faces under others are drawn farther away, by a fraction of their change of depth across a pixel: more would
// let other faces through at their edges.
function surfaceMaterials(groups, reach) {
  const plain = (layer) => ({vertexColors: THREE.VertexColors, polygonOffset: true, polygonOffsetFactor: behind(layer), polygonOffsetUnits: 1 + 4 * layer});
  const opaque = ({layer}) => new THREE.MeshBasicMaterial(plain(layer));
  const clear = ({layer, opacity}) => new THREE.MeshBasicMaterial({...plain(layer), transparent: true, opacity, depthWrite: false, blending: THREE.CustomBlending,
    blendSrc: THREE.OneFactor, blendDst: THREE.OneMinusSrcAlphaFactor});
  const all = groups.map(opaque);
  const none = new THREE.MeshBasicMaterial({visible: false});
  return {opaque: all, seeThrough: groups.map((group, k) => group.opacity < 1 ? clear(group) : all[k]),
    fillers: groups.map((group) => group.opacity < 1 ? none : underneath(opaque(group), reach))};
}

// Closed solids that are cut: their faces from inside, in one color, look like the plane of the cut.
function fillOf(mesh, faces, filled) {
  const places = [];
  mesh.faceOf.forEach((face, triangle) => {
    if (filled[faces.row[face]] === 1) places.push(...mesh.positions.subarray(9 * triangle, 9 * triangle + 9));
  });
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(places), 3));
  const colour = new THREE.Color(...unlit.map((part) => part / 255));
  const fill = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({color: colour, side: THREE.BackSide, polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 8}));
  fill.visible = false;
  return fill;
}

// Sky and ground around the eye, behind all else.
function skyDome({directions, inARing}) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(directions, 3));
  geometry.setAttribute("color", new THREE.BufferAttribute(new Uint8Array(directions.length), 3, true));
  geometry.setIndex(dome(directions, inARing));
  const sky = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({vertexColors: THREE.VertexColors, side: THREE.DoubleSide, depthWrite: false, depthTest: false}));
  sky.renderOrder = -1;
  sky.frustumCulled = false;
  return sky;
}

// The model on its canvas. Coordinates inside are meters from the middle of its bounds. Throws where there is no WebGL.
function modelView(canvas, model) {
  const {faces, up} = model;
  const mesh = triangles(faces, (row) => model.opacity[model.rows.material_id[row]], (row) => model.rows.layer[row], model.rows.dark);
  const renderer = new THREE.WebGLRenderer({canvas, preserveDrawingBuffer: true});
  renderer.setClearColor(getComputedStyle(document.documentElement).getPropertyValue("--stage").trim());
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(mesh.positions, 3));
  geometry.setAttribute("color", new THREE.BufferAttribute(new Uint8Array(mesh.positions.length), 3, true));
  geometry.setAttribute("outward", new THREE.BufferAttribute(mesh.outward, 3, true));
  // A side without patches is not drawn: rooms are looked into from outside.
  const reach = {value: new THREE.Vector2()};
  const {opaque, seeThrough, fillers} = surfaceMaterials(mesh.groups, reach);
  mesh.groups.forEach(({first, count}, k) => geometry.addGroup(3 * first, 3 * count, k));
  const solid = new THREE.Mesh(geometry, opaque);
  const scene = new THREE.Scene();
  scene.add(solid);
  scene.add(new THREE.Mesh(geometry, fillers));
  const fill = fillOf(mesh, faces, model.rows.filled);
  scene.add(fill);
  const bounds = new THREE.Box3().setFromBufferAttribute(geometry.attributes.position);
  const sky = model.sky ? skyDome(model.sky) : null;
  if (sky) scene.add(sky);
  const camera = new THREE.PerspectiveCamera(50, 4 / 3, mesh.size / 2000, mesh.size * 20);
  camera.up.set(...up);
  const controls = new THREE.OrbitControls(camera, canvas);
  controls.enableKeys = false;
  controls.screenSpacePanning = true;
  let waiting = false;
  const view = {mesh, camera, controls, canvas, size: mesh.size, cut: null};

  view.draw = () => {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => {
      waiting = false;
      // The near plane: a larger distance gives better depth resolution.
      camera.near = Math.max(mesh.size / 2000, 0.9 * bounds.distanceToPoint(camera.position) * Math.cos(0.5 * camera.fov * Math.PI / 180) * 0.5);
      camera.updateProjectionMatrix();
      reach.value.set(mesh.rounding, overlap * 2 * Math.tan(0.5 * camera.fov * Math.PI / 180) / Math.max(1, canvas.height));
      if (sky) sky.position.copy(camera.position);
      if (sky) sky.scale.setScalar(4 * camera.near);
      renderer.render(scene, camera);
    });
  };
  view.fit = () => {
    const {clientWidth, clientHeight} = canvas.parentElement;
    // Twice as many pixels smooth edges. Multisampling would do it with the depth of steep faces outside of these.
    renderer.setPixelRatio(2 * Math.min(1.5, window.devicePixelRatio || 1));
    renderer.setSize(clientWidth, clientHeight, false);
    camera.aspect = clientWidth / clientHeight;
    camera.updateProjectionMatrix();
    view.draw();
  };
  // With the colors of the sky the model is drawn as it looks, panes clear; without, in false colors.
  view.colour = (colours, natural, ofSky) => {
    geometry.attributes.color.array.set(colours);
    geometry.attributes.color.needsUpdate = true;
    solid.material = natural ? seeThrough : opaque;
    if (sky) {
      sky.userData.wanted = Boolean(ofSky);
      if (ofSky) sky.geometry.attributes.color.array.set(ofSky);
      sky.geometry.attributes.color.needsUpdate = true;
      sky.visible = sky.userData.wanted && view.cut === null;
    }
    view.draw();
  };
  view.inside = (place) => new THREE.Vector3(...place.map((value, axis) => value - mesh.middle[axis]));
  view.look = (eye, target, fieldOfView) => {
    camera.fov = fieldOfView;
    camera.position.copy(view.inside(eye));
    controls.target.copy(view.inside(target));
    camera.updateProjectionMatrix();
    controls.update();
    view.draw();
  };
  // Along an axis, in meters of the model; null for no cut.
  view.setCut = (axis, at, otherHalf) => {
    const sign = otherHalf ? 1 : -1;
    const normal = new THREE.Vector3().setComponent(axis === null ? 0 : axis, sign);
    view.cut = axis === null ? null : new THREE.Plane(normal, -sign * (at - mesh.middle[axis]));
    renderer.clippingPlanes = view.cut ? [view.cut] : [];
    fill.visible = view.cut !== null;
    if (sky) sky.visible = sky.userData.wanted && view.cut === null;
    view.draw();
  };
  // Faces are drawn behind lines on them, by their change of depth across a pixel. Without such lines they are not: a
  // face that is seen at a flat angle would let other faces through at its edge.
  let linesOnFaces = 0;
  const addLinesOnFaces = (more) => {
    linesOnFaces += more;
    for (const [k, {layer}] of mesh.groups.entries())
      for (const material of [opaque[k], seeThrough[k]]) material.polygonOffsetFactor = behind(layer) + (linesOnFaces > 0 ? 1 : 0);
    view.draw();
  };
  view.lines = (ends, colour, onFaces = true) => {
    const made = new THREE.BufferGeometry();
    made.setAttribute("position", new THREE.BufferAttribute(ends, 3));
    const lines = new THREE.LineSegments(made, new THREE.LineBasicMaterial({color: colour}));
    scene.add(lines);
    addLinesOnFaces(onFaces ? 1 : 0);
    return {remove: () => { scene.remove(lines); made.dispose(); addLinesOnFaces(onFaces ? -1 : 0); }};
  };
  // The face drawn at a place of the canvas, -1 to 1 from left to right and from below to above.
  view.pick = (x, y) => {
    const ray = new THREE.Raycaster();
    ray.setFromCamera(new THREE.Vector2(x, y), camera);
    const hit = ray.intersectObject(solid).find(({point}) => view.cut === null || view.cut.distanceToPoint(point) >= 0);
    if (!hit) return null;
    const face = mesh.faceOf[hit.faceIndex];
    return {face, row: faces.row[face], place: hit.point.toArray().map((value, axis) => value + mesh.middle[axis])};
  };
  controls.addEventListener("change", view.draw);
  new ResizeObserver(view.fit).observe(canvas.parentElement);
  view.fit();
  return view;
}
