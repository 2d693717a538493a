// MapImage: the cells of the map as an image, with smaller copies of it, so that drawing a large map stays fast.

export class MapImage {
  /** @param map Part "map" of a frame. @param cells Its cells. @param look Colours. */
  constructor(map, cells, look) {
    this.levels = [painted(map, cells, look)];
    for (let last = this.levels[0]; Math.max(last.width, last.height) > 512; last = this.levels.at(-1)) {
      const half = new OffscreenCanvas(Math.ceil(last.width / 2), Math.ceil(last.height / 2));
      const context = half.getContext("2d");
      context.imageSmoothingQuality = "high";
      context.drawImage(last, 0, 0, half.width, half.height);
      this.levels.push(half);
    }
  }

  /** Draws the map in a context whose unit is metres. @param pixelsPerCell Size of a cell on the screen. */
  draw(context, map, pixelsPerCell) {
    const level = Math.min(this.levels.length - 1, Math.max(0, Math.floor(Math.log2(1 / pixelsPerCell))));
    context.save();
    context.translate(map.origin[0], map.origin[1]);
    context.rotate(map.origin[2]);
    context.imageSmoothingEnabled = pixelsPerCell < 1.5;
    // Row 0 of the image is row 0 of the map, and y points up.
    context.drawImage(this.levels[level], 0, 0, map.columns * map.resolution, map.rows * map.resolution);
    context.restore();
  }
}

function painted(map, cells, look) {
  const image = new ImageData(map.columns, map.rows);
  const pixels = new Uint32Array(image.data.buffer), shades = new Uint32Array(256);
  for (let value = -128; value < 128; value++) {
    const share = (0.35 * Math.max(0, value)) / Math.max(1, map.threshold);
    const grey = value < 0 ? look.unknown : value >= map.threshold ? look.wall : Math.round(look.free + share * (look.wall - look.free));
    shades[value & 255] = (0xff000000 | (grey << 16) | (grey << 8) | grey) >>> 0;
  }
  for (let i = 0; i < cells.length; i++) pixels[i] = shades[cells[i] & 255];
  const canvas = new OffscreenCanvas(map.columns, map.rows);
  canvas.getContext("2d").putImageData(image, 0, 0);
  return canvas;
}
