// Turning, walking and choosing by keys, for the canvas in focus.
function turned(view, sideways, upward) {
  const {camera, controls} = view;
  const offset = camera.position.clone().sub(controls.target);
  const right = new THREE.Vector3().crossVectors(camera.up, offset).normalize();
  offset.applyAxisAngle(camera.up, sideways);
  const steep = offset.angleTo(camera.up) - upward;
  if (steep > 0.05 && steep < Math.PI - 0.05) offset.applyAxisAngle(right.applyAxisAngle(camera.up, sideways), -upward);
  camera.position.copy(controls.target).add(offset);
}

function walked(view, forward, sideways, upward) {
  const {camera, controls} = view;
  const up = camera.up.clone().normalize();
  const ahead = controls.target.clone().sub(camera.position);
  ahead.addScaledVector(up, -ahead.dot(up));
  if (ahead.lengthSq() < 1e-12) ahead.set(0, 1, 0).applyQuaternion(camera.quaternion);
  ahead.normalize();
  const step = new THREE.Vector3().addScaledVector(ahead, forward).addScaledVector(new THREE.Vector3().crossVectors(ahead, up), sideways).addScaledVector(up, upward);
  camera.position.add(step);
  controls.target.add(step);
}

function listenToKeys(view, actions) {
  const angle = 0.08, step = view.size / 60;
  const keys = {
    ArrowLeft: () => turned(view, -angle, 0), ArrowRight: () => turned(view, angle, 0),
    ArrowUp: () => turned(view, 0, angle), ArrowDown: () => turned(view, 0, -angle),
    w: () => walked(view, step, 0, 0), s: () => walked(view, -step, 0, 0), a: () => walked(view, 0, -step, 0), d: () => walked(view, 0, step, 0),
    e: () => walked(view, 0, 0, step), q: () => walked(view, 0, 0, -step),
    "+": () => view.camera.position.lerp(view.controls.target, 0.1), "-": () => view.camera.position.lerp(view.controls.target, -0.1),
    Home: actions.home, Enter: actions.choose,
  };
  view.canvas.addEventListener("keydown", (event) => {
    const act = keys[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!act || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    act();
    view.controls.update();
    view.draw();
  });
}
