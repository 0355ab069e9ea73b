// A material for each group of faces, all opaque or as their opacity says: a pane adds what it reflects to what is seen
// through it.
function surfaceMaterials(groups) {
  const plain = {vertexColors: THREE.VertexColors, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1};
  const opaque = new THREE.MeshBasicMaterial(plain);
  const clear = (opacity) => new THREE.MeshBasicMaterial({...plain, transparent: true, opacity, depthWrite: false, blending: THREE.CustomBlending,
    blendSrc: THREE.OneFactor, blendDst: THREE.OneMinusSrcAlphaFactor});
  return {opaque: groups.map(() => opaque), seeThrough: groups.map(({opacity}) => opacity < 1 ? clear(opacity) : opaque)};
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

// The model on its canvas. Coordinates inside are metres from the middle of its bounds. Throws where there is no WebGL.
function modelView(canvas, model) {
  const {faces, up} = model;
  const mesh = triangles(faces, (row) => model.opacity[model.rows.material_id[row]]);
  const renderer = new THREE.WebGLRenderer({canvas, antialias: true, preserveDrawingBuffer: true});
  renderer.setClearColor(getComputedStyle(document.documentElement).getPropertyValue("--stage").trim());
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(mesh.positions, 3));
  geometry.setAttribute("color", new THREE.BufferAttribute(new Uint8Array(mesh.positions.length), 3, true));
  // A side without patches is not drawn: rooms are looked into from outside.
  const {opaque, seeThrough} = surfaceMaterials(mesh.groups);
  mesh.groups.forEach(({first, count}, k) => geometry.addGroup(3 * first, 3 * count, k));
  const solid = new THREE.Mesh(geometry, opaque);
  const scene = new THREE.Scene();
  scene.add(solid);
  const sky = model.sky ? skyDome(model.sky) : null;
  if (sky) {
    sky.scale.setScalar(mesh.size);
    scene.add(sky);
  }
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
      if (sky) sky.position.copy(camera.position);
      renderer.render(scene, camera);
    });
  };
  view.fit = () => {
    const {clientWidth, clientHeight} = canvas.parentElement;
    renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
    renderer.setSize(clientWidth, clientHeight, false);
    camera.aspect = clientWidth / clientHeight;
    camera.updateProjectionMatrix();
    view.draw();
  };
  // With the colours of the sky the model is drawn as it looks, panes clear; without, in false colours.
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
  // Along an axis, in metres of the model; null for no cut.
  view.setCut = (axis, at, otherHalf) => {
    const sign = otherHalf ? 1 : -1;
    const normal = new THREE.Vector3().setComponent(axis === null ? 0 : axis, sign);
    view.cut = axis === null ? null : new THREE.Plane(normal, -sign * (at - mesh.middle[axis]));
    renderer.clippingPlanes = view.cut ? [view.cut] : [];
    if (sky) sky.visible = sky.userData.wanted && view.cut === null;
    view.draw();
  };
  view.lines = (ends, colour) => {
    const made = new THREE.BufferGeometry();
    made.setAttribute("position", new THREE.BufferAttribute(ends, 3));
    const lines = new THREE.LineSegments(made, new THREE.LineBasicMaterial({color: colour}));
    scene.add(lines);
    view.draw();
    return {remove: () => { scene.remove(lines); made.dispose(); view.draw(); }};
  };
  // What is drawn at a place of the canvas, -1 to 1 from left to right and from below to above.
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
