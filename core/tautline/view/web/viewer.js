"use strict";
// What a reader sees: camera, words in space, time, legend, notes.
// Words out of a scene enter the page as text only, never as markup.

const $ = (id) => document.getElementById(id);
const page = JSON.parse($("scene").textContent);
const frames = page.time.length;
const state = { frame: 0, playing: false, speed: 1, clock: 0, quantity: null, pinned: null, hovered: null, moved: false, dirty: true };

function made(tag, parent, text = "", kind = "") {
  const element = document.createElement(tag);
  element.textContent = text;
  if (kind) element.className = kind;
  parent.appendChild(element);
  return element;
}

/** A number with so many digits that the range of its legend is told apart, as people write it. */
function tidy(value, span) {
  const digits = Math.min(Math.max(Math.ceil(3 - Math.log10(span || 1)), 0), 12);
  const text = Math.abs(value) < 1e-4 * span ? "0" : value.toFixed(digits);
  return text.replace("-", "−");
}

// ---------------------------------------------------------------- what is seen

let renderer = null;
try {
  renderer = new THREE.WebGLRenderer({ canvas: $("space"), antialias: true, alpha: true });
} catch (error) {
  made("p", document.body, "This browser shows no 3-D here: WebGL 2 is missing or switched off.", "broken");
  throw error;
}
const bytes = inflated($("data").textContent);
$("data").remove();
const scene = new THREE.Scene();
const camera = new THREE.PerspectiveCamera(page.angle, 1, 0.01, 1000);
camera.up.set(0, 0, 1);
scene.add(camera, new THREE.HemisphereLight(0xffffff, 0xa8aeb4, 2.2));
const lamp = new THREE.DirectionalLight(0xffffff, 1.6);
lamp.position.set(-0.5, 0.9, 1.2);
camera.add(lamp);

// The middle of the picture is the origin; levels know their height above it.
const tubes = page.lines.map((spec) => new Tube(spec, bytes, page.factor));
const bodies = page.solids.map((spec) => new Body(spec, bytes));
const vectors = page.arrows.map((spec) => new Vectors(spec, bytes, page.size));
for (const part of [...tubes, ...bodies, ...vectors]) scene.add(part.mesh);
for (const spec of page.levels) scene.add(level(spec, page.size, [0, 0]));
for (const spec of page.rulers) {
  const pairs = spec.points.slice(1).flatMap((point, k) => [...spec.points[k], ...point]);
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(pairs), 3));
  scene.add(new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ color: 0x202020 })));
}
const tables = new Map(page.quantities.map((one) => [one.name, texture(one.table)]));
const controls = new THREE.OrbitControls(camera, renderer.domElement);
controls.enableDamping = true;
controls.dampingFactor = 0.2;
controls.zoomToCursor = true;
controls.addEventListener("change", () => (state.dirty = true));
controls.addEventListener("start", () => (state.moved = true));

// ---------------------------------------------------------------- camera

/** Room for the picture between what is written around it, px. */
function room() {
  const [wide, high] = [innerWidth, innerHeight];
  const foot = document.querySelector("footer").offsetHeight + 30;
  const head = $("legend").getBoundingClientRect();
  const title = document.querySelector("header").getBoundingClientRect();
  if (wide > 700) return { left: 40, right: wide - 60, top: Math.max(title.bottom, 60) + 12, bottom: high - foot };
  return { left: 20, right: wide - 44, top: Math.max(title.bottom, head.bottom) + 10, bottom: high - foot };
}

/** Put the eye where everything just fits into the room for it. */
function fit() {
  const { left, right, top, bottom } = room();
  const [wide, high] = [innerWidth, innerHeight];
  const back = new THREE.Vector3(...page.eye).normalize();
  const across = new THREE.Vector3().crossVectors(camera.up, back);
  if (across.length() < 1e-6) across.set(1, 0, 0);
  across.normalize();
  const over = new THREE.Vector3().crossVectors(back, across);
  const slope = Math.tan((page.angle * Math.PI) / 360);
  const reach = [(slope * Math.max(right - left, 80)) / high, (slope * Math.max(bottom - top, 80)) / high];
  const seen = page.outermost.map((point) => {
    const at = new THREE.Vector3(...point);
    return [[at.dot(across), at.dot(over)], at.dot(back)];
  });
  // Bisect for the least distance at which some shift brings all points between both pairs of edges.
  const shifts = (away) =>
    [0, 1].map((axis) => {
      const most = Math.min(...seen.map(([at, near]) => reach[axis] * (away - near) - at[axis]));
      const least = Math.max(...seen.map(([at, near]) => -reach[axis] * (away - near) - at[axis]));
      return [least, most];
    });
  let [near, far] = [0, 1000 * page.size];
  for (let k = 0; k < 60; k++) {
    const away = 0.5 * (near + far);
    const fits = shifts(away).every(([least, most]) => least <= most);
    [near, far] = fits ? [near, away] : [away, far];
  }
  far = Math.max(far, 0.5 * page.size);
  const [x, y] = shifts(far).map(([least, most]) => -0.5 * (least + most));
  controls.target.copy(across).multiplyScalar(x).addScaledVector(over, y);
  camera.position.copy(controls.target).addScaledVector(back, far);
  camera.setViewOffset(wide, high, 0.5 * (wide - left - right), 0.5 * (high - top - bottom), wide, high);
  controls.update();
  state.moved = false;
  state.dirty = true;
}

function resize() {
  const [wide, high] = [innerWidth, innerHeight];
  document.body.style.setProperty("--under", `${document.querySelector("header").getBoundingClientRect().bottom + 6}px`);
  renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
  renderer.setSize(wide, high, false);
  camera.aspect = wide / high;
  for (const tube of tubes) tube.material.uniforms.height.value = high;
  const { left, right, top, bottom } = room();
  camera.setViewOffset(wide, high, 0.5 * (wide - left - right), 0.5 * (high - top - bottom), wide, high);
  if (!state.moved) fit();
  if (state.pinned) plot();
  state.dirty = true;
}

/** Point of space, m, on the page, px; z over 1 is out of sight. */
function projected(point) {
  const at = point.clone().project(camera);
  return new THREE.Vector3((0.5 + 0.5 * at.x) * innerWidth, (0.5 - 0.5 * at.y) * innerHeight, at.z);
}

// ---------------------------------------------------------------- words in space

const words = [
  ...page.labels.map((spec) => {
    const track = new Track(spec.place, bytes);
    return { element: made("span", $("words"), spec.text), at: () => new THREE.Vector3(...track.read(state.frame, [0, 0, 0])), shift: [10, -8] };
  }),
  ...page.levels.map((spec) => {
    const element = made("span", $("words"), spec.name, "level");
    element.style.color = `#${new THREE.Color(spec.colour).multiplyScalar(0.35).getHexString()}`;
    const right = new THREE.Vector3();
    const at = () => {
      right.setFromMatrixColumn(camera.matrixWorld, 0).setZ(0).normalize();
      return right.multiplyScalar(-0.42 * page.size).setZ(spec.height);
    };
    return { element, at, shift: [0, -20] };
  }),
  ...page.rulers.flatMap((spec) => [
    { element: made("span", $("words"), spec.text, "ruler"), at: () => new THREE.Vector3(...spec.points[0]), shift: [10, -28], left: true },
    ...spec.points.map((point, k) => (
      { element: made("span", $("words"), spec.numbers[k], "tick"), at: () => new THREE.Vector3(...point), shift: [0, -8], left: true }
    )),
  ]),
];

/** Place words; of two that would overlap the later one is left out. */
function letter() {
  const taken = [];
  for (const word of words) {
    const at = projected(word.at());
    word.width ??= word.element.offsetWidth;
    const inside = at.x > 0 && at.x < innerWidth && at.y > 0 && at.y < innerHeight && at.z < 1;
    const start = at.x + word.shift[0] - (word.left ? word.width : 0);
    const [x, y] = [Math.min(Math.max(start, 4), innerWidth - word.width - 4), at.y + word.shift[1]];
    const clash = taken.some((box) => x < box[0] + box[2] && box[0] < x + word.width && Math.abs(y - box[1]) < 16);
    const hidden = !inside || clash;
    word.element.style.visibility = hidden ? "hidden" : "visible";
    if (hidden) continue;
    word.element.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
    taken.push([x, y, word.width]);
  }
}

/** The directions x, y and z, in a corner. */
function compass() {
  const canvas = $("compass");
  const scale = devicePixelRatio;
  [canvas.width, canvas.height] = [76 * scale, 76 * scale];
  const pen = canvas.getContext("2d");
  pen.scale(scale, scale);
  pen.font = "12px sans-serif";
  const axes = [["x", "#b3352b"], ["y", "#2c8a3e"], ["z", "#2f5fb0"]].map(([name, colour], k) => {
    const way = new THREE.Vector3().setComponent(k, 1).transformDirection(camera.matrixWorldInverse);
    return { name, colour, way };
  });
  for (const { name, colour, way } of axes.sort((a, b) => a.way.z - b.way.z)) {
    pen.strokeStyle = pen.fillStyle = colour;
    pen.lineWidth = 2;
    pen.beginPath();
    pen.moveTo(38, 38);
    pen.lineTo(38 + 26 * way.x, 38 - 26 * way.y);
    pen.stroke();
    pen.fillText(name, 35 + 33 * way.x, 42 - 33 * way.y);
  }
}

// ---------------------------------------------------------------- time

function show(frame) {
  state.frame = Math.min(Math.max(Math.round(frame), 0), frames - 1);
  for (const part of [...tubes, ...bodies, ...vectors]) part.show(state.frame);
  const span = page.time[frames - 1] - page.time[0];
  const step = frames > 1 ? span / (frames - 1) : 1;
  const digits = Math.min(Math.max(Math.ceil(-Math.log10(step || 1)), 0) + (step < 1 ? 0 : 1), 6);
  const time = (value) => value.toFixed(digits).replace("-", "−");
  $("slider").value = state.frame;
  $("clock").textContent = `t = ${time(page.time[state.frame])} s of ${time(page.time[frames - 1])} s`;
  document.body.dataset.frame = state.frame;
  if (state.pinned) plot();
  if (state.hovered) $("tip").textContent = told(state.hovered, false);
  state.dirty = true;
}

function play(on) {
  state.playing = on && frames > 1;
  if (state.playing && state.frame === frames - 1) show(0);
  state.clock = page.time[state.frame];
  $("play").textContent = state.playing ? "❚❚" : "▶";
  $("play").setAttribute("aria-label", state.playing ? "pause" : "play");
}

/** Go on by so many seconds of the reader's time; begin again after the end. */
function advance(seconds) {
  state.clock += seconds * state.speed;
  if (state.clock > page.time[frames - 1] + 0.7 * state.speed) state.clock = page.time[0];
  let frame = state.clock < page.time[state.frame] ? 0 : state.frame;
  while (frame < frames - 1 && page.time[frame + 1] <= state.clock) frame++;
  if (frame !== state.frame) show(frame);
}

/** Speeds to choose from; one that plays everything in 8 to 20 s is chosen, the true one if it does. */
function speeds() {
  const span = page.time[frames - 1] - page.time[0];
  const usual = span >= 4 && span <= 60 ? 1 : round(Math.max(span / 8, 1e-9));
  const all = new Set([0.1, 0.25, 0.5, 1, 2, 5, 0.25 * usual, 0.5 * usual, usual, 2 * usual, 5 * usual]);
  for (const speed of [...all].sort((a, b) => a - b)) {
    const option = made("option", $("speed"), speed === 1 ? "1× (real time)" : `${Number(speed.toPrecision(3))}×`);
    option.value = speed;
    option.selected = speed === usual;
  }
  state.speed = usual;
}

// ---------------------------------------------------------------- legend

function paint(name) {
  state.quantity = page.quantities.find((one) => one.name === name) ?? null;
  const shown = state.quantity;
  for (const tube of tubes) tube.paint(shown, shown && tables.get(shown.name));
  $("quantity").value = shown ? shown.name : "none";
  for (const id of ["bar", "range"]) $(id).hidden = !shown;
  if (shown) {
    const stops = Array.from({ length: 33 }, (_, k) => `#${shown.table.slice(6 * Math.min(8 * k, 255), 6 * Math.min(8 * k, 255) + 6)}`);
    $("bar").style.setProperty("--stops", stops.join(","));
    $("ticks").replaceChildren();
    for (const [value, text] of shown.ticks) {
      made("span", $("ticks"), text).style.setProperty("--at", `${(100 * (value - shown.low)) / (shown.high - shown.low)}%`);
    }
    $("range").textContent = `${shown.range[0]} to ${shown.range[1]} ${shown.unit} in all`;
  }
  show(state.frame);
}

function legend() {
  for (const one of page.quantities) made("option", $("quantity"), one.title).value = one.name;
  made("option", $("quantity"), "none").value = "none";
  $("chooser").hidden = page.quantities.length === 0;
  for (const spec of page.arrows) {
    const row = made("li", $("keys"));
    made("span", row, "", "swatch").style.setProperty("--colour", spec.colour);
    row.append(`${spec.text}: longest arrow ${spec.said}`);
  }
  if (page.levels.length) made("li", $("keys"), `grid of ${round(page.size / 5)} m`);
  $("legend").hidden = page.quantities.length + page.arrows.length + page.levels.length === 0;
}

// ---------------------------------------------------------------- what a reader must know

for (const note of page.notes) made("li", $("notes"), note);
if (page.frames > frames) {
  made("li", $("notes"), `${frames} of ${page.frames} stored frames, evenly spread`);
}
if (page.factor !== null) made("li", $("notes"), `lines drawn ${Number(page.factor.toPrecision(3))} times as thick`);
const thicker = made("li", $("notes"), "", "thicker");

/** Say by how much lines are drawn thicker than they are, as far off as the middle of the view is. */
function confess() {
  const pixel = (2 * camera.position.distanceTo(controls.target) * Math.tan((page.angle * Math.PI) / 360)) / innerHeight;
  const said = new Set();
  for (const tube of tubes) {
    const least = 0.5 * tube.material.uniforms.least.value * pixel;
    const largest = [].concat(tube.spec.radius).reduce((a, b) => Math.max(a, b), 0);
    if (largest > 0 && least > 1.05 * largest) said.add(`${tube.name} ${Number((least / largest).toPrecision(2))} times`);
  }
  const list = [...said];
  const more = list.length > 3 ? ` and ${list.length - 3} more` : "";
  const text = list.length ? `drawn as thick as ${LEAST} pixels: ${list.slice(0, 3).join(", ")}${more}; true when nearer` : "";
  if (thicker.textContent !== text) thicker.textContent = text;
}

$("help").textContent = [
  page.title, "",
  "drag to turn, right button or two fingers to move, wheel or pinch to zoom",
  "point at a line for its values; click for their history",
  "space: play or pause    ← →: a frame, with shift ten    home, end",
  "r: view as at first    h: this    esc: close", "",
  `frames ${page.numbers[0]} to ${page.numbers[frames - 1]} of the result, ${frames} held here`,
  `places of lines are rounded to ${Number((1000 * page.error).toPrecision(1))} mm`,
].join("\n");
