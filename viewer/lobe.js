// SPDX-License-Identifier: GPL-3.0-or-later
// Lobes in 3D by WebGL2: the distance from the point is the value toward each viewer, over the hemisphere of the light.
import { cross, degrees, dot, plus, radians, spherical, times, unit } from "./directions.js";
import { card, colour, h } from "./dom.js";
import { scale } from "./curves.js";
import { light, value } from "./state.js";

const RINGS = 60, SPOKES = 48; // closer toward the mirror direction, where lobes are narrow
const VERTEX = `#version 300 es
in vec3 place; in vec3 normal;
uniform mat3 view; uniform vec3 frame; // scale in x and y, and how far the centre lies down
out vec3 facing;
void main() {
  vec3 p = view * place;
  facing = view * normal;
  gl_Position = vec4(p.x * frame.x, p.y * frame.y - frame.z, -p.z * 0.25, 1.0);
}`;
const FRAGMENT = `#version 300 es
precision mediump float;
in vec3 facing; uniform vec4 tint; uniform float shade; out vec4 pixel;
void main() {
  vec3 n = normalize(facing);
  n = n.z < 0.0 ? -n : n;
  float light = mix(1.0, 0.55 + 0.5 * max(dot(n, vec3(-0.45, 0.6, 0.66)), 0.0), shade);
  float edge = 1.0 - (1.0 - tint.a) * n.z * shade; // seen from the side, a thin shell is denser
  float alpha = shade > 0.0 ? edge : tint.a;
  pixel = vec4(tint.rgb * light * alpha, alpha);
}`;

/** Directions of a lobe's mesh: polar about the mirror direction, each spoke to the horizon. */
function mesh(wi) {
  const R = [-wi[0], -wi[1], wi[2]], e1 = unit(Math.abs(R[2]) < 0.999 ? cross([0, 0, 1], R) : [1, 0, 0]), e2 = cross(R, e1);
  const directions = [];
  for (let i = 0; i < RINGS; i++) {
    for (let j = 0; j < SPOKES; j++) {
      const beta = (2 * Math.PI * j) / SPOKES;
      const t = plus(times(e1, Math.cos(beta)), times(e2, Math.sin(beta)));
      const end = Math.atan2(R[2], -t[2]); // where cos a R_z + sin a t_z is 0
      const a = (i / (RINGS - 1)) ** 2 * end * (1 - 1e-7);
      directions.push(plus(times(R, Math.cos(a)), times(t, Math.sin(a))));
    }
  }
  return directions;
}

const TRIANGLES = (() => {
  const found = [];
  for (let i = 0; i + 1 < RINGS; i++) {
    for (let j = 0; j < SPOKES; j++) {
      const a = i * SPOKES + j, b = i * SPOKES + ((j + 1) % SPOKES);
      found.push(a, b, a + SPOKES, b, b + SPOKES, a + SPOKES);
    }
  }
  return new Uint16Array(found);
})();

function normals(places) {
  const out = new Float32Array(places.length);
  const p = (i, j) => { const k = (Math.min(Math.max(i, 0), RINGS - 1) * SPOKES + ((j + SPOKES) % SPOKES)) * 3; return [places[k], places[k + 1], places[k + 2]]; };
  for (let i = 0; i < RINGS; i++) {
    for (let j = 0; j < SPOKES; j++) {
      const along = plus(p(i + 1, j), times(p(Math.max(i - 1, 0), i ? j : j + SPOKES / 2), -1));
      const n = cross(along, i ? plus(p(i, j + 1), times(p(i, j - 1), -1)) : plus(p(1, j + SPOKES / 4), times(p(1, j - SPOKES / 4), -1)));
      out.set(n, (i * SPOKES + j) * 3);
    }
  }
  return out;
}

export function lobePlot(title, actions) {
  const made = card(title, { wide: true, label: `${title}. Arrow keys turn it; drag the point of the light to move it.` });
  const canvas = h("canvas"), corner = h("div", { class: "corner" });
  const marks = ["n", "light", "mirror"].map((text) => h("span", { class: "mark" }, text));
  made.plot.append(canvas, ...marks, corner);
  const gl = canvas.getContext("webgl2", { antialias: false, premultipliedAlpha: true, preserveDrawingBuffer: true });
  if (!gl) {
    made.plot.append(h("p", { class: "note" }, "The 3D lobe needs WebGL2; the plots beside it show the same numbers."));
    return { ...made, update() {}, draw() {} };
  }
  const program = linked(gl), uniform = (name) => gl.getUniformLocation(program, name);
  const at = Object.fromEntries(["view", "frame", "tint", "shade"].map((name) => [name, uniform(name)]));
  const triangles = buffer(gl, gl.ELEMENT_ARRAY_BUFFER, TRIANGLES);
  const known = new WeakMap(), slots = [], rings = buffer(gl, gl.ARRAY_BUFFER, stage());
  const axes = gl.createBuffer();
  let shown = [], camera = [62, 22], wi = [0, 0, 1], size = [1, 1], frame = [1, 1, 0], read = null;

  const basis = () => {
    const eye = spherical(radians(90 - camera[1]), radians(camera[0]));
    const right = unit(cross([0, 0, 1], eye));
    return [right, cross(eye, right), eye];
  };
  const project = (p, [right, up]) => [
    (dot(p, right) * frame[0] + 1) * 0.5 * size[0], (1 - dot(p, up) * frame[1] + frame[2]) * 0.5 * size[1],
  ];

  /** fine: with twice the pixels, which smooths edges; what moves on a software rasteriser cannot afford them. */
  function resize(fine) {
    const box = made.plot.getBoundingClientRect(), ratio = Math.min(devicePixelRatio || 1, 2) * (fine ? 2 : 1);
    size = [Math.max(box.width, 1), Math.max(box.height, 1)];
    const [width, height] = size.map((one) => Math.round(one * ratio));
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    const zoom = Math.min(size[0] / 2.35, size[1] / 1.55) * 2;
    frame = [zoom / size[0], zoom / size[1], 0.36 * (zoom / size[1])];
  }

  /** A model's values, kept while neither it nor the light or the scale changes. */
  function valuesOf(state, model, directions) {
    const key = [...wi, state.times, state.channel].join();
    if (known.get(model)?.key !== key) known.set(model, { key, values: directions.map((wo) => value(state, model, wi, wo)) });
    return known.get(model).values;
  }

  /** New values: of each model a mesh. */
  function update(state, models) {
    wi = light(state);
    const directions = mesh(wi);
    shown = models.map(({ name, colour: tint, model }) => {
      const values = valuesOf(state, model, directions);
      return { name, tint, model, values, peak: values.reduce((a, b) => Math.max(a, b), 0), directions };
    });
    const common = shown.reduce((a, { peak }) => Math.max(a, peak), 0);
    shown.forEach((one, k) => {
      const { place } = scale(state.own ? one.peak : common, state.log), places = new Float32Array(one.values.length * 3);
      one.values.forEach((v, i) => places.set(times(directions[i], place(v)), i * 3));
      one.places = places;
      slots[k] ??= { place: gl.createBuffer(), normal: gl.createBuffer() };
      one.slot = slots[k];
      one.extent = place(one.peak);
      one.volume = places.reduce((sum, c) => sum + Math.abs(c), 0);
      upload(gl, one.slot.place, places);
      upload(gl, one.slot.normal, normals(places));
    });
    read = { common, state };
    camera = state.camera;
  }

  function draw(state, fine) {
    camera = state.camera;
    resize(fine);
    const views = basis();
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.useProgram(program);
    const columns = [0, 1, 2].flatMap((axis) => views.map((v) => v[axis]));
    gl.uniformMatrix3fv(at.view, false, columns);
    gl.uniform3fv(at.frame, frame);
    // What lies flat first, then small lobes before large ones, so that those inside stay visible.
    lines(rings, gl.LINES, stage().length / 3, "--line", 1);
    upload(gl, axes, new Float32Array([0, 0, 0, 0, 0, 1.12, ...dashes([-wi[0], -wi[1], wi[2]])]));
    lines(axes, gl.LINES, 2 + 24, "--soft", 0.9);
    upload(gl, axes, new Float32Array([...times(wi, 1.12), 0, 0, 0]));
    lines(axes, gl.LINES, 2, "--ink", 1);
    const alpha = shown.length > 1 ? 0.62 : 0.82;
    for (const one of [...shown].sort((a, b) => a.volume - b.volume)) {
      attribute("place", one.slot.place);
      attribute("normal", one.slot.normal);
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, triangles);
      gl.uniform4f(at.tint, ...rgb(one.tint), alpha);
      gl.uniform1f(at.shade, 1);
      gl.enable(gl.CULL_FACE);
      for (const hidden of [gl.FRONT, gl.BACK]) { // the far side of the shell, then the near one
        gl.cullFace(hidden);
        gl.drawElements(gl.TRIANGLES, TRIANGLES.length, gl.UNSIGNED_SHORT, 0);
      }
      gl.disable(gl.CULL_FACE);
    }
    place(marks[0], [0, 0, 1.2], views);
    place(marks[1], times(wi, 1.22), views);
    place(marks[2], times([-wi[0], -wi[1], wi[2]], 1.16), views);
    marks[2].hidden = state.thetaI < 8;
    marks[0].hidden = state.thetaI < 8;
  }

  const place = (mark, p, views) => { const [x, y] = project(p, views); mark.style.left = `${x}px`; mark.style.top = `${y}px`; };
  function attribute(name, from) {
    const location = gl.getAttribLocation(program, name);
    gl.bindBuffer(gl.ARRAY_BUFFER, from);
    gl.enableVertexAttribArray(location);
    gl.vertexAttribPointer(location, 3, gl.FLOAT, false, 0, 0);
  }
  function lines(from, mode, count, name, alpha) {
    attribute("place", from);
    gl.disableVertexAttribArray(gl.getAttribLocation(program, "normal"));
    gl.vertexAttrib3f(gl.getAttribLocation(program, "normal"), 0, 0, 1);
    gl.uniform4f(at.tint, ...rgb(colour(name)), alpha);
    gl.uniform1f(at.shade, 0);
    gl.drawArrays(mode, 0, count);
  }

  /** The vertex in front under the pointer. */
  function pick(x, y) {
    const views = basis(), eye = views[2];
    let best = null;
    for (const one of shown) {
      one.directions.forEach((direction, k) => {
        const p = [one.places[3 * k], one.places[3 * k + 1], one.places[3 * k + 2]], [px, py] = project(p, views);
        const off = Math.hypot(px - x, py - y);
        if (off < 9 && (!best || dot(p, eye) > best.depth)) best = { depth: dot(p, eye), one, direction, k };
      });
    }
    return best;
  }

  const local = (event) => { const box = made.plot.getBoundingClientRect(); return [event.clientX - box.left, event.clientY - box.top]; };
  let drag = null;
  made.plot.addEventListener("pointerdown", (event) => {
    const [x, y] = local(event), [lx, ly] = project(times(wi, 1.12), basis());
    drag = { x, y, light: Math.hypot(lx - x, ly - y) < 22, camera: [...camera] };
    made.plot.setPointerCapture(event.pointerId);
  });
  made.plot.addEventListener("pointermove", (event) => {
    const [x, y] = local(event);
    if (!drag) return hover(pick(x, y));
    if (!drag.light) return actions.turn([drag.camera[0] - (x - drag.x) * 0.5, drag.camera[1] + (y - drag.y) * 0.5]);
    const views = basis();
    const px = ((x / size[0]) * 2 - 1) / frame[0] / 1.12, py = (1 - (y / size[1]) * 2 + frame[2]) / frame[1] / 1.12;
    const depth = Math.sqrt(Math.max(1 - px * px - py * py, 0));
    const [near, far] = [depth, -depth].map((d) => plus(plus(times(views[0], px), times(views[1], py)), times(views[2], d)));
    const w = unit(dot(near, wi) >= dot(far, wi) ? near : far);
    return actions.light(Math.min(degrees(Math.acos(Math.max(w[2], 0))), 89), degrees(Math.atan2(w[1], w[0])));
  });
  const end = () => { drag = null; };
  made.plot.addEventListener("pointerup", end);
  made.plot.addEventListener("pointercancel", end);
  made.plot.addEventListener("pointerleave", () => hover(null));
  made.plot.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: [5, 0], ArrowRight: [-5, 0], ArrowUp: [0, 5], ArrowDown: [0, -5] }[event.key];
    if (!step) return;
    event.preventDefault();
    actions.turn([camera[0] + step[0], camera[1] + step[1]]);
  });

  function hover(found) {
    made.read.replaceChildren();
    if (!found) return;
    const w = found.direction, rgbValue = found.one.model.evaluate(wi, w);
    actions.read(made.read, found.one, w, rgbValue, found.one.values[found.k]);
  }

  return { ...made, corner, update, draw, peak: () => read?.common ?? 0 };
}

/** Lines of the ground: rings of 30, 60 and 90 degrees, and a cross. */
function stage() {
  const out = [];
  for (const r of [0.5, Math.sin(Math.PI / 3), 1]) {
    for (let k = 0; k < 72; k++) {
      for (const step of [k, k + 1]) out.push(r * Math.cos((step * Math.PI) / 36), r * Math.sin((step * Math.PI) / 36), 0);
    }
  }
  out.push(-1, 0, 0, 1, 0, 0, 0, -1, 0, 0, 1, 0);
  return new Float32Array(out);
}

const dashes = (w) => Array.from({ length: 24 }, (_, k) => times(w, (k / 24) * 1.06)).flat();
const rgb = (hex) => [1, 3, 5].map((k) => parseInt(hex.slice(k, k + 2), 16) / 255);

function buffer(gl, target, data) {
  const made = gl.createBuffer();
  gl.bindBuffer(target, made);
  gl.bufferData(target, data, gl.STATIC_DRAW);
  return made;
}

function upload(gl, to, data) {
  gl.bindBuffer(gl.ARRAY_BUFFER, to);
  gl.bufferData(gl.ARRAY_BUFFER, data, gl.DYNAMIC_DRAW);
}

function linked(gl) {
  const program = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  return program;
}
