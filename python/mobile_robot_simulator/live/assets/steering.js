// Steering: turns keys, the pad on the screen and a gamepad into velocities. While something is held, the velocity is repeated,
// because the simulation stops a robot whose commands end.

const KEYS = { w: [1, 0, 0], ArrowUp: [1, 0, 0], s: [-1, 0, 0], ArrowDown: [-1, 0, 0], a: [0, 0, 1], ArrowLeft: [0, 0, 1], d: [0, 0, -1], ArrowRight: [0, 0, -1], q: [0, 1, 0], e: [0, -1, 0] };
const REPEAT = 100, DEAD = 0.15;

/** True while keys are for a text field, a list or a dialog. A list that has closed keeps the focus, but gets no keys. */
export const isTyping = () => document.querySelector(".q-menu, .q-dialog") !== null || (document.activeElement?.matches("input:not([readonly]), textarea, [contenteditable=true]") ?? false);

const keyOf = (event) => (event.key.length === 1 ? event.key.toLowerCase() : event.key);

export class Steering {
  /** @param drive Called with vx, vy, wz, each a share of the top speed from -1 to 1. */
  constructor(drive) {
    Object.assign(this, { drive, keys: new Set(), pad: null, moved: false });
    this.down = (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey || isTyping() || !(keyOf(event) in KEYS)) return;
      event.preventDefault();
      event.stopPropagation();
      if (!this.keys.has(keyOf(event))) { this.keys.add(keyOf(event)); this.tick(); }
    };
    this.up = (event) => { if (this.keys.delete(keyOf(event))) this.tick(); };
    this.blur = () => { this.keys.clear(); this.pad = null; this.tick(); };
    addEventListener("keydown", this.down, true); addEventListener("keyup", this.up, true); addEventListener("blur", this.blur);
    this.timer = setInterval(() => this.tick(), REPEAT);
  }

  close() {
    clearInterval(this.timer);
    removeEventListener("keydown", this.down, true); removeEventListener("keyup", this.up, true); removeEventListener("blur", this.blur);
  }

  /** Holds the pad at a place: shares of the top speed, forward and to the left; null lets it go. */
  setPad(place) { this.pad = place; this.tick(); }

  tick() {
    const wanted = this.wanted();
    if (wanted) { this.drive(...wanted); this.moved = true; }
    else if (this.moved) { this.drive(0, 0, 0); this.moved = false; }
  }

  wanted() {
    if (this.pad) return [this.pad[0], 0, this.pad[1]];
    if (this.keys.size) {
      const sum = [0, 0, 0];
      for (const key of this.keys) KEYS[key].forEach((value, i) => (sum[i] += value));
      return sum.map((value) => Math.max(-1, Math.min(1, value)));
    }
    for (const gamepad of navigator.getGamepads?.() ?? []) {
      if (!gamepad?.connected) continue;
      const [x = 0, y = 0, turn = 0] = gamepad.axes.map((value) => (Math.abs(value) < DEAD ? 0 : value));
      if (x || y || turn) return gamepad.axes.length > 2 ? [-y, -x, -turn] : [-y, 0, -x];
    }
    return null;
  }
}
