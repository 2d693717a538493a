// Tools: what pressing, dragging and turning the wheel on the map do.
import { obstacleAt, robotAt } from "live/scene.js";

// Whole millimetres, so that scripts are short.
const rounded = (input) => Object.fromEntries(Object.entries(input).map(([name, value]) => [name, typeof value === "number" ? Math.round(value * 1000) / 1000 : value]));

/** Way that counts as a drag [px], and time between two moves of an obstacle that is dragged [ms]. */
const DRAG = 6, MOVE_EVERY = 80;

export const TOOLS = [
  { name: "look", icon: "pan_tool", key: "v", help: "Look: drag the map, choose a robot, turn the wheel to zoom" },
  { name: "pose", icon: "place", key: "p", help: "Set the pose: press where the robot shall be and drag to where it shall look" },
  { name: "goal", icon: "flag", key: "g", help: "Send the robot: press where it shall go and drag to where it shall look" },
  { name: "disc", icon: "circle", key: "o", help: "Obstacle: press for a disc, drag for its size; drag one to move it" },
  { name: "box", icon: "square", key: "b", help: "Box: press for a square, drag from corner to corner; drag one to move it" },
  { name: "remove", icon: "backspace", key: "x", help: "Remove an obstacle: press on it" },
];

export class Tools {
  /** @param page Has link, camera, tool, robot, ask(input), choose(robot), redraw(), sketch, cursor. */
  constructor(canvas, page) {
    Object.assign(this, { canvas, page, pointers: new Map(), drag: null, lastMove: 0 });
    canvas.addEventListener("pointerdown", (event) => this.down(event));
    canvas.addEventListener("pointermove", (event) => this.move(event));
    canvas.addEventListener("pointerup", (event) => this.up(event));
    canvas.addEventListener("pointercancel", (event) => { this.pointers.delete(event.pointerId); this.cancel(); });
    canvas.addEventListener("pointerleave", () => { page.cursor = null; page.redraw(); });
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      page.camera.zoom(Math.exp(-event.deltaY * (event.deltaMode ? 20 : 1) / 400), [event.offsetX, event.offsetY]);
      page.redraw();
    }, { passive: false });
  }

  cancel() { this.drag = null; this.page.sketch = null; this.page.redraw(); }

  down(event) {
    const { page } = this, screen = [event.offsetX, event.offsetY];
    document.activeElement?.blur?.();
    this.canvas.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, screen);
    if (this.pointers.size > 1) return this.cancel();
    const place = page.camera.toMap(screen), slop = 6 / page.camera.scale;
    const tool = event.button === 0 ? page.tool : "look";
    const thing = ["disc", "box"].includes(tool) ? obstacleAt(page.link.parts, place, slop) : undefined;
    this.drag = { tool, screen, last: screen, place, thing, moved: false };
    if (thing) this.drag.offset = [thing.pose[0] - place[0], thing.pose[1] - place[1]];
  }

  move(event) {
    const { page, drag } = this, screen = [event.offsetX, event.offsetY];
    page.cursor = page.camera.toMap(screen);
    if (this.pointers.has(event.pointerId) && this.pointers.size === 2) this.pinch(event.pointerId, screen);
    this.pointers.has(event.pointerId) && this.pointers.set(event.pointerId, screen);
    if (drag) {
      drag.moved ||= Math.hypot(screen[0] - drag.screen[0], screen[1] - drag.screen[1]) > DRAG;
      if (drag.tool === "look" && drag.moved) { page.camera.pan(screen[0] - drag.last[0], screen[1] - drag.last[1]); page.camera.follows = false; }
      else if (drag.tool !== "look") this.sketch(drag, page.cursor);
      drag.last = screen;
    }
    page.redraw();
  }

  up(event) {
    const { page, drag } = this;
    this.pointers.delete(event.pointerId);
    if (!drag) return;
    const to = page.camera.toMap([event.offsetX, event.offsetY]);
    this.cancel();
    const action = { look: this.chooseAt, pose: this.sendPose, goal: this.sendPose, disc: this.putThing, box: this.putThing, remove: this.removeAt }[drag.tool];
    action.call(this, drag, to);
  }

  pinch(id, screen) {
    const [other] = [...this.pointers].filter(([each]) => each !== id).map(([, place]) => place), before = this.pointers.get(id);
    const factor = Math.hypot(screen[0] - other[0], screen[1] - other[1]) / Math.max(1, Math.hypot(before[0] - other[0], before[1] - other[1]));
    this.page.camera.zoom(factor, other);
  }

  /** What the drag would do, to draw it before it is done. An obstacle that is dragged moves at once. */
  sketch(drag, to) {
    const { page } = this, [x, y] = drag.place;
    if (drag.thing) {
      const pose = [to[0] + drag.offset[0], to[1] + drag.offset[1], drag.thing.pose[2]];
      page.sketch = { name: drag.thing.name, pose };
      if (drag.moved && performance.now() - this.lastMove > MOVE_EVERY) { this.lastMove = performance.now(); this.moveThing(drag.thing, pose); }
    } else if (["pose", "goal"].includes(drag.tool)) page.sketch = { kind: drag.tool, arrow: [[x, y], to] };
    else if (drag.moved && ["disc", "box"].includes(drag.tool)) { const { pose, shape } = shaped(drag, to); page.sketch = { pose, shape }; }
  }

  chooseAt(drag) {
    const { page } = this, found = robotAt(page.link.parts, drag.place, 8 / page.camera.scale);
    if (!drag.moved && found !== undefined) page.choose(found);
  }

  sendPose(drag, to) {
    const { page } = this, [x, y] = drag.place, before = page.link.parts.now.robots[page.robot]?.pose ?? [0, 0, 0];
    const yaw = drag.moved ? Math.atan2(to[1] - y, to[0] - x) : drag.tool === "pose" ? before[2] : Math.atan2(y - before[1], x - before[0]);
    page.ask(rounded({ kind: drag.tool === "pose" ? "set_pose" : "set_goal", robot: page.robot, x, y, yaw }));
  }

  putThing(drag, to) {
    if (drag.thing) {
      if (drag.moved) this.moveThing(drag.thing, [to[0] + drag.offset[0], to[1] + drag.offset[1], drag.thing.pose[2]]);
      return;
    }
    const { pose: [x, y], size } = shaped(drag, to);
    this.page.ask(rounded({ kind: "add_obstacle", x, y, ...size }));
  }

  moveThing(thing, [x, y, yaw]) { this.page.ask(rounded({ kind: "move_obstacle", name: thing.name, x, y, yaw })); }

  removeAt(drag) {
    const { page } = this, thing = obstacleAt(page.link.parts, drag.place, 8 / page.camera.scale);
    if (thing) page.ask({ kind: "remove_obstacle", name: thing.name });
    else page.say("There is no obstacle here. Only obstacles can be removed, not walls of the map.");
  }
}

/** The obstacle that a drag describes: its pose, its outline, and its size as an input has it. */
function shaped(drag, to) {
  const [x, y] = drag.place;
  if (drag.tool === "disc") {
    const radius = drag.moved ? Math.max(0.02, Math.hypot(to[0] - x, to[1] - y)) : 0.3;
    return { pose: [x, y, 0], shape: { radius }, size: { radius } };
  }
  const length = drag.moved ? Math.max(0.05, Math.abs(to[0] - x)) : 0.6, width = drag.moved ? Math.max(0.05, Math.abs(to[1] - y)) : 0.6;
  const pose = drag.moved ? [(x + to[0]) / 2, (y + to[1]) / 2, 0] : [x, y, 0], [a, b] = [length / 2, width / 2];
  return { pose, shape: { corners: [[-a, -b], [a, -b], [a, b], [-a, b]] }, size: { length, width } };
}
