// The cloud in space, drawn by WebGL 2: on demand, from one buffer that is filled once.
//
// Turntable camera: yaw about z, tilt, zoom, pan. While the picture moves and frames are late, only
// every n-th point is drawn (another stride over the same buffer); a still picture has all points.

const point_shader = `#version 300 es
in vec3 place;
in vec2 tags;  // beats, fate
uniform mat4 camera;
uniform vec3 size;
uniform float dot_px, first, step_points, before_points, last_point;
uniform int mode;
uniform sampler2D colours;
uniform vec3 not_reached_colour, before_colour;
out vec3 colour;
out float nearness;
void main() {
  gl_Position = camera * vec4((place - 0.5) * size, 1.0);
  float at = mode == 0 ? (float(gl_VertexID) * step_points - before_points) / max(last_point - before_points, 1.0)
                       : mode == 1 ? tags.x : sign(tags.y);
  bool before = tags.y > 2.5 / 255.0, not_reached = tags.y > 1.5 / 255.0 && !before;
  bool missed = tags.y > 0.0 && !not_reached && !before;
  colour = before ? before_colour : not_reached ? not_reached_colour
                       : texture(colours, vec2(at * (255.0 / 256.0) + 0.5 / 256.0, 0.5)).rgb;
  bool stands_out = (mode == 2 && missed) || (mode == 1 && tags.x > 1.5 / 255.0);
  nearness = clamp(0.5 - 0.5 * gl_Position.z / gl_Position.w, 0.0, 1.0);
  // Missed points are visible through the cloud.
  if (mode == 2 && missed) gl_Position.z = -0.99 * gl_Position.w;
  gl_PointSize = max(dot_px / gl_Position.w * (stands_out ? 2.0 : 1.0), stands_out ? 3.0 * first : first);
}`;
const point_paint = `#version 300 es
precision mediump float;
in vec3 colour;
in float nearness;
uniform vec3 far_colour;
uniform float round_dots;
out vec4 paint;
void main() {
  vec2 from_middle = 2.0 * gl_PointCoord - 1.0;
  float r = dot(from_middle, from_middle);
  if (round_dots > 0.5 && r > 1.0) discard;
  float shade = round_dots > 0.5 ? 1.0 - 0.35 * r : 1.0;
  paint = vec4(mix(far_colour, colour * shade, 0.45 + 0.55 * smoothstep(0.0, 0.75, nearness)), 1.0);
}`;
const line_shader = `#version 300 es
in vec3 place;
uniform mat4 camera;
void main() { gl_Position = camera * vec4(place, 1.0); }`;
const line_paint = `#version 300 es
precision mediump float;
uniform vec3 edge_colour;
out vec4 paint;
void main() { paint = vec4(edge_colour, 1.0); }`;

function make_program(gl, vertex, fragment) {
  const program = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  return program;
}

// Locations of uniforms by name.
function uniforms_of(gl, program) {
  const places = {};
  const count = gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS);
  for (let i = 0; i < count; ++i) {
    const {name} = gl.getActiveUniform(program, i);
    places[name] = gl.getUniformLocation(program, name);
  }
  return places;
}

// With more points than this, edges need not be smooth.
const max_smooth = 300000;
const tan_half_view = Math.tan((30 / 2) * (Math.PI / 180));

class Camera {
  constructor(radius) {
    this.radius = radius;
    this.matrix = new Float32Array(16);
    this.reset();
  }
  reset() {
    this.yaw = -0.6;
    this.tilt = 0.42;
    this.zoom = 1;
    this.pan_x = this.pan_y = 0;
  }
  turn(yaw, tilt) {
    this.yaw += yaw;
    this.tilt = Math.min(Math.max(this.tilt + tilt, -Math.PI / 2), Math.PI / 2);
  }
  zoom_by(factor) {
    this.zoom = Math.min(Math.max(this.zoom * factor, 0.3), 400);
  }
  get distance() {
    return (1.06 * this.radius) / Math.sin(Math.atan(tan_half_view));
  }
  // Millimetres of a pixel at the middle of the cloud.
  mm_per_px(height, width) {
    return (2 * tan_half_view * this.distance) / (this.zoom * Math.min(height, width));
  }
  update(width, height) {
    const {matrix: m, radius, distance: d, zoom, yaw, tilt} = this;
    const focus = zoom / tan_half_view;
    const fx = focus * Math.min(1, height / width), fy = focus * Math.min(1, width / height);
    const near = d - 1.2 * radius, far = d + 1.2 * radius;
    const depth = (far + near) / (far - near), offset = (-2 * far * near) / (far - near);
    const [c, s, e, f] = [Math.cos(yaw), Math.sin(yaw), Math.cos(tilt), Math.sin(tilt)];
    // Rows of the rotation: right, up, towards the eye.
    const right = [c, -s, 0], up = [s * f, c * f, e], back = [-s * e, -c * e, f];
    for (let k = 0; k < 3; ++k) {
      m[4 * k] = fx * right[k];
      m[4 * k + 1] = fy * up[k];
      m[4 * k + 2] = -depth * back[k];
      m[4 * k + 3] = -back[k];
    }
    m[12] = fx * this.pan_x;
    m[13] = fy * this.pan_y;
    m[14] = depth * d + offset;
    m[15] = d;
    return m;
  }
}

class CloudView {
  // Throws without WebGL 2.
  constructor(canvas, bytes, cloud, spacing_mm) {
    this.canvas = canvas;
    this.bytes = bytes;
    this.count = bytes.length / bytes_per_point;
    this.before = cloud.before;  // points of an earlier run, the first ones
    this.shown = this.count;
    this.size = cloud.size_mm;
    this.mode = 'order';
    this.every = 1;       // stride of the points drawn during motion
    this.moving = false;
    this.waiting = false;
    this.after_draw = () => {};
    const longest = Math.max(...this.size, 1e-3);
    this.camera = new Camera(0.5 * Math.hypot(...this.size) || 0.5 * longest);
    this.dot_mm = spacing_mm > 0 ? 0.7 * spacing_mm * Math.sqrt(cloud.stride) : 0.02 * longest;
    this.gl = canvas.getContext('webgl2', {antialias: this.count < max_smooth, alpha: true, powerPreference: 'high-performance'});
    if (!this.gl) throw new Error('no WebGL 2');
    this.set_up();
    canvas.addEventListener('webglcontextlost', (event) => event.preventDefault());
    canvas.addEventListener('webglcontextrestored', () => {
      this.set_up();
      this.set_colours(this.mode, this.theme);
    });
    new ResizeObserver(() => this.draw_soon()).observe(canvas);
  }

  set_up() {
    const gl = this.gl;
    this.points = make_program(gl, point_shader, point_paint);
    this.point_places = uniforms_of(gl, this.points);
    this.lines = make_program(gl, line_shader, line_paint);
    this.line_places = uniforms_of(gl, this.lines);
    this.buffer = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer);
    gl.bufferData(gl.ARRAY_BUFFER, this.bytes, gl.STATIC_DRAW);
    this.box = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, this.box);
    gl.bufferData(gl.ARRAY_BUFFER, this.box_edges(), gl.STATIC_DRAW);
    this.texture = gl.createTexture();
    gl.enable(gl.DEPTH_TEST);
  }

  // Twelve edges round the cloud.
  box_edges() {
    const ends = [];
    for (let axis = 0; axis < 3; ++axis)
      for (let k = 0; k < 4; ++k)
        for (const side of [-0.5, 0.5]) {
          const at = [0, 0, 0];
          at[axis] = side * this.size[axis];
          at[(axis + 1) % 3] = (k & 1 ? 0.5 : -0.5) * this.size[(axis + 1) % 3];
          at[(axis + 2) % 3] = (k & 2 ? 0.5 : -0.5) * this.size[(axis + 2) % 3];
          ends.push(...at);
        }
    return new Float32Array(ends);
  }

  set_colours(mode, theme) {
    const gl = this.gl;
    this.mode = mode;
    this.theme = theme;
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, 256, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, mode_texture(mode, theme));
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
    this.draw_soon();
  }

  // Draws with the next frame; `moving`: another one will follow soon.
  draw_soon(moving = false) {
    this.moving = moving;
    clearTimeout(this.rest);
    // After the motion all points are drawn.
    if (moving) this.rest = setTimeout(() => this.draw_soon(), Math.max(160, 4 * (this.pace ?? 0)));
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame((time) => {
      this.waiting = false;
      this.keep_pace(time);
      this.draw();
      this.after_draw();
    });
  }

  // Fewer points if frames are late, more if there is time.
  keep_pace(time) {
    const took = Math.min(time - this.drawn_at, 2000);
    this.drawn_at = time;
    const both = this.moving && this.moved;
    this.moved = this.moving;
    if (!both) return;
    this.pace = this.pace === undefined ? took : 0.7 * this.pace + 0.3 * took;
    if (this.pace > 45 && this.every < 16 && this.count / this.every > 20000) {
      this.every *= 2;
      this.pace = 25;
    } else if (this.pace < 18 && this.every > 1) {
      this.every /= 2;
      this.pace = 25;
    }
  }

  resize() {
    const scale = Math.min(window.devicePixelRatio || 1, 2);
    const width = Math.max(1, Math.round(this.canvas.clientWidth * scale));
    const height = Math.max(1, Math.round(this.canvas.clientHeight * scale));
    if (this.canvas.width !== width) this.canvas.width = width;
    if (this.canvas.height !== height) this.canvas.height = height;
    this.scale = scale;
  }

  draw() {
    this.resize();
    const gl = this.gl, {width, height} = this.canvas;
    const camera = this.camera.update(width, height);
    const style = getComputedStyle(this.canvas);
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.useProgram(this.lines);
    gl.uniformMatrix4fv(this.line_places.camera, false, camera);
    gl.uniform3fv(this.line_places.edge_colour, rgb_of(style.getPropertyValue('--edge').trim()).map((c) => c / 255));
    gl.bindBuffer(gl.ARRAY_BUFFER, this.box);
    const place = gl.getAttribLocation(this.lines, 'place');
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, 3, gl.FLOAT, false, 0, 0);
    gl.drawArrays(gl.LINES, 0, 24);
    this.draw_points(camera, style);
  }

  draw_points(camera, style) {
    const gl = this.gl, at = this.point_places;
    const every = this.moving ? this.every : 1;
    const dot_px = (this.dot_mm * Math.cbrt(every)) / this.camera.mm_per_px(this.canvas.height, this.canvas.width);
    gl.useProgram(this.points);
    gl.uniformMatrix4fv(at.camera, false, camera);
    gl.uniform3fv(at.size, this.size);
    gl.uniform1f(at.dot_px, Math.min(dot_px, 40 * this.scale) * this.camera.distance);
    gl.uniform1f(at.first, 1.1 * this.scale);
    gl.uniform1f(at.round_dots, dot_px > 2.5 ? 1 : 0);
    gl.uniform1f(at.step_points, every);
    gl.uniform1f(at.last_point, this.count - 1);
    gl.uniform1f(at.before_points, this.before);
    gl.uniform1i(at.mode, {order: 0, beats: 1, missed: 2}[this.mode]);
    gl.uniform3fv(at.before_colour, rgb_of(before_colours[this.theme ?? 'light']).map((c) => c / 255));
    gl.uniform3fv(at.not_reached_colour, rgb_of(not_reached_colours[this.theme ?? 'light']).map((c) => c / 255));
    gl.uniform3fv(at.far_colour, rgb_of(style.getPropertyValue('--stage-2').trim()).map((c) => c / 255));
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer);
    const place = gl.getAttribLocation(this.points, 'place'), tags = gl.getAttribLocation(this.points, 'tags');
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, 3, gl.UNSIGNED_SHORT, true, bytes_per_point * every, 0);
    gl.enableVertexAttribArray(tags);
    gl.vertexAttribPointer(tags, 2, gl.UNSIGNED_BYTE, true, bytes_per_point * every, 6);
    gl.drawArrays(gl.POINTS, 0, Math.ceil(this.shown / every));
    gl.disableVertexAttribArray(tags);
  }

  // Position on the canvas, in CSS pixels, of a place of the box, from -0.5 to 0.5 on each axis.
  project(x, y, z) {
    const m = this.camera.matrix;
    const [a, b, c] = [x * this.size[0], y * this.size[1], z * this.size[2]];
    const w = m[3] * a + m[7] * b + m[11] * c + m[15];
    return {
      x: (0.5 + (0.5 * (m[0] * a + m[4] * b + m[12])) / w) * this.canvas.clientWidth,
      y: (0.5 - (0.5 * (m[1] * a + m[5] * b + m[9] * c + m[13])) / w) * this.canvas.clientHeight,
      w,
    };
  }

  // Index of the nearest point under a position on the canvas, or -1.
  pick(x, y) {
    const m = this.camera.matrix, {clientWidth: width, clientHeight: height} = this.canvas;
    const places = new Uint16Array(this.bytes.buffer, this.bytes.byteOffset, this.shown * 4);
    const k = this.size.map((side) => side / 65535);
    const half = this.size.map((side) => side / 2);
    const wanted_x = (2 * x) / width - 1, wanted_y = 1 - (2 * y) / height;
    const reach = 7;  // px
    const rx = (2 * reach) / width, ry = (2 * reach) / height;
    let found = -1, best = Infinity;
    for (let i = 0; i < this.shown; ++i) {
      const a = places[4 * i] * k[0] - half[0], b = places[4 * i + 1] * k[1] - half[1];
      const c = places[4 * i + 2] * k[2] - half[2];
      const w = m[3] * a + m[7] * b + m[11] * c + m[15];
      const dx = ((m[0] * a + m[4] * b + m[12]) / w - wanted_x) / rx;
      if (dx > 1 || dx < -1) continue;
      const dy = ((m[1] * a + m[5] * b + m[9] * c + m[13]) / w - wanted_y) / ry;
      const off = dx * dx + dy * dy;
      if (off > 1) continue;
      // Depth has the same weight as the distance from the pointer.
      const rank = off + (4 * (w - this.camera.distance)) / this.camera.radius;
      if (rank < best) best = rank, found = i;
    }
    return found;
  }

  // Milliseconds for a picture with all points, including the graphics card's work.
  time_of_frame() {
    const gl = this.gl, pixel = new Uint8Array(4), start = performance.now();
    this.moving = false;
    this.draw();
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    return performance.now() - start;
  }
}
