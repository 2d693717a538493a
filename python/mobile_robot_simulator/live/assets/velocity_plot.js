// VelocityPlot: speed and turn rate of a robot over the last seconds.

const SECONDS = 20;

export class VelocityPlot {
  constructor() { Object.assign(this, { robot: null, rows: [] }); }

  /** Takes the present velocity. Another robot, or a time before the last one, starts anew. */
  add(robot, time, [vx, vy, wz]) {
    if (robot !== this.robot || time < (this.rows.at(-1)?.[0] ?? 0)) Object.assign(this, { robot, rows: [] });
    if (time === this.rows.at(-1)?.[0]) this.rows.pop();
    this.rows.push([time, Math.abs(vy) > Math.abs(vx) ? vy : vx, wz]);
    const keep = this.rows.findIndex((row) => row[0] >= time - SECONDS);
    if (keep > 1) this.rows.splice(0, keep - 1);
  }

  /** Draws the plot. The scale is symmetric and grows with the values. */
  draw(canvas, look) {
    const ratio = devicePixelRatio, w = canvas.clientWidth, h = canvas.clientHeight, c = canvas.getContext("2d");
    if (canvas.width !== Math.round(w * ratio)) Object.assign(canvas, { width: Math.round(w * ratio), height: Math.round(h * ratio) });
    c.setTransform(ratio, 0, 0, ratio, 0, 0); c.clearRect(0, 0, w, h);
    const now = this.rows.at(-1)?.[0] ?? 0, middle = 8 + h / 2;
    const limit = (k) => [0.5, 1, 2, 5, 10, 20, 50, 100, 1000].find((each) => each >= Math.max(...this.rows.map((row) => Math.abs(row[k])), 0)) ?? 1e4;
    c.strokeStyle = look.soft; c.lineWidth = 0.5;
    for (const y of [18, middle, h - 2]) { c.beginPath(); c.moveTo(0, y); c.lineTo(w, y); c.stroke(); }
    for (const [k, color, dash] of [[1, look.robots[0], []], [2, look.scan, [5, 3]]]) {
      const scale = (middle - 18) / limit(k);
      c.strokeStyle = color; c.lineWidth = 2; c.lineJoin = "round"; c.setLineDash(dash); c.beginPath();
      this.rows.forEach(([time, ...values], i) => { const x = w * (1 - (now - time) / SECONDS), y = middle - values[k - 1] * scale; i ? c.lineTo(x, y) : c.moveTo(x, y); });
      c.stroke(); c.setLineDash([]);
    }
    c.fillStyle = look.soft; c.font = "10px sans-serif";
    c.textAlign = "left"; c.fillText(`±${limit(1)} m/s`, 2, 12); c.textAlign = "right"; c.fillText(`±${limit(2)} rad/s`, w - 2, 12);
    c.textAlign = "left"; c.fillText(`last ${SECONDS} s`, 2, h - 5);
  }
}
