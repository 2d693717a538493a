// Camera: which part of the map is on the screen.

export class Camera {
  constructor() { Object.assign(this, { x: 0, y: 0, scale: 50, width: 1, height: 1, follows: false }); }

  /** Shows all of a map, with room for what lies over its edges. @param margins Left, top, right and bottom [px]. */
  fit(map, [left, top, right, bottom]) {
    const cos = Math.cos(map.origin[2]), sin = Math.sin(map.origin[2]);
    const w = map.columns * map.resolution, h = map.rows * map.resolution;
    const corners = [[0, 0], [w, 0], [0, h], [w, h]].map(([x, y]) => [map.origin[0] + cos * x - sin * y, map.origin[1] + sin * x + cos * y]);
    const [xs, ys] = [corners.map((p) => p[0]), corners.map((p) => p[1])];
    const [x0, x1, y0, y1] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
    this.scale = Math.max(1, Math.min((this.width - left - right) / (x1 - x0), (this.height - top - bottom) / (y1 - y0)));
    this.x = (x0 + x1) / 2 + (right - left) / 2 / this.scale;
    this.y = (y0 + y1) / 2 + (top - bottom) / 2 / this.scale;
  }

  /** Point in the map [m] of a point on the screen [px]. */
  toMap([u, v]) { return [this.x + (u - this.width / 2) / this.scale, this.y - (v - this.height / 2) / this.scale]; }

  /** Point on the screen [px] of a point in the map [m]. */
  toScreen([x, y]) { return [this.width / 2 + (x - this.x) * this.scale, this.height / 2 - (y - this.y) * this.scale]; }

  /** Zooms by a factor and keeps a point of the screen in its place. */
  zoom(factor, at) {
    const before = this.toMap(at);
    this.scale = Math.min(2000, Math.max(1, this.scale * factor));
    const after = this.toMap(at);
    this.x += before[0] - after[0];
    this.y += before[1] - after[1];
  }

  /** Moves the map by a way on the screen [px]. */
  pan(du, dv) { this.x -= du / this.scale; this.y += dv / this.scale; }

  /** Length of a scale bar [m] that is at most `pixels` long: 1, 2 or 5 times a power of ten. */
  barLength(pixels) {
    const most = pixels / this.scale, power = 10 ** Math.floor(Math.log10(most));
    return power * (most >= 5 * power ? 5 : most >= 2 * power ? 2 : 1);
  }
}
