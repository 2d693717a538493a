// Scene: draws the map and everything on it.

/** Default radius of a robot without a footprint [m], only to show where it is. */
const POINT_RADIUS = 0.15;

function trace(c, outline, fallback) {
  c.beginPath();
  if (outline?.corners) { outline.corners.forEach((p, i) => (i ? c.lineTo(...p) : c.moveTo(...p))); c.closePath(); }
  else c.arc(0, 0, outline?.radius ?? fallback, 0, 2 * Math.PI);
}

function at(c, pose, draw) { c.save(); c.translate(pose[0], pose[1]); c.rotate(pose[2] ?? 0); draw(); c.restore(); }

const reach = (outline) => outline?.radius ?? (outline?.corners ? Math.max(...outline.corners.map((p) => Math.hypot(...p))) : POINT_RADIUS);

export function arrow(c, from, to, width, color) {
  const length = Math.hypot(to[0] - from[0], to[1] - from[1]), yaw = Math.atan2(to[1] - from[1], to[0] - from[0]);
  if (length < 1e-9) return;
  const head = Math.min(length, 5 * width);
  at(c, [...from, yaw], () => {
    c.strokeStyle = c.fillStyle = color; c.lineWidth = width; c.lineCap = "round";
    c.beginPath(); c.moveTo(0, 0); c.lineTo(length - head * 0.8, 0); c.stroke();
    c.beginPath(); c.moveTo(length, 0); c.lineTo(length - head, head * 0.55); c.lineTo(length - head, -head * 0.55); c.closePath(); c.fill();
  });
}

/**
 * Draws a frame.
 * @param c Context of the canvas. @param state link, camera, look, mapImage, layers, robot (chosen), sketch (of a drag).
 */
export function drawScene(c, { link, camera, look, mapImage, layers, robot, sketch, ratio }) {
  const { parts, trails } = link, now = parts.now;
  c.setTransform(ratio, 0, 0, ratio, 0, 0);
  c.fillStyle = look.back; c.fillRect(0, 0, camera.width, camera.height);
  c.translate(camera.width / 2, camera.height / 2); c.scale(camera.scale, -camera.scale); c.translate(-camera.x, -camera.y);
  const px = 1 / camera.scale;
  if (mapImage) mapImage.draw(c, parts.map, camera.scale * parts.map.resolution);
  if (!now) return;
  const names = Object.keys(now.robots), colorOf = (name) => look.robots[Math.max(0, names.indexOf(name)) % look.robots.length];
  if (layers.area || layers.points) drawScans(c, parts, robot, look, layers, px);
  for (const name of names) {
    if (layers.odometry) drawTrail(c, trails[name], 2, look.ink, [5 * px, 4 * px], 1.5 * px);
    if (layers.path) drawTrail(c, trails[name], 0, colorOf(name), [], 2.5 * px);
  }
  for (const thing of parts.obstacles ?? []) {
    const place = sketch?.name === thing.name ? sketch.pose : thing.pose;
    at(c, place, () => { trace(c, thing, 0.3); c.fillStyle = look.thing; c.fill(); c.strokeStyle = look.thingEdge; c.lineWidth = 1.5 * px; c.stroke(); });
    const [vx, vy] = thing.velocity;
    if (layers.velocity && Math.hypot(vx, vy) > 0.01) arrow(c, place, [place[0] + vx, place[1] + vy], 3 * px, look.thingEdge);
  }
  if (layers.contacts) for (const points of Object.values(parts.contacts ?? {})) for (const p of points) drawContact(c, p, look, px);
  for (const [name, pilot] of Object.entries(parts.session?.pilots ?? {})) if (pilot.goal) drawGoal(c, pilot.goal, now.robots[name]?.pose, colorOf(name), look, px);
  for (const name of names) drawRobot(c, now.robots[name], parts.outlines?.[name], { color: colorOf(name), chosen: name === robot && names.length > 1, label: names.length > 1 ? name : "", odometry: layers.odometry }, look, px);
  if (sketch) drawSketch(c, sketch, look, px);
}

function drawScans(c, parts, robot, look, layers, px) {
  for (const [key, scan] of Object.entries(parts)) {
    if (!key.startsWith("scan:")) continue;
    const own = key.startsWith(`scan:${robot}:`), { xy, hit } = scan;
    if (own && layers.area) {
      c.fillStyle = look.area; c.beginPath(); c.moveTo(scan.place[0], scan.place[1]);
      // A single beam without a return among others is a failed reading. Drawn, it would be a spike through walls.
      for (let i = 0; i < hit.length; i++) if (hit[i] || !hit[i - 1] || !hit[i + 1]) c.lineTo(xy[2 * i], xy[2 * i + 1]);
      c.closePath(); c.fill();
    }
    if (!layers.points) continue;
    const size = (own ? 3.5 : 2) * px;
    c.fillStyle = look.scan; c.globalAlpha = own ? 1 : 0.5;
    for (let i = 0; i < hit.length; i++) if (hit[i]) c.fillRect(xy[2 * i] - size / 2, xy[2 * i + 1] - size / 2, size, size);
    c.globalAlpha = 1;
  }
}

function drawTrail(c, trail, k, color, dash, width) {
  if (!trail?.length) return;
  c.strokeStyle = color; c.lineWidth = width; c.lineJoin = c.lineCap = "round"; c.setLineDash(dash); c.beginPath();
  let joined = false;
  for (const p of trail) {
    if (p) joined ? c.lineTo(p[k], p[k + 1]) : c.moveTo(p[k], p[k + 1]);
    joined = Boolean(p);
  }
  c.stroke(); c.setLineDash([]);
}

function drawRobot(c, state, outline, { color, chosen, label, odometry }, look, px) {
  const r = reach(outline);
  if (odometry) at(c, state.believed, () => { trace(c, outline, POINT_RADIUS); c.strokeStyle = look.ink; c.lineWidth = 1.5 * px; c.setLineDash([4 * px, 3 * px]); c.stroke(); c.setLineDash([]); c.beginPath(); c.moveTo(0, 0); c.lineTo(Math.max(r, 8 * px), 0); c.stroke(); });
  at(c, state.pose, () => {
    if (chosen) { c.beginPath(); c.arc(0, 0, r + 6 * px, 0, 2 * Math.PI); c.strokeStyle = color; c.lineWidth = 2.5 * px; c.stroke(); }
    // The head of an arrow points forward. It is inside the footprint, or around one that is too small to see.
    const isSmall = r < 9 * px, s = isSmall ? 12 * px : 0.62 * r;
    if (!isSmall) { trace(c, outline, POINT_RADIUS); c.fillStyle = color; c.fill(); c.strokeStyle = look.halo; c.lineWidth = 2 * px; c.stroke(); }
    c.beginPath(); c.moveTo(s, 0); c.lineTo(-0.7 * s, 0.65 * s); c.lineTo(-0.35 * s, 0); c.lineTo(-0.7 * s, -0.65 * s); c.closePath();
    if (isSmall) { c.strokeStyle = look.halo; c.lineWidth = 3 * px; c.lineJoin = "round"; c.stroke(); }
    c.fillStyle = isSmall ? color : look.halo; c.fill();
  });
  if (label) {
    c.save(); c.translate(state.pose[0], state.pose[1] - r - 14 * px); c.scale(px, -px);
    c.font = "12px sans-serif"; c.textAlign = "center"; c.lineWidth = 3; c.strokeStyle = look.halo; c.strokeText(label, 0, 0); c.fillStyle = look.ink; c.fillText(label, 0, 0); c.restore();
  }
}

function drawContact(c, [x, y], look, px) {
  for (const [width, color] of [[5, look.halo], [2.5, look.ink]]) {
    c.strokeStyle = color; c.lineWidth = width * px; c.beginPath();
    for (const d of [1, -1]) { c.moveTo(x - 6 * px, y - 6 * d * px); c.lineTo(x + 6 * px, y + 6 * d * px); }
    c.stroke();
  }
}

function drawGoal(c, goal, pose, color, look, px) {
  if (pose) { c.strokeStyle = color; c.lineWidth = 1.5 * px; c.setLineDash([2 * px, 5 * px]); c.beginPath(); c.moveTo(pose[0], pose[1]); c.lineTo(goal[0], goal[1]); c.stroke(); c.setLineDash([]); }
  at(c, goal, () => {
    c.strokeStyle = look.halo; c.lineWidth = 5 * px;
    for (let i = 0; i < 2; i++) {
      for (const r of [5, 11]) { c.beginPath(); c.arc(0, 0, r * px, 0, 2 * Math.PI); c.stroke(); }
      c.strokeStyle = look.goal; c.lineWidth = 2.5 * px;
    }
  });
  arrow(c, goal, [goal[0] + 26 * px * Math.cos(goal[2]), goal[1] + 26 * px * Math.sin(goal[2])], 2.5 * px, look.goal);
}

function drawSketch(c, sketch, look, px) {
  if (sketch.arrow) arrow(c, sketch.arrow[0], sketch.arrow[1], 4 * px, sketch.kind === "goal" ? look.goal : look.ink);
  if (sketch.shape) at(c, sketch.pose, () => { trace(c, sketch.shape, 0.3); c.globalAlpha = 0.5; c.fillStyle = look.thing; c.fill(); c.globalAlpha = 1; c.strokeStyle = look.thingEdge; c.lineWidth = 1.5 * px; c.stroke(); });
}

/** Obstacle at a point of the map, or undefined. @param slop Distance that still counts as a hit [m]. */
export function obstacleAt(parts, [x, y], slop) {
  return (parts.obstacles ?? []).findLast((thing) => {
    const [px, py, yaw] = thing.pose, cos = Math.cos(yaw), sin = Math.sin(yaw), dx = x - px, dy = y - py;
    const u = cos * dx + sin * dy, v = -sin * dx + cos * dy;
    if (!thing.corners) return Math.hypot(u, v) <= (thing.radius ?? 0.3) + slop;
    let inside = false;
    for (let i = 0, j = thing.corners.length - 1; i < thing.corners.length; j = i++) {
      const [a, b] = thing.corners[i], [e, f] = thing.corners[j];
      if (b > v !== f > v && u < ((e - a) * (v - b)) / (f - b) + a) inside = !inside;
    }
    return inside;
  });
}

/** Name of the robot at a point of the map, or undefined. */
export function robotAt(parts, [x, y], slop) {
  return Object.entries(parts.now?.robots ?? {}).find(([name, { pose }]) => Math.hypot(pose[0] - x, pose[1] - y) <= reach(parts.outlines?.[name]) + slop)?.[0];
}
