// The model on its canvas. Coordinates inside are metres from the middle of its bounds. Throws where there is no WebGL.
function modelView(canvas, faces, up) {
  const mesh = triangles(faces);
  const renderer = new THREE.WebGLRenderer({canvas, antialias: true, preserveDrawingBuffer: true});
  renderer.setClearColor(getComputedStyle(document.documentElement).getPropertyValue("--stage").trim());
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(mesh.positions, 3));
  geometry.setAttribute("color", new THREE.BufferAttribute(new Uint8Array(mesh.positions.length), 3, true));
  // A side without patches is not drawn: rooms are looked into from outside.
  const solid = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({vertexColors: THREE.VertexColors, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1}));
  const scene = new THREE.Scene();
  scene.add(solid);
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
  view.colour = (colours) => {
    geometry.attributes.color.array.set(colours);
    geometry.attributes.color.needsUpdate = true;
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
