// Points by WebGL 2, or by the processor where there is none. Both draw the same: dots of one
// colour, of another one up to the progress of the job.
//
// Points are as cloud.points sends them: four 16-bit numbers, x, y and z in the bounds, and the
// place in the order. `parts` are ranges of them: { first, count, bounds, map }; the map is
// [x, y, z, offset], the images of the unit vectors and of the origin.

import { add, dot } from '/views.js';

const numbers_per_point = 4, full = 65535;
export const no_map = [[1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 0]];

const vertex_text = `#version 300 es
in vec4 point;  // place in the bounds, and in the order
uniform vec3 low, size, right, up, back, centre, px, py, pz, offset;
uniform vec2 scale;
uniform float depth, dot_px, done, radius;
uniform vec3 colour, done_colour, far_colour;
out vec3 paint;
void main() {
  vec3 own = low + point.xyz * size;
  vec3 from = own.x * px + own.y * py + own.z * pz + offset - centre;
  gl_Position = vec4(dot(from, right) * scale.x, dot(from, up) * scale.y, -dot(from, back) * depth, 1.0);
  gl_PointSize = dot_px;
  float nearness = smoothstep(-1.0, 1.0, dot(from, back) / radius);
  paint = mix(far_colour, point.w < done ? done_colour : colour, 0.35 + 0.65 * nearness);
}`;
const fragment_text = `#version 300 es
precision mediump float;
in vec3 paint;
out vec4 result;
void main() { result = vec4(paint, 1.0); }`;

function rgb_of(text) {
  const digits = text.length === 4 ? [...text.slice(1)].map((c) => c + c).join('') : text.slice(1);
  return [0, 2, 4].map((i) => parseInt(digits.slice(i, i + 2), 16));
}

// What both painters know.
class Points {
  parts = [];
  done = 0;  // share of the order
  count = 0;

  // Begins with no points; `side`: mm, of the whole.
  begin(parts, side) {
    this.parts = parts;
    this.side = Math.max(side, 1e-3);
    this.numbers = new Uint16Array(parts.reduce((sum, { count }) => sum + count, 0) * numbers_per_point);
    this.count = 0;
    this.done = 0;
  }
  put(from, numbers) {
    this.numbers.set(numbers, from * numbers_per_point);
    this.count = from + numbers.length / numbers_per_point;
  }
  // Parts as far as their points have come, with what maps the numbers of a point to its place.
  present() {
    const shown = (count) => Math.ceil(count * this.share);  // any first part is an even sample
    return this.parts.map(({ first, count, bounds: [low, high], map }) => ({
      first, count: Math.min(shown(count), this.count - first), low, map, size: high.map((value, i) => value - low[i]),
    })).filter(({ count }) => count > 0);
  }
  // Side of a dot, so that dots touch where points are dense, within reason.
  dot_px(views, ratio) {
    return Math.min(Math.max(1.6 * this.side * views.scale / Math.sqrt(Math.max(this.count, 1)), 1.3), 5) * ratio;
  }
}

class GlPainter extends Points {
  constructor(canvas, gl) {
    super();
    this.canvas = canvas;
    this.gl = gl;
    this.#set_up();
    canvas.addEventListener('webglcontextlost', (event) => event.preventDefault());
    canvas.addEventListener('webglcontextrestored', () => {
      this.#set_up();
      if (this.numbers) this.#fill(this.numbers);
    });
  }

  #set_up() {
    const gl = this.gl;
    this.program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex_text], [gl.FRAGMENT_SHADER, fragment_text]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(this.program, shader);
    }
    gl.linkProgram(this.program);
    if (!gl.getProgramParameter(this.program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(this.program));
    this.at = new Proxy({}, { get: (known, name) => known[name] ??= gl.getUniformLocation(this.program, name) });
    this.buffer = gl.createBuffer();
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.SCISSOR_TEST);
    // Drivers compile the shaders at the first draw call, so one point is drawn before the others arrive.
    gl.useProgram(this.program);
    this.#fill(new Uint16Array(numbers_per_point));
    this.#use_buffer();
    gl.drawArrays(gl.POINTS, 0, 1);
  }

  #use_buffer() {
    const { gl } = this, point = gl.getAttribLocation(this.program, 'point');
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer);
    gl.enableVertexAttribArray(point);
    gl.vertexAttribPointer(point, numbers_per_point, gl.UNSIGNED_SHORT, true, 0, 0);
  }

  // `content`: numbers, or the number of bytes without them.
  #fill(content) {
    this.gl.bindBuffer(this.gl.ARRAY_BUFFER, this.buffer);
    this.gl.bufferData(this.gl.ARRAY_BUFFER, content, this.gl.STATIC_DRAW);
  }

  begin(parts, side) {
    super.begin(parts, side);
    this.#fill(this.numbers.byteLength);
  }

  put(from, numbers) {
    super.put(from, numbers);
    this.gl.bindBuffer(this.gl.ARRAY_BUFFER, this.buffer);
    this.gl.bufferSubData(this.gl.ARRAY_BUFFER, from * numbers_per_point * 2, numbers);
  }

  draw(views, panes, ratio, colour, share) {
    this.share = share;
    const { gl, canvas, at } = this;
    const [width, height] = [Math.round(views.width * ratio), Math.round(views.height * ratio)];
    if (canvas.width !== width) canvas.width = width;
    if (canvas.height !== height) canvas.height = height;
    gl.useProgram(this.program);
    gl.uniform3fv(at.centre, views.centre);
    gl.uniform1f(at.dot_px, this.dot_px(views, ratio));
    gl.uniform1f(at.done, this.done);
    gl.uniform1f(at.radius, 0.8 * this.side);
    gl.uniform3fv(at.far_colour, rgb_of(colour('--card')).map((value) => value / 255));
    gl.uniform3fv(at.colour, rgb_of(colour('--point')).map((value) => value / 255));
    gl.uniform3fv(at.done_colour, rgb_of(colour('--done')).map((value) => value / 255));
    this.#use_buffer();
    for (const pane of panes) this.#draw_pane(views, pane, ratio, height);
  }

  #draw_pane(views, pane, ratio, canvas_height) {
    const { gl, at } = this;
    const [x, y, width, height] = [pane.x, pane.y, pane.width, pane.height].map((value) => Math.round(value * ratio));
    gl.viewport(x, canvas_height - y - height, width, height);
    gl.scissor(x, canvas_height - y - height, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.uniform2f(at.scale, 2 * views.scale / pane.width, 2 * views.scale / pane.height);
    gl.uniform1f(at.depth, 1e-4);  // 10 m in front of the centre and beyond it
    for (const name of ['right', 'up', 'back']) gl.uniform3fv(at[name], pane[name]);
    for (const { first, count, map, low, size } of this.present()) {
      gl.uniform3fv(at.low, low);
      gl.uniform3fv(at.size, size);
      ['px', 'py', 'pz', 'offset'].forEach((name, i) => gl.uniform3fv(at[name], map[i]));
      gl.drawArrays(gl.POINTS, first, count);
    }
  }
}

class CanvasPainter extends Points {
  constructor(canvas) {
    super();
    this.canvas = canvas;
    this.context = canvas.getContext('2d');
  }

  draw(views, panes, ratio, colour, share) {
    this.share = share;
    const [width, height] = [Math.round(views.width * ratio), Math.round(views.height * ratio)];
    if (this.canvas.width !== width) this.canvas.width = width;
    if (this.canvas.height !== height) this.canvas.height = height;
    const paints = ['--point', '--done'].map((name) => {
      const [r, g, b] = rgb_of(colour(name));
      return (255 << 24 | b << 16 | g << 8 | r) >>> 0;
    });
    for (const pane of panes) this.#draw_pane(views, pane, ratio, paints);
  }

  #draw_pane(views, pane, ratio, [paint, done_paint]) {
    const [x, y, width, height] = [pane.x, pane.y, pane.width, pane.height].map((value) => Math.round(value * ratio));
    if (width < 1 || height < 1) return;
    const image = this.context.createImageData(width, height), pixels = new Uint32Array(image.data.buffer);
    const scale = views.scale * ratio, side = Math.max(1, Math.round(this.dot_px(views, ratio)));
    const done = this.done * full;
    for (const { first, count, map, low, size } of this.present()) {
      // The position on the image is linear in the three numbers of a point.
      const start = add([0, 1, 2].reduce((sum, i) => add(sum, map[i], low[i]), map[3]), views.centre, -1);
      const way = (direction, sign) => [0, 1, 2].map((i) => sign * scale * dot(map[i], direction) * size[i] / full);
      const [ax, ay, az] = way(pane.right, 1), [bx, by, bz] = way(pane.up, -1);
      const a0 = width / 2 + scale * dot(start, pane.right), b0 = height / 2 - scale * dot(start, pane.up);
      for (let i = first * numbers_per_point; i < (first + count) * numbers_per_point; i += numbers_per_point) {
        const [u, v, w] = [this.numbers[i], this.numbers[i + 1], this.numbers[i + 2]];
        const column = a0 + ax * u + ay * v + az * w | 0, row = b0 + bx * u + by * v + bz * w | 0;
        if (column < 0 || row < 0 || column > width - side || row > height - side) continue;
        const value = this.numbers[i + 3] < done ? done_paint : paint;
        for (let k = 0; k < side; ++k) pixels.fill(value, (row + k) * width + column, (row + k) * width + column + side);
      }
    }
    this.context.putImageData(image, x, y);
  }
}

// A canvas can have one kind of context for ever: WebGL is tried first, but not one that the
// processor computes, which is slower than the other painter.
export function make_painter(canvas) {
  const gl = canvas.getContext('webgl2', { antialias: false, alpha: true, failIfMajorPerformanceCaveat: true });
  return gl ? new GlPainter(canvas, gl) : new CanvasPainter(canvas);
}
export const uses_webgl = (painter) => painter instanceof GlPainter;
