// Under the ground there is nothing to see: the camera stays above it. Heights are in the player, where +y points up.
function stayAbove(player, ground) {
  const control = player.cameraControl;
  if (ground === null || !control || !player.camera) return;
  const target = control.getTarget(player.camera.position.clone());
  const sine = (ground - target.y) / control.distance + 0.01;
  control.maxPolarAngle = Math.acos(Math.min(Math.max(sine, -1), 0.99));
  // Moving the target down, or coming closer, turns nothing.
  if (control.polarAngle > control.maxPolarAngle) control.rotatePolarTo(control.maxPolarAngle, false);
}
