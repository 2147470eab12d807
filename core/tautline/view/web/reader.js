"use strict";
// What a reader asks: values under the pointer and their history, keys, the address; and the beginning of it all.

// ---------------------------------------------------------------- what is under the pointer

const SILENT = 5; // px by which a line without numbers, such as a path, must be nearer than one that has some

/** The line within reach of a place on the page, px, its node (or point) there, and how far off it is. */
function picked(x, y, reach) {
  let best = null;
  const at = new THREE.Vector3();
  for (const tube of tubes) {
    if (tube.spec.hollow && !Object.keys(tube.tracks).length) continue;
    const silence = Object.keys(tube.tracks).length ? 0 : SILENT;
    let before = null;
    for (let k = 0; k < tube.count; k++) {
      const here = projected(at.fromArray(tube.at, 3 * k));
      if (before && here.z < 1 && before.z < 1) {
        const [dx, dy] = [here.x - before.x, here.y - before.y];
        const share = Math.min(Math.max(((x - before.x) * dx + (y - before.y) * dy) / (dx * dx + dy * dy || 1), 0), 1);
        const off = Math.hypot(x - before.x - share * dx, y - before.y - share * dy) + silence;
        if (off < (best ? best.off : reach)) best = { tube, off, point: k - 1 + share };
      }
      before = here;
    }
  }
  if (!best) return null;
  const { tube, point, off } = best;
  if (!tube.nodes.length) return { tube, point: Math.round(point), node: null, off };
  const nearest = tube.nodes.reduce((a, b, k) => (Math.abs(b - point) < Math.abs(tube.nodes[a] - point) ? k : a), 0);
  return { tube, point: tube.nodes[nearest], node: nearest + 1, off };
}

/** What is known of a pick: its name, and each of its numbers with its value at any stored moment. */
function known({ tube, body, point, node }) {
  if (body) return { name: body.name, time: page.moments, numbers: body.histories.map((one) => ({ ...one, at: (k) => one.track.value(k, 0) })) };
  const numbers = page.quantities.filter((one) => tube.tracks[one.name]).map((one) => {
    const track = tube.tracks[one.name];
    return { ...one, digits: track.digits, at: (k) => track.value(k, point) };
  });
  return { name: node === null ? tube.name : `${tube.name}, node ${node}`, time: page.time, numbers };
}

/** Value of a number now, as text: of the result where a moment was stored, else interpolated, with a sign that says so. */
function present(one, time) {
  const now = state.when.time;
  let [low, high] = [0, time.length - 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    [low, high] = time[middle] <= now + 1e-12 ? [middle, high] : [low, middle];
  }
  const unit = one.unit ? ` ${one.unit}` : "";
  for (const k of [low, high]) if (Math.abs(time[k] - now) < 1e-9 * Math.max(1, Math.abs(now))) return `${written(one.at(k), one.digits)}${unit}`;
  const share = (now - time[low]) / (time[high] - time[low] || 1);
  return `≈ ${written((1 - share) * one.at(low) + share * one.at(high), one.digits)}${unit}`;
}

/** What is said of a pick now; `all` its numbers, or the one that colours. */
function told(found, all) {
  const { name, time, numbers } = known(found);
  const shown = all ? numbers : found.body ? numbers.slice(0, 3) : numbers.filter((one) => !state.quantity || one.name === state.quantity.name);
  return [name, ...shown.map((one) => `${one.text} ${present(one, time)}`)].join("\n");
}

const ray = new THREE.Raycaster();

/** The body under a place on the page; of a wheel between plates the wheel, which has more to tell. */
function hit(x, y) {
  ray.setFromCamera(new THREE.Vector2((2 * x) / innerWidth - 1, 1 - (2 * y) / innerHeight), camera);
  const hits = ray.intersectObjects(bodies.map((body) => body.mesh));
  if (!hits.length) return null;
  const found = hits.map(({ object, distance }) => ({ body: bodies.find((one) => one.mesh === object), distance }));
  const telling = found.find(({ body, distance }) => body.histories.length && distance - found[0].distance < 2 * body.spec.size);
  return (telling ?? found[0]).body;
}

/** What is at a place on the page: a line that is very near, else a body, else a line within reach; of a body without numbers the line. */
function found_at(x, y, reach) {
  const line = picked(x, y, reach);
  if (line && line.off < 4) return line;
  const body = hit(x, y);
  return body && (body.histories.length || !line) ? { body } : line;
}

/** What was under the pointer is not there any more. */
function leave() {
  $("tip").hidden = true;
  state.hovered = null;
}

function hover(event) {
  const found = event.buttons ? null : found_at(event.clientX, event.clientY, 10);
  state.hovered = found;
  $("tip").hidden = !found;
  space.style.cursor = found ? "pointer" : "";
  if (!found) return;
  $("tip").textContent = told(found, false);
  const left = Math.min(event.clientX + 14, innerWidth - $("tip").offsetWidth - 8);
  const top = event.clientY + 18 + $("tip").offsetHeight > innerHeight ? event.clientY - 12 - $("tip").offsetHeight : event.clientY + 18;
  $("tip").style.transform = `translate(${left}px, ${top}px)`;
}

/** Round numbers from low to high, both included where they are round. */
function ticks(low, high, most) {
  const step = round((high - low) / most) || 1;
  const stepped = [step, 2 * step, 2.5 * step, 5 * step].find((one) => (high - low) / one <= most) ?? 5 * step;
  const digits = Math.max(0, -Math.floor(Math.log10(stepped) + 1e-9));
  const found = [];
  for (let k = Math.ceil(low / stepped - 1e-9); k * stepped <= high + 1e-9 * stepped; k++) found.push([k * stepped, written(k * stepped, digits)]);
  return found;
}

/** The number of a pick whose history is shown: the one that was chosen, else what colours, else the first that varies. */
function chosen({ numbers, time }) {
  const varies = (one) => time.some((_, k) => written(one.at(k), one.digits) !== written(one.at(0), one.digits));
  return (
    numbers.find((one) => one.name === state.shown) ?? numbers.find((one) => one.name === state.quantity?.name) ??
    numbers.find(varies) ?? numbers[0]
  );
}

let axes = null; // where the curve's axes are, for who clicks there

/** History of what is picked, with the present moment. */
function plot() {
  const { name, time, numbers } = known(state.pinned);
  const shown = numbers.length ? chosen({ numbers, time }) : null;
  $("picked").textContent = name;
  $("values").replaceChildren();
  for (const one of numbers) {
    const row = made("button", $("values"), "", one === shown ? "value shown" : "value");
    row.setAttribute("aria-pressed", one === shown);
    row.dataset.name = one.name;
    made("span", row, one.text);
    made("b", row, present(one, time));
    row.addEventListener("click", () => ((state.shown = one.name), plot()));
  }
  $("curve").hidden = $("least").hidden = !shown || time.length < 2;
  if ($("curve").hidden) return;
  const values = time.map((_, k) => shown.at(k));
  let [low, high] = [Infinity, -Infinity];
  let [first, last] = [0, 0];
  values.forEach((value, k) => {
    if (value < low) [low, first] = [value, k];
    if (value > high) [high, last] = [value, k];
  });
  const stamp = (k) => `${written(time[k], clock_digits)} s`;
  const unit = shown.unit ? ` ${shown.unit}` : "";
  $("least").textContent = `least ${written(low, shown.digits)}${unit} at ${stamp(first)}, most ${written(high, shown.digits)}${unit} at ${stamp(last)}`;
  const canvas = $("curve");
  const [wide, tall, scale] = [canvas.clientWidth, canvas.clientHeight, devicePixelRatio];
  [canvas.width, canvas.height] = [Math.round(wide * scale), Math.round(tall * scale)];
  const pen = canvas.getContext("2d");
  pen.scale(scale, scale);
  pen.font = "11px sans-serif";
  const least = 4 * 10 ** -shown.digits;
  if (!(high - low >= least)) [low, high] = [0.5 * (low + high - least), 0.5 * (low + high + least)];
  [low, high] = [low - 0.06 * (high - low), high + 0.06 * (high - low)];
  const up = ticks(low, high, 4);
  const left = Math.max(...up.map(([, text]) => pen.measureText(text).width), 10) + 8;
  const [begin, end] = [time[0], time[time.length - 1]];
  const x = (t) => left + ((wide - left - 8) * (t - begin)) / (end - begin || 1);
  const y = (value) => tall - 20 - ((tall - 40) * (value - low)) / (high - low);
  axes = { left, wide, begin, end };
  pen.fillStyle = ink("--faint");
  pen.fillText(shown.unit ? `${shown.text} [${shown.unit}]` : shown.text, left, 11);
  pen.strokeStyle = ink("--rule");
  pen.lineWidth = 1;
  pen.textAlign = "right";
  for (const [value, text] of up) {
    pen.beginPath();
    pen.moveTo(left, y(value));
    pen.lineTo(wide - 8, y(value));
    pen.stroke();
    pen.fillText(text, left - 6, y(value) + 4);
  }
  pen.textAlign = "center";
  for (const [value, text] of ticks(begin, end, 4)) pen.fillText(`${text} s`, Math.min(Math.max(x(value), left + 8), wide - 14), tall - 5);
  pen.strokeStyle = ink("--curve");
  pen.lineWidth = 1.5;
  pen.lineJoin = "round";
  pen.beginPath();
  let pause = true;
  values.forEach((value, k) => {
    if (isNaN(value)) return (pause = true);
    pause ? pen.moveTo(x(time[k]), y(value)) : pen.lineTo(x(time[k]), y(value));
    pause = false;
  });
  pen.stroke();
  const now = Math.min(Math.max(state.when.time, begin), end);
  pen.strokeStyle = ink("--now");
  pen.beginPath();
  pen.moveTo(x(now), 18);
  pen.lineTo(x(now), tall - 20);
  pen.stroke();
}

function pin(found) {
  if (state.pinned?.body) state.pinned.body.mark(false);
  state.pinned = found;
  $("history").hidden = !found;
  if (found?.body) found.body.mark(true);
  $("spot").hidden = !found?.tube;
  state.dirty = true;
  if (found) plot();
}

/** A ring around the point of a line that is picked. */
function spot() {
  const found = state.pinned;
  if (!found?.tube) return;
  const at = projected(new THREE.Vector3().fromArray(found.tube.at, 3 * found.point));
  $("spot").style.transform = `translate(${at.x.toFixed(1)}px, ${at.y.toFixed(1)}px)`;
}

// ---------------------------------------------------------------- what is pressed

const space = $("space");
let pressed = null;
space.addEventListener("pointerdown", (event) => (pressed = [event.clientX, event.clientY]));
space.addEventListener("pointerup", (event) => {
  if (!pressed || Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) > 5) return;
  const found = found_at(event.clientX, event.clientY, event.pointerType === "mouse" ? 10 : 24);
  if (found) pin(found);
});
space.addEventListener("pointermove", (event) => event.pointerType === "mouse" && hover(event));
space.addEventListener("pointerleave", leave);
$("close").addEventListener("click", () => pin(null));
$("play").addEventListener("click", () => play(!state.playing));
$("slider").addEventListener("input", () => (play(false), show(Number($("slider").value))));
$("speed").addEventListener("change", () => (state.speed = Number($("speed").value)));
$("quantity").addEventListener("change", () => paint($("quantity").value));
$("reset").addEventListener("click", fit);
$("go").addEventListener("change", () => {
  const body = bodies[Number($("go").value)];
  if ($("go").value === "" || !body) return fit();
  pin({ body });
  approach(body);
});
$("curve").addEventListener("pointerdown", (event) => {
  if (!axes) return;
  play(false);
  const share = (event.offsetX - axes.left) / (axes.wide - axes.left - 8);
  show(Math.round(place_of(axes.begin + share * (axes.end - axes.begin))));
});
$("theme").addEventListener("click", turn_theme);
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", theme);
still.addEventListener("change", () => (controls.enableDamping = !still.matches));

function turn_theme() {
  document.documentElement.dataset.theme = state.dark ? "light" : "dark";
  theme();
}
$("about").addEventListener("click", () => ($("help").hidden = !$("help").hidden));
$("help").addEventListener("click", () => ($("help").hidden = true));
addEventListener("resize", resize);
// What is written above the picture grows and shrinks: the picture keeps clear of it.
new ResizeObserver(resize).observe(document.querySelector("header"));
new ResizeObserver(resize).observe($("legend"));
addEventListener("hashchange", address);

const KEYS = {
  " ": () => play(!state.playing),
  ArrowRight: (ten) => (play(false), show(Math.floor(state.when.at + 1e-9) + (ten ? 10 : 1))),
  ArrowLeft: (ten) => (play(false), show(Math.ceil(state.when.at - 1e-9) - (ten ? 10 : 1))),
  Home: () => (play(false), show(0)),
  End: () => (play(false), show(frames - 1)),
  "+": () => faster(1),
  "=": () => faster(1),
  "-": () => faster(-1),
  q: () => {
    if (!state.pinned) return;
    const found = known(state.pinned);
    const { numbers } = found;
    if (numbers.length) state.shown = numbers[(numbers.indexOf(chosen(found)) + 1) % numbers.length].name;
    plot();
  },
  f: () => {
    if (state.pinned?.body) approach(state.pinned.body);
    else if (state.pinned) {
      const at = new THREE.Vector3().fromArray(state.pinned.tube.at, 3 * state.pinned.point);
      const back = new THREE.Vector3().subVectors(camera.position, controls.target).multiplyScalar(0.25);
      controls.target.copy(at);
      camera.position.copy(at).add(back);
      state.moved = true;
      leave();
    }
  },
  d: turn_theme,
  r: fit,
  h: () => ($("help").hidden = !$("help").hidden),
  Escape: () => (($("help").hidden = true), pin(null)),
};

/** Choose the next speed, or the one before. */
function faster(by) {
  const one = $("speed");
  one.selectedIndex = Math.min(Math.max(one.selectedIndex + by, 0), one.options.length - 1);
  state.speed = Number(one.value);
}

// A button that was clicked would take the space bar, which plays.
addEventListener("click", (event) => event.detail > 0 && event.target.closest?.("button")?.blur());

addEventListener("keydown", (event) => {
  const act = KEYS[event.key];
  const own = event.target.tagName === "SELECT" || (event.target.tagName === "BUTTON" && event.key === " ");
  if (!act || own || event.ctrlKey || event.metaKey || event.altKey) return;
  event.preventDefault();
  act(event.shiftKey);
});

/**
 * What the address asks for: #frame=3, #t=12.5 (there, if need be between two pictures), #colour=tension, #line=1&node=7,
 * #thing=payload, #go=payload, #theme=dark, #play.
 */
function address() {
  const asked = new URLSearchParams(location.hash.slice(1));
  if (asked.has("colour")) paint(asked.get("colour"));
  if (asked.has("frame")) show(Number(asked.get("frame")) || 0);
  if (asked.has("t")) show(place_of(Number(asked.get("t")) || 0));
  if (asked.has("theme")) document.documentElement.dataset.theme = asked.get("theme");
  theme();
  const body = bodies.find((one) => one.name === (asked.get("go") ?? asked.get("thing")));
  if (body) pin({ body });
  if (body && asked.has("go")) approach(body);
  const tube = tubes[Number(asked.get("line") ?? 1) - 1];
  const node = Number(asked.get("node"));
  if (tube && node >= 1 && node <= tube.nodes.length) pin({ tube, point: tube.nodes[node - 1], node });
  if (asked.has("play")) play(true);
}

// ---------------------------------------------------------------- begin

const SLOW = 45; // ms from one picture to the next from which fewer pixels are drawn while things move
const LEAST_DENSITY = 0.5;
let drawn = 0;
let slow = 0;
let rest = 0;
const pace = { pictures: 0, seconds: 0 };
function draw(now) {
  const seconds = Math.min((now - drawn) / 1000, 0.25);
  // Fewer pixels after some slow pictures one after the other; all of them when nothing has moved for a while.
  slow = state.playing && 1000 * seconds > SLOW ? slow + 1 : 0;
  if (slow > 4 && density.share > LEAST_DENSITY) [slow] = [0, set_density(Math.max(0.7 * density.share, LEAST_DENSITY))];
  rest = state.playing || state.dirty ? 0 : rest + 1;
  if (rest === 10 && density.share < 1) set_density(1);
  drawn = now;
  if (state.playing) {
    advance(seconds);
    pace.pictures += 1;
    pace.seconds += seconds;
  }
  controls.update();
  if (state.dirty) {
    state.dirty = false;
    const away = camera.position.distanceTo(controls.target);
    [camera.near, camera.far] = [Math.max(0.003 * away, away - 3 * page.size), away + 2 * FAR * page.size];
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
    sky.look(camera);
    renderer.render(scene, camera);
    letter();
    compass();
    scale_bar();
    confess();
    spot();
    document.body.dataset.ready = "1";
  }
  requestAnimationFrame(draw);
}

$("slider").max = frames - 1;
document.body.dataset.frames = frames;
if (frames < 2) document.querySelectorAll("#play, #slider, #speed").forEach((element) => (element.hidden = true));
for (const [k, body] of bodies.entries()) if (body.histories.length) made("option", $("go"), body.name).value = k;
$("go").hidden = $("go").options.length < 2;
speeds();
legend();
paint(page.colour);
theme();
resize();
address();
requestAnimationFrame(draw);

/** For scripts and tests: what is shown, where a point of a line is on the page, px, and what would be picked there. */
globalThis.tautline = {
  state, page, pace, show, play, paint, camera, controls,
  place: (line, point) => projected(new THREE.Vector3().fromArray(tubes[line].at, 3 * point)).toArray(),
  middle: (name) => projected(corners(bodies.find((one) => one.name === name)).reduce((sum, at) => sum.add(new THREE.Vector3(...at)), new THREE.Vector3()).divideScalar(8)).toArray(),
  point: (line, point) => [0, 1, 2].map((c) => tubes[line].at[3 * point + c]),
  pose: (name) => bodies.find((one) => one.name === name).mesh.matrix.elements.slice(),
  picked: (x, y) => { const found = found_at(x, y, 10); return found && told(found, false); },
  history: () => { const found = known(state.pinned); const { time } = found; const one = chosen(found); return { time, name: one.name, unit: one.unit, written: time.map((_, k) => written(one.at(k), one.digits)) }; },
  surface: (x, y) => planes.find((one) => one.sea).nearest(x, y),
  elevation: (x, y, time) => planes.find((one) => one.sea).sea.elevation(x, y, time),
};
