"use strict";
// What a twin tells, line by line, in a browser. Numbers arrive in SI; they are shown in the units of the scene.

const SPAN = 60, KEPT = 4000, LETTERS = 13;
const $ = (id) => document.getElementById(id);
const lines = [];
let units = {}, scales = {}, zeros = {}, shape = null, picture = null, changed = false, trouble = "";

// -- numbers ---------------------------------------------------------------------------------------------------------

/** Factor and unit in which a quantity of about this size is shown: the rule of the command, which came with `about`. */
function readable(size, unit) {
  if (size === 0) return zeros[unit] || [1, unit];
  const found = (scales[unit] || []).find(([least]) => size >= least);
  return found ? found.slice(1) : [1, unit];
}

/** A number with so many places after its point; what rounds to zero has no sign. */
function fixed(value, places) {
  const text = value.toFixed(places);
  return Number(text) === 0 ? text.replace("-", "") : text;
}

/** A number with as many digits as its deviation deserves, or four. */
function digits(value, sd) {
  if (sd > 0) return fixed(value, Math.min(6, Math.max(0, 1 - Math.floor(Math.log10(sd)))));
  const size = Math.abs(value);
  if (size < 1e-9) return "0";
  if (size < 1e-4 || size >= 1e6) return value.toExponential(3);
  return fixed(value, size >= 1000 ? 0 : size >= 100 ? 1 : size >= 10 ? 2 : size >= 1 ? 3 : 4);
}

/** A number or several with one unit, in a given scale or in the one of its size. */
function said(value, unit, sd = 0, scale = null) {
  if (value === null || value === undefined) return "–";
  const all = [].concat(value), known = all.filter((x) => x !== null);
  const [factor, shown] = scale || readable(Math.max(0, ...known.map(Math.abs)), unit || "");
  return all.map((x) => x === null ? "–" : digits(factor * x, factor * sd)).join("  ") + (shown ? " " + shown : "");
}

// -- cards with a trace ------------------------------------------------------------------------------------------------

function element(parent, tag, kind, text) {
  const made = document.createElement(tag);
  if (kind) made.className = kind;
  if (text !== undefined) made.textContent = text;
  parent.append(made);
  return made;
}

const cards = new Map();

function card(section, name, parts) {
  const key = section + " " + name;
  if (cards.has(key)) return cards.get(key);
  const box = element(document.querySelector(`#${section} .cards`), "div", "card");
  box.dataset.name = name;
  element(box, "div", "name", name);
  const row = element(box, "div", "row"), made = { canvas: null };
  for (const part of parts) made[part] = element(row, "span", part);
  made.canvas = element(box, "canvas");
  made.canvas.setAttribute("role", "img");
  cards.set(key, made);
  return made;
}

/** Text of a node, touched where it is another one only: who has a page read aloud hears each change. */
function write(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

function put(node, value, text) {
  write(node, text);
  node.dataset.value = value === null || value === undefined ? "" : value;
}

function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

/** Canvas of the size it is shown at, cleared; its pen in units of the page. */
function cleared(canvas) {
  const ratio = window.devicePixelRatio || 1, w = canvas.clientWidth, h = canvas.clientHeight;
  if (canvas.width !== Math.round(w * ratio) || canvas.height !== Math.round(h * ratio)) {
    canvas.width = Math.round(w * ratio);
    canvas.height = Math.round(h * ratio);
  }
  const pen = canvas.getContext("2d");
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, w, h);
  return [pen, w, h];
}

/** Lowest and highest value of what a trace shows; null where nothing is known. */
function extent(shown, { points, line, band }) {
  const end = shown[shown.length - 1].time;
  let low = Infinity, high = -Infinity;
  // Of an estimate, what is long past may leave the picture: a start that was far off would make all else a line.
  const recent = band ? end - 0.5 * Math.min(SPAN, end - shown[0].time) : end - SPAN;
  const reach = (v) => { if (v !== null && v !== undefined && isFinite(v)) { low = Math.min(low, v); high = Math.max(high, v); } };
  for (const one of shown) {
    if (one.time < recent) continue;
    if (points) reach(points(one));
    const value = line(one), wide = band ? band(one) : 0;
    reach(value);
    if (value !== null && value !== undefined) { reach(value - wide); reach(value + wide); }
  }
  return low <= high ? [low, high] : null;
}

/** Factor and unit of a whole card: of its numbers and of its axis. */
function scaleOf(reached, values, unit) {
  return readable(Math.max(0, ...[...(reached || []), ...values].filter(isFinite).map(Math.abs)), unit || "");
}

/** Numbers beside an axis, at places v with their heights y: of the values reached, or one where two have no room. */
function marks(pen, reached, y, sd, [factor, unit]) {
  const [low, high] = reached, middle = 0.5 * (low + high), apart = y(low) - y(high);
  if (apart < 2 * LETTERS) {
    const text = digits(factor * middle, factor * sd);
    pen.fillText(text, 0, y(middle) + (unit ? -2 : 4));
    pen.fillText(unit, 0, y(middle) + LETTERS - 2);
    return [text];
  }
  pen.fillText(unit, 0, y(middle) + 4);
  return reached.map((v) => {
    const text = digits(factor * v, 0.3 * factor * (high - low));
    pen.fillText(text, 0, y(v) + 4);
    return text;
  });
}

/** A trace over the last seconds: points, a line, a band about it, between the values it has reached. */
function trace(canvas, shown, { points, line, band }, reached, scale, sd = 0) {
  const [pen, w, h] = cleared(canvas);
  const end = shown[shown.length - 1].time, begin = end - SPAN, left = 52, bottom = h - 4;
  if (!reached) return;
  let [low, high] = reached;
  const least = 1e-3 * Math.max(Math.abs(low), Math.abs(high), 1e-9), room = Math.max(0.08 * (high - low), least);
  low -= room;
  high += room;
  const x = (t) => left + (w - left) * (t - begin) / SPAN, y = (v) => bottom - (bottom - 4) * (v - low) / (high - low);
  pen.font = "11px system-ui, sans-serif";
  pen.fillStyle = colour("--soft");
  pen.strokeStyle = colour("--line");
  for (const v of reached) {
    pen.beginPath();
    pen.moveTo(left, y(v));
    pen.lineTo(w, y(v));
    pen.stroke();
  }
  const said_there = marks(pen, reached, y, sd, scale), where = said_there.length > 1 ? `from ${said_there.join(" to ")}` : `at ${said_there}`;
  canvas.setAttribute("aria-label", `${where}${scale[1] ? " " + scale[1] : ""} in the last ${SPAN} s`);
  pen.save();
  pen.beginPath();
  pen.rect(left, 0, w - left, h);
  pen.clip();
  const known = shown.filter((one) => line(one) !== null && line(one) !== undefined);
  if (band && known.length) {
    pen.fillStyle = colour("--band");
    pen.beginPath();
    for (const one of known) pen.lineTo(x(one.time), y(Math.min(line(one) + band(one), high + (high - low))));
    for (const one of known.slice().reverse()) pen.lineTo(x(one.time), y(Math.max(line(one) - band(one), low - (high - low))));
    pen.fill();
  }
  if (points) {
    pen.fillStyle = colour("--measured");
    for (const one of shown) {
      const v = points(one);
      if (v !== null && v !== undefined) pen.fillRect(x(one.time) - 1, y(v) - 1, 2.2, 2.2);
    }
  }
  pen.strokeStyle = colour("--computed");
  pen.lineWidth = 1.6;
  pen.beginPath();
  let before = null;
  for (const one of known) {
    if (before === null || one.time - before > 2) pen.moveTo(x(one.time), y(line(one)));
    else pen.lineTo(x(one.time), y(line(one)));
    before = one.time;
  }
  pen.stroke();
  pen.restore();
}

/** What is shown of a twin that has given no line. */
const NOTHING = { stamp: "–", causes: [], inputs: {}, measured: {}, outputs: {}, estimates: {}, alarms: [], restrict: [], not_observable: [] };

// -- the page ------------------------------------------------------------------------------------------------------------

function show() {
  const line = lines[lines.length - 1] || NOTHING;
  const shown = lines.filter((one) => one.time > line.time - SPAN);
  put($("time"), line.time, line.stamp);
  put($("lag"), line.lag, line.lag === undefined ? "–" : fixed(line.lag, 2) + " s");
  write($("health"), trouble || line.health);
  $("health").dataset.health = trouble ? "none" : line.health;
  $("why").hidden = !(line.causes && line.causes.length);
  list(document.querySelector("#why ul"), (line.causes || []).map((text) => [text, false]));
  $("state").hidden = !line.rig;
  if (line.rig) write($("state"), line.rig.state + (line.rig.added ? `, ${said(line.rig.added, "m")} added` : ""));
  for (const [name, one] of Object.entries(line.estimates)) {
    const made = card("estimates", name, ["value", "with"]), of = (row) => row.estimates[name];
    const curves = { line: (row) => of(row) ? of(row).value : null, band: (row) => of(row) ? 2 * of(row).sd : 0 };
    const reached = extent(shown, curves), scale = scaleOf(reached, [one.value], one.unit);
    put(made.value, one.value, said(one.value, one.unit, one.sd, scale));
    put(made.with, one.sd, "± " + said(2 * one.sd, one.unit, 2 * one.sd, scale));
    trace(made.canvas, shown, curves, reached, scale, one.sd);
  }
  for (const [name, value] of Object.entries(line.measured)) {
    const made = card("traces", name, ["measured", "computed"]), computed = line.outputs[name];
    const curves = { points: (row) => row.measured[name], line: (row) => row.outputs[name] };
    const known = [value, computed].filter((x) => x !== null && x !== undefined);
    const reached = extent(shown, curves), scale = scaleOf(reached, known, units[name]);
    put(made.measured, value, said(value, units[name], 0, scale));
    put(made.computed, computed, said(computed, units[name], 0, scale));
    trace(made.canvas, shown, curves, reached, scale);
  }
  const others = Object.entries(line.inputs).concat(Object.entries(line.outputs).filter(([name]) => !(name in line.measured)));
  table(document.querySelector("#others table"), others);
  alarms(line);
  list($("unseen"), line.not_observable.map((text) => [text, false]));
  const ends = line.rig && line.rig.stick_slip_ends;
  const limits = line.restrict.map((one) => [one.text, one.restrict]);
  if (ends && ends.text) limits.push(["stick-slip: " + ends.text, false]);
  if (ends && ends.speed) {
    limits.push([`stick-slip ends above ${said(ends.speed, "rad/s")}` +
      (ends.weight ? `, or below ${said(ends.weight, "N")} on the bit` : ""), false]);
  }
  $("limits").hidden = !limits.length;
  list(document.querySelector("#limits ul"), limits);
}

function table(node, rows) {
  while (node.rows.length > rows.length) node.deleteRow(-1);
  rows.forEach(([name, value], k) => {
    const row = node.rows[k] || node.insertRow();
    while (row.cells.length < 2) row.insertCell();
    row.dataset.name = name;
    write(row.cells[0], name);
    put(row.cells[1], value, said(value, units[name]));
  });
}

/** Items of a list, of which those that stay are left alone. */
function list(node, rows) {
  while (node.children.length > rows.length) node.lastChild.remove();
  rows.forEach(([text, passed], k) => {
    const item = node.children[k] || element(node, "li");
    write(item, text);
    item.className = passed ? "passed" : "";
  });
}

/** Alarms, each in a row that stays as long as it does; one that is not known to hold is outlined, and says so. */
function alarms(line) {
  const node = document.querySelector("#alarms ul"), names = line.alarms.map((one) => one.name);
  $("alarms").hidden = !line.alarms.length;
  for (const row of [...node.children]) if (!names.includes(row.dataset.name)) row.remove();
  for (const one of line.alarms) {
    let row = [...node.children].find((other) => other.dataset.name === one.name);
    if (!row) {
      row = element(node, "li");
      row.dataset.name = one.name;
      element(element(row, "span", "what"), "b", "", one.name);
      element(row, "span", "since", "since " + one.stamp);
      element(row, "span", "cause");
    }
    const what = row.querySelector(".what"), doubted = one.known === false;
    row.className = doubted ? "doubted" : "certain";
    if (doubted && what.children.length < 2) element(what, "span", "doubt", "in doubt");
    if (!doubted && what.children.length > 1) what.lastChild.remove();
    write(row.querySelector(".since"), "since " + one.stamp);
    write(row.querySelector(".cause"), one.text);
  }
}

// -- the picture -----------------------------------------------------------------------------------------------------------

const view = { around: 0, up: 0, zoom: 1, moved: false };
let first = null;

function begin() {
  const [x, y, z] = shape.eye;
  first = { around: Math.atan2(y, x), up: Math.atan2(z, Math.hypot(x, y)), zoom: 1 };
  if (!view.moved) Object.assign(view, first);
}

function rgb(text) {
  return [1, 3, 5].map((k) => parseInt(text.slice(k, k + 2), 16));
}

/** Points of all solids and lines on the screen, far ones first. */
function draw() {
  const canvas = document.querySelector("#picture canvas");
  const [pen, w, h] = cleared(canvas);
  if (!shape || !picture || picture.number !== shape.number) return;
  const ca = Math.cos(view.around), sa = Math.sin(view.around), cu = Math.cos(view.up), su = Math.sin(view.up);
  const eye = [ca * cu, sa * cu, su], right = [-sa, ca, 0], over = [-ca * su, -sa * su, cu];
  const middle = shape.low.map((low, k) => 0.5 * (low + shape.high[k]));
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  // The box of all that there is fills the canvas.
  let wide = 1e-6, tall = 1e-6;
  for (let k = 0; k < 8; k++) {
    const corner = [0, 1, 2].map((axis) => ((k >> axis) & 1 ? shape.high : shape.low)[axis] - middle[axis]);
    wide = Math.max(wide, Math.abs(dot(corner, right)));
    tall = Math.max(tall, Math.abs(dot(corner, over)));
  }
  const scale = 0.46 * view.zoom * Math.min(w / wide, h / tall);
  const place = (p) => {
    const q = [p[0] - middle[0], p[1] - middle[1], p[2] - middle[2]];
    return [w / 2 + scale * dot(q, right), h / 2 - scale * dot(q, over), dot(q, eye)];
  };
  const things = [];
  let moving = 0;
  for (const solid of shape.solids) {
    const m = solid.moves ? picture.poses[moving++] : null;
    const world = m ? solid.points.map((p) => [0, 4, 8].map((r) => m[r] * p[0] + m[r + 1] * p[1] + m[r + 2] * p[2] + m[r + 3])) : solid.points;
    const spots = world.map(place), paint = rgb(solid.colour);
    for (const [a, b, c] of solid.triangles) {
      const u = [0, 1, 2].map((k) => world[b][k] - world[a][k]), v = [0, 1, 2].map((k) => world[c][k] - world[a][k]);
      const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
      const facing = dot(n, eye);
      if (facing <= 0) continue;
      const light = 0.55 + 0.45 * Math.max(0, (0.35 * n[0] - 0.45 * n[1] + 0.82 * n[2]) / Math.hypot(...n));
      things.push({ depth: (spots[a][2] + spots[b][2] + spots[c][2]) / 3, corners: [spots[a], spots[b], spots[c]],
        paint: `rgba(${paint.map((x) => Math.round(light * x)).join(",")},${solid.opacity})` });
    }
  }
  shape.lines.forEach((line, k) => {
    const spots = picture.lines[k].map(place), thick = Math.min(24, Math.max(line.hollow ? 1 : 1.6, 2 * scale * line.radius));
    for (let i = 1; i < spots.length; i++) {
      things.push({ depth: 0.5 * (spots[i - 1][2] + spots[i][2]) + (line.hollow ? -1e3 : 0), ends: [spots[i - 1], spots[i]],
        paint: line.hollow ? line.colour + "55" : line.colour, thick });
    }
  });
  levels(pen, w, h, place, middle);
  things.sort((a, b) => a.depth - b.depth);
  pen.lineCap = "round";
  for (const one of things) {
    pen.beginPath();
    if (one.corners) {
      one.corners.forEach((p) => pen.lineTo(p[0], p[1]));
      pen.closePath();
      pen.fillStyle = pen.strokeStyle = one.paint;
      pen.lineWidth = 0.6;
      pen.fill();
    } else {
      pen.moveTo(one.ends[0][0], one.ends[0][1]);
      pen.lineTo(one.ends[1][0], one.ends[1][1]);
      pen.strokeStyle = one.paint;
      pen.lineWidth = one.thick;
    }
    pen.stroke();
  }
  pen.fillStyle = colour("--soft");
  pen.font = "11px system-ui, sans-serif";
  const height = shape.high[2] - shape.low[2], [factor, unit] = readable(height, "m");
  pen.fillText(`${(factor * height).toFixed(0)} ${unit} high`, 8, h - 8);
}

/** Sea and ground: a square as wide as all else. */
function levels(pen, w, h, place, middle) {
  const reach = 0.75 * Math.max(shape.high[0] - shape.low[0], shape.high[1] - shape.low[1], shape.high[2] - shape.low[2]);
  for (const level of shape.levels) {
    pen.beginPath();
    for (const [x, y] of [[-1, -1], [1, -1], [1, 1], [-1, 1]]) {
      const spot = place([middle[0] + reach * x, middle[1] + reach * y, level.height]);
      pen.lineTo(spot[0], spot[1]);
    }
    pen.fillStyle = level.colour + Math.round(255 * level.opacity).toString(16).padStart(2, "0");
    pen.fill();
  }
}

/** Look from elsewhere; before the first picture there is no view that could be another one. */
function look(from, moved = true) {
  if (!first) return;
  Object.assign(view, from, { moved });
  changed = true;
}

function turned(around, up) {
  look({ around: view.around + around, up: Math.max(-1.5, Math.min(1.5, view.up + up)) });
}

function zoomed(factor) {
  look({ zoom: Math.max(0.3, Math.min(40, view.zoom * factor)) });
}

function as_first() {
  look(first, false);
}

const TURN = 0.1, ZOOM = 1.25;
const KEYS = {
  ArrowLeft: () => turned(TURN, 0), ArrowRight: () => turned(-TURN, 0), ArrowUp: () => turned(0, -TURN), ArrowDown: () => turned(0, TURN),
  "+": () => zoomed(ZOOM), "=": () => zoomed(ZOOM), "-": () => zoomed(1 / ZOOM), Home: as_first,
};

/** Turn and zoom by pointers, wheel, keys and buttons. */
function turn() {
  const canvas = document.querySelector("#picture canvas"), fingers = new Map();
  const apart = () => { const [a, b] = [...fingers.values()]; return Math.hypot(a[0] - b[0], a[1] - b[1]); };
  let start = null;  // where it was looked from as the first finger came
  canvas.addEventListener("pointerdown", (e) => {
    if (!fingers.size) start = { around: view.around, up: view.up, moved: view.moved, of: first };
    fingers.set(e.pointerId, [e.clientX, e.clientY]);
    canvas.setPointerCapture(e.pointerId);
  });
  canvas.addEventListener("pointerup", (e) => { fingers.delete(e.pointerId); });
  // The browser takes a finger that scrolls after some way only: what that way has turned was not meant.
  canvas.addEventListener("pointercancel", (e) => { if (fingers.delete(e.pointerId) && first && start.of === first) look({ around: start.around, up: start.up }, start.moved); });
  canvas.addEventListener("pointermove", (e) => {
    const from = fingers.get(e.pointerId);
    if (!from) return;
    const before = fingers.size === 2 ? apart() : 0;
    fingers.set(e.pointerId, [e.clientX, e.clientY]);
    if (fingers.size === 2) {
      zoomed(apart() / Math.max(before, 1));
      start.moved = view.moved;
    } else turned(-0.008 * (e.clientX - from[0]), 0.008 * (e.clientY - from[1]));
  });
  canvas.addEventListener("wheel", (e) => { e.preventDefault(); zoomed(Math.exp(-0.0012 * e.deltaY)); }, { passive: false });
  canvas.addEventListener("dblclick", as_first);
  canvas.addEventListener("keydown", (e) => {
    if (!KEYS[e.key] || e.ctrlKey || e.metaKey || e.altKey) return;
    e.preventDefault();
    KEYS[e.key]();
  });
  for (const button of document.querySelectorAll("#picture button")) button.addEventListener("click", () => KEYS[button.value]());
}

// -- what comes ------------------------------------------------------------------------------------------------------------

// ms until the twin is looked for again: after it was lost, after it said that it ends; and without a word until it is lost.
const AGAIN = 3000, SLOWLY = 10000, QUIET = 10000;
const NO_DATA = "no data yet", LOST = "no connection to the twin", MUTE = "the twin does not answer";
let twin = "", program = "", ended = "";

/** Keep a line in the place of those that are not before it: a twin that goes on may give its last ones again. */
function take(line) {
  while (lines.length && line.time <= lines[lines.length - 1].time) lines.pop();
  lines.push(line);
  if (lines.length > KEPT) lines.splice(0, lines.length - KEPT);
}

/** Take all away that belongs to another twin. */
function empty() {
  lines.length = 0;
  shape = picture = first = null;
  view.moved = false;
  $("notes").textContent = "";
  document.querySelector("#alarms ul").replaceChildren();
}

/** Learn which twin this is: the page stays open over many runs. One that goes on is the same, and keeps its lines. */
function meet(about) {
  ended = "";
  if (about.twin !== twin) empty();
  ({ twin, units, scales, zeros } = about);
  $("title").textContent = document.title = about.title;
  // They are made anew of the newest line: another map may have others.
  cards.clear();
  for (const all of document.querySelectorAll(".cards")) all.replaceChildren();
}

/** Hear the twin. Whatever ends that, it is tried again: a browser does so by itself after some ends only. */
function listen() {
  const source = new EventSource("events");
  let heard = performance.now();
  const hear = (kind, what) => source.addEventListener(kind, (e) => { heard = performance.now(); what(e); });
  const on = (kind, what) => hear(kind, (e) => { what(JSON.parse(e.data)); changed = true; });
  const over = (text) => {
    source.close();
    clearInterval(watch);
    lost(ended || text);
    setTimeout(listen, ended ? SLOWLY : AGAIN);
  };
  const watch = setInterval(() => { if (performance.now() - heard > QUIET) over(MUTE); }, 1000);
  hear("alive", () => {});
  on("about", (about) => {
    // The first program that is heard made this page: so it is loaded once for each other one, and never in a circle.
    program = program || about.program;
    if (about.program === program) return meet(about);
    source.close();
    location.reload();
  });
  on("lines", (all) => { all.forEach(take); lost(all.length ? "" : NO_DATA); });
  on("line", (line) => { lost(""); take(line); });
  on("silent", (told) => lost(told.text));
  on("shape", (made) => { shape = made; begin(); $("notes").textContent = made.notes.join("; "); });
  on("picture", (made) => { picture = made; });
  on("ended", (told) => { ended = told.text; over(ended); });
  source.onerror = () => over(LOST);
}

/** Say that nothing comes any more; what came last stays on the page, grey. An empty text: something comes again. */
function lost(text) {
  trouble = text;
  changed = true;
  document.body.classList.toggle("old", text !== "");
}

function paint() {
  if (changed) {
    changed = false;
    show();
    draw();
  }
  window.requestAnimationFrame(paint);
}

$("span").textContent = SPAN;
window.addEventListener("resize", () => { changed = true; });
turn();
lost(NO_DATA);
listen();
paint();
