"use strict";
// What a reader sees: camera, words in space, time, legend, notes.
// Words out of a scene enter the page as text only, never as markup.

const $ = (id) => document.getElementById(id);
const page = JSON.parse($("scene").textContent);
const frames = page.time.length;
const state = {
  frame: 0, when: new Moment(0, page.time), playing: false, speed: 1, clock: 0, quantity: null, pinned: null, shown: 0, hovered: null,
  followed: null, moved: false, dirty: true, dark: false,
};
const still = matchMedia("(prefers-reduced-motion: reduce)");

function made(tag, parent, text = "", kind = "") {
  const element = document.createElement(tag);
  element.textContent = text;
  if (kind) element.className = kind;
  parent.appendChild(element);
  return element;
}

/** A number with so many digits after the point, as people write it. */
function written(value, digits) {
  if (isNaN(value)) return "unknown";
  const text = value.toFixed(Math.max(digits, 0));
  return (Number(text) === 0 ? text.replace("-", "") : text).replace("-", "−");
}

/** A colour of the style sheet, which knows dark from light. */
const ink = (name) => getComputedStyle(document.body).getPropertyValue(name).trim();

// ---------------------------------------------------------------- what is seen

let renderer = null;
try {
  renderer = new THREE.WebGLRenderer({ canvas: $("space"), antialias: true });
} catch (error) {
  made("p", document.body, "This browser shows no 3-D here: WebGL 2 is missing or switched off.", "broken");
  throw error;
}
const bytes = inflated($("data").textContent);
$("data").remove();
const scene = new THREE.Scene();
const camera = new THREE.PerspectiveCamera(page.angle, 1, 0.01, 1000);
camera.up.set(0, 0, 1);
// The sun stands behind the first view's left shoulder, high enough that shadows stay near what throws them.
const sun = sunlight();
const light = new THREE.HemisphereLight(0xffffff, 0x8f8a80, 1.7);
const lamp = new THREE.DirectionalLight(0xfff4e4, 2.0);
lamp.position.copy(sun);
scene.add(camera, light, lamp);

function sunlight() {
  const back = new THREE.Vector3(page.eye[0], page.eye[1], 0);
  if (back.length() < 1e-6) back.set(0, -1, 0);
  back.normalize();
  const across = new THREE.Vector3(-back.y, back.x, 0);
  return back.multiplyScalar(0.45).addScaledVector(across, -0.5).setZ(1).normalize();
}

// The middle of the picture is the origin; levels know their height above it.
const tubes = page.lines.map((spec) => new Tube(spec, bytes, page.factor));
const bodies = page.solids.map((spec) => new Body(spec, bytes));
const vectors = page.arrows.map((spec) => new Vectors(spec, bytes, page.size));
const planes = page.levels.map((spec) => new Plane(spec, page.size, sun));
if (page.floor) planes.push(new Plane({ height: page.base, colour: "#b9bcbb", opacity: 1, clear: false, waves: null }, page.size, sun));
const sky = new Sky();
const still_water = page.levels.find((one) => one.clear && !one.waves);
const receives = page.base ?? still_water?.height ?? null;
const shadows = receives === null ? null : new Shadows(tubes, bodies, receives, page.base === null, page.size, sun);
const moving = [...tubes, ...bodies, ...vectors, ...planes];
for (const part of [...moving, sky]) scene.add(part.mesh);
for (const mesh of shadows ? shadows.meshes : []) scene.add(mesh);
const scale_lines = new THREE.LineBasicMaterial({ color: 0x202020 });
for (const spec of page.rulers) {
  const pairs = spec.points.slice(1).flatMap((point, k) => [...spec.points[k], ...point]);
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(pairs), 3));
  scene.add(new THREE.LineSegments(geometry, scale_lines));
}

/** Sky, haze and ground for daylight or for a dark room. */
function theme() {
  const asked = document.documentElement.dataset.theme;
  state.dark = asked ? asked === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
  const sea = page.levels.some((one) => one.clear);
  const [zenith, horizon, below] = state.dark
    ? ["#10161e", "#26303b", sea ? "#101c27" : "#1b2127"]
    : ["#b7d0e8", "#edf2f6", sea ? "#d3e3ec" : "#e6e8e8"];
  sky.uniforms.zenith.value.copy(rgb(zenith));
  sky.uniforms.horizon.value.copy(rgb(horizon));
  sky.uniforms.nadir.value.copy(rgb(planes.length ? below : state.dark ? "#151a20" : "#f4f5f6"));
  for (const plane of planes) {
    const { plain, line, haze } = plane.material.uniforms;
    plain.value.copy(rgb(plane.spec.colour)).multiplyScalar(state.dark ? 0.4 : 1);
    if (!plane.spec.clear) plain.value.lerp(rgb(state.dark ? "#20262c" : "#eef0f0"), 0.55);
    haze.value.copy(rgb(horizon));
    line.value.copy(rgb(state.dark || plane.spec.clear ? "#cfd8de" : "#59636b"));
  }
  const under = planes.find((plane) => plane.spec.height === receives);
  if (shadows) shadows.uniforms.shade.value.copy(under.material.uniforms.plain.value).multiplyScalar(state.dark ? 0.55 : 0.76);
  scale_lines.color.set(state.dark ? 0xdfe4e8 : 0x202020);
  light.intensity = state.dark ? 1.3 : 1.7;
  state.dirty = true;
  if (state.pinned) plot();
}

const tables = new Map(page.quantities.map((one) => [one.name, texture(one.table)]));
const controls = new THREE.OrbitControls(camera, renderer.domElement);
controls.enableDamping = !still.matches;
controls.dampingFactor = 0.2;
controls.zoomToCursor = true;
controls.addEventListener("change", () => (state.dirty = true));
controls.addEventListener("start", () => (state.moved = true));

// ---------------------------------------------------------------- camera

/** Places for the picture between what is written around it, px: beside the legend, or below it. */
function rooms() {
  const [wide, high] = [innerWidth, innerHeight];
  const foot = document.querySelector("footer").offsetHeight + 30;
  const head = $("legend").getBoundingClientRect();
  const title = document.querySelector("header").getBoundingClientRect();
  const bottom = high - foot;
  if (wide <= 700) return [{ left: 20, right: wide - 44, top: Math.max(title.bottom, head.bottom) + 10, bottom }];
  const top = Math.max(title.bottom, 60) + 12;
  if (!head.height) return [{ left: 40, right: wide - 60, top, bottom }];
  return [
    { left: 40, right: head.left - 20, top, bottom },
    { left: 40, right: wide - 60, top: Math.max(title.bottom, head.bottom) + 16, bottom },
  ];
}

let room = null; // the place that the picture has

/** Keep the middle of the view in the middle of its room. */
function center_view() {
  const [wide, high] = [innerWidth, innerHeight];
  room ??= rooms()[0];
  camera.setViewOffset(wide, high, 0.5 * (wide - room.left - room.right), 0.5 * (high - room.top - room.bottom), wide, high);
}

/** Put the eye where everything just fits into the room for it. */
function fit() {
  state.followed = null;
  $("go").value = "";
  frame_points(page.outermost, page.eye, 0.5 * page.size);
  state.moved = false;
}

/** Put the eye in a direction so that points just fit, not nearer than so far; in the room where they are larger. */
function frame_points(points, eye, least) {
  const back = new THREE.Vector3(...eye).normalize();
  const across = new THREE.Vector3().crossVectors(camera.up, back);
  if (across.length() < 1e-6) across.set(1, 0, 0);
  across.normalize();
  const over = new THREE.Vector3().crossVectors(back, across);
  const seen = points.map((point) => {
    const at = new THREE.Vector3(...point);
    return [[at.dot(across), at.dot(over)], at.dot(back)];
  });
  const fits = rooms().map((place) => ({ place, ...fitted(seen, place) }));
  const best = fits.reduce((one, other) => (other.far < one.far ? other : one));
  room = best.place;
  const far = Math.max(best.far, best.middle + least);
  const [x, y] = best.shifts(far).map(([lowest, most]) => -0.5 * (lowest + most));
  controls.target.copy(across).multiplyScalar(x).addScaledVector(over, y).addScaledVector(back, best.middle);
  camera.position.copy(controls.target).addScaledVector(back, far - best.middle);
  center_view();
  controls.update();
  leave();
  state.dirty = true;
}

/** How far off the eye must be for points, across, over and near, to fit into a room. */
function fitted(seen, { left, right, top, bottom }) {
  const slope = Math.tan((page.angle * Math.PI) / 360) / innerHeight;
  const reach = [slope * Math.max(right - left, 80), slope * Math.max(bottom - top, 80)];
  // Bisect for the least distance at which some shift brings all points between both pairs of edges.
  const shifts = (away) =>
    [0, 1].map((axis) => {
      const most = Math.min(...seen.map(([at, near]) => reach[axis] * (away - near) - at[axis]));
      const lowest = Math.max(...seen.map(([at, near]) => -reach[axis] * (away - near) - at[axis]));
      return [lowest, most];
    });
  const middle = seen.reduce((sum, [, near]) => sum + near, 0) / seen.length;
  let [near, far] = [middle, middle + 1000 * page.size];
  for (let k = 0; k < 60; k++) {
    const away = 0.5 * (near + far);
    [near, far] = shifts(away).every(([lowest, most]) => lowest <= most) ? [near, away] : [away, far];
  }
  return { far, middle, shifts };
}

/** Corners of the box around a body, or around a line, now. */
function corners(part) {
  const box = new THREE.Vector3(Infinity, Infinity, Infinity);
  const top = box.clone().negate();
  const at = new THREE.Vector3();
  const body = part.mesh.geometry.attributes.position;
  const places = part.at ?? body.array;
  for (let k = 0; k < places.length; k += 3) {
    at.fromArray(places, k);
    if (!part.at) at.applyMatrix4(part.mesh.matrix);
    box.min(at);
    top.max(at);
  }
  return [0, 1, 2, 3, 4, 5, 6, 7].map((k) => [k & 1 ? top.x : box.x, k & 2 ? top.y : box.y, k & 4 ? top.z : box.z]);
}

/** Go near a body, and go along with it. */
function approach(body) {
  const points = corners(body);
  const size = Math.max(...[0, 1, 2].map((c) => points[7][c] - points[0][c]));
  // A few times its size is around it, so that one sees where it is.
  const back = new THREE.Vector3().subVectors(camera.position, controls.target).normalize();
  const middle = [0, 1, 2].map((c) => 0.5 * (points[0][c] + points[7][c]));
  frame_points(points.map((point) => point.map((x, c) => middle[c] + 2.5 * (x - middle[c]))), back.toArray(), 4 * size);
  state.followed = body;
  state.from = new THREE.Vector3(...body.p);
  state.moved = true;
}

/** Shift the eye with what it follows. */
function follow() {
  const shift = new THREE.Vector3(...state.followed.p).sub(state.from);
  state.from.add(shift);
  camera.position.add(shift);
  controls.target.add(shift);
}

/** Pixels that are drawn for each of the page's: fewer while things move, where that is slow, and all when they rest. */
const density = { full: 1, share: 1 };
function set_density(share) {
  density.share = share;
  renderer.setPixelRatio(density.full * share);
  for (const tube of tubes) tube.material.uniforms.height.value = innerHeight;
  state.dirty = true;
}

function resize() {
  const [wide, high] = [innerWidth, innerHeight];
  document.body.style.setProperty("--under", `${document.querySelector("header").getBoundingClientRect().bottom + 6}px`);
  document.body.style.setProperty("--foot", `${document.querySelector("footer").offsetHeight}px`);
  density.full = Math.min(devicePixelRatio, 2);
  renderer.setPixelRatio(density.full * density.share);
  renderer.setSize(wide, high, false);
  camera.aspect = wide / high;
  for (const tube of tubes) tube.material.uniforms.height.value = high;
  center_view();
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
    return { element: made("span", $("words"), spec.text), at: () => new THREE.Vector3(...track.read(state.when, [0, 0, 0])), shift: [10, -8] };
  }),
  ...page.levels.map((spec) => {
    const element = made("span", $("words"), spec.name, "level");
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
  const axes = [["x", ink("--x")], ["y", ink("--y")], ["z", ink("--z")]].map(([name, colour], k) => {
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

const clock_digits = (() => {
  const step = frames > 1 ? (page.time[frames - 1] - page.time[0]) / (frames - 1) : 1;
  return Math.min(Math.max(Math.ceil(-Math.log10(step || 1)), 0) + (step < 1 ? 0 : 1), 6);
})();

/** Show a picture, or a moment between two: `at` counts pictures from 0. */
function show(at) {
  const when = (state.when = new Moment(at, page.time));
  state.frame = when.nearest;
  for (const part of moving) part.show(when);
  if (shadows) shadows.show();
  if (state.followed) follow();
  $("slider").value = when.at;
  $("slider").setAttribute("aria-valuetext", `${written(when.time, clock_digits)} s`);
  $("clock").textContent = `t = ${written(when.time, clock_digits)} s of ${written(page.time[frames - 1], clock_digits)} s`;
  document.body.dataset.frame = state.frame;
  document.body.dataset.time = when.time;
  if (state.pinned) plot();
  if (state.hovered) $("tip").textContent = told(state.hovered, false);
  state.dirty = true;
}

/** Picture number, with its fraction, at a time, s. */
function place_of(time) {
  if (time <= page.time[0]) return 0;
  if (time >= page.time[frames - 1]) return frames - 1;
  let [low, high] = [0, frames - 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    [low, high] = page.time[middle] <= time ? [middle, high] : [low, middle];
  }
  return low + (time - page.time[low]) / (page.time[low + 1] - page.time[low]);
}

function play(on) {
  const was = state.playing;
  state.playing = on && frames > 1;
  if (state.playing && state.when.at >= frames - 1) show(0);
  // A pause is at a picture, so that what is read is what was stored.
  if (was && !state.playing && state.when.between) show(state.frame);
  state.clock = state.when.time;
  $("play").textContent = state.playing ? "❚❚" : "▶";
  $("play").setAttribute("aria-label", state.playing ? "pause" : "play");
  document.body.dataset.playing = state.playing ? "1" : "";
}

/** Go on by so many seconds of the reader's time; begin again after the end. */
function advance(seconds) {
  state.clock += seconds * state.speed;
  if (state.clock > page.time[frames - 1] + 0.7 * state.speed) state.clock = page.time[0];
  const at = place_of(state.clock);
  // Who wants less motion sees picture after picture, not what is between.
  const next = still.matches ? Math.floor(at + 1e-9) : at;
  if (next !== state.when.at) show(next);
}

/** Speeds to choose from: the true one is chosen if it plays everything in 4 to 90 s, else one that does about that. */
function speeds() {
  const span = page.time[frames - 1] - page.time[0];
  const usual = span >= 4 && span <= 90 ? 1 : round(Math.max(span < 4 ? span / 8 : span / 90, 1e-9));
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
    $("range").textContent = `${shown.range[0]} to ${shown.range[1]} ${shown.unit} ${shown.where ? `${shown.where}, ` : ""}in the stored frames`;
  }
  show(state.frame);
}

function legend() {
  for (const one of page.quantities) made("option", $("quantity"), one.title).value = one.name;
  made("option", $("quantity"), "none").value = "none";
  $("chooser").hidden = page.quantities.length === 0;
  const entry = (text, kind = "") => made("li", $("keys"), text, kind);
  for (const spec of page.arrows) {
    const row = entry("");
    made("span", row, "", "swatch").style.setProperty("--colour", spec.colour);
    row.append(`${spec.text}: longest arrow ${spec.said}`);
  }
  for (const [text, factor] of page.enlarged) entry(`${text} drawn ${Number(factor.toPrecision(4))} times larger`, "enlarged");
  if (!page.enlarged.length) entry("lengths and motions 1 : 1, not exaggerated", "true");
  if (page.factor !== null) entry(`lines drawn ${Number(page.factor.toPrecision(3))} times as thick`);
  if (planes.some((plane) => plane.material.uniforms.grid.value)) entry(`grid of ${length_said(round_length(page.size / 8))}${page.floor ? ", on a floor that is not in the scene" : ""}`);
}

// ---------------------------------------------------------------- what a reader must know

for (const note of page.notes) made("li", $("notes"), note);
if (page.frames > frames) made("li", $("notes"), `${frames} of ${page.frames} stored frames, evenly spread`);
const thicker = made("li", $("keys"), "", "thicker");

/** A length in the unit of the page; in metres, with a prefix that keeps it short. */
function length_said(length) {
  const { metres, unit } = page.length;
  const written = (value) => `${Number(value.toPrecision(3))}`;
  if (unit !== "m") return `${written(length / metres)} ${unit}`;
  if (length >= 1000) return `${written(length / 1000)} km`;
  return length >= 1 ? `${written(length)} m` : length >= 0.01 ? `${written(100 * length)} cm` : `${written(1000 * length)} mm`;
}

/** A round length, as long as it is in the middle of the view. */
function scale_bar() {
  const pixel = (2 * camera.position.distanceTo(controls.target) * Math.tan((page.angle * Math.PI) / 360)) / innerHeight;
  const length = round_length(Math.min(180, 0.3 * innerWidth) * pixel);
  $("rule").style.width = `${length / pixel}px`;
  const text = length_said(length);
  $("length").textContent = page.enlarged.length ? `${text} (true, not across)` : text;
}

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
  const text = list.length ? `drawn too thick, to be seen from here: ${list.slice(0, 3).join(", ")}${more}` : "";
  if (thicker.textContent !== text) thicker.textContent = text;
}

$("help").textContent = [
  page.title, "",
  "drag to turn, right button or two fingers to move, wheel or pinch to zoom",
  "point at a thing for its name and values; click for their history",
  "space: play or pause · ← →: a picture, with shift ten · home, end: first and last",
  "+ −: faster, slower · q: another quantity of what is picked",
  "f: go to what is picked · r: view as at first · d: dark or light · h: this text · esc: close", "",
  `frames ${page.numbers[0]} to ${page.numbers[frames - 1]} of the result, ${frames} held here; between them the picture is interpolated`,
  "numbers are those of the result, rounded to what is written; ≈ where they are interpolated",
  `places of lines are rounded to ${Number((1000 * page.error).toPrecision(1))} mm`,
].join("\n");
