// The path of a program or of rows: rapids thin and dashed, cuts, and what is done, in each view.

const numbers_per_place = 4, full = 65535, full_share = 32767;

export class PathPainter {
  done = 0;  // share of the lines
  #canvas;
  #numbers = null;
  #bounds = null;

  constructor(canvas) { this.#canvas = canvas; }

  // Numbers as path.open sends them, or null for none.
  show(numbers, bounds) {
    this.#numbers = numbers;
    this.#bounds = bounds;
    this.done = 0;
  }

  draw(views, panes, ratio, colour, share) {
    const [width, height] = [Math.round(views.width * ratio), Math.round(views.height * ratio)];
    if (this.#canvas.width !== width) this.#canvas.width = width;
    if (this.#canvas.height !== height) this.#canvas.height = height;
    const context = this.#canvas.getContext('2d');
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, views.width, views.height);
    if (!this.#numbers) return;
    const styles = [
      { path: new Path2D(), stroke: colour('--weak'), dash: [4, 3], width: 0.8 },
      { path: new Path2D(), stroke: colour('--point'), dash: [], width: 1.2 },
      { path: new Path2D(), stroke: colour('--done'), dash: [], width: 1.8 }];
    for (const pane of panes) this.#add(styles, views, pane, Math.max(1, Math.round(1 / share)));
    for (const { path, stroke, dash, width: line_width } of styles) {
      context.strokeStyle = stroke;
      context.lineWidth = line_width;
      context.setLineDash(dash);
      context.stroke(path);
    }
  }

  // Every n-th place of a path, while the view moves and frames are late. Pieces outside of the
  // pane are left out, others end at its edge.
  #add([rapids, cuts, travelled], views, pane, stride) {
    const numbers = this.#numbers, [low, high] = this.#bounds, last = numbers.length / numbers_per_place - 1;
    const place = (i) => {
      const at = low.map((value, axis) => value + (high[axis] - value) * numbers[i * numbers_per_place + axis] / full);
      return views.to_canvas(pane, at);
    };
    const done = this.done * full_share;
    let from = place(0);
    for (let i = 0; i < last;) {
      i = Math.min(i + stride, last);
      const to = place(i), order = numbers[i * numbers_per_place + 3];
      const piece = clipped(from, to, pane);
      if (piece) {
        const { path } = done > 0 && order >> 1 <= done ? travelled : order & 1 ? rapids : cuts;
        path.moveTo(piece[0].x, piece[0].y);
        path.lineTo(piece[1].x, piece[1].y);
      }
      from = to;
    }
  }
}

// The part of a straight line inside of a rectangle, or null (Liang and Barsky, 1984).
function clipped(from, to, { x, y, width, height }) {
  const [dx, dy] = [to.x - from.x, to.y - from.y];
  let [begin, end] = [0, 1];
  for (const [step, space] of [[-dx, from.x - x], [dx, x + width - from.x], [-dy, from.y - y], [dy, y + height - from.y]]) {
    if (step === 0 && space < 0) return null;
    if (step < 0) begin = Math.max(begin, space / step);
    if (step > 0) end = Math.min(end, space / step);
  }
  if (begin > end) return null;
  const at = (t) => ({ x: from.x + t * dx, y: from.y + t * dy });
  return [at(begin), at(end)];
}
