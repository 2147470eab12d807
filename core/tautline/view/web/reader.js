"use strict";
// What a reader asks: values under the pointer and their history, keys, the address; and the beginning of it all.

// ---------------------------------------------------------------- what is under the pointer

/** The line within reach of a place on the page, px, and its node (or point) there. */
function picked(x, y, reach) {
  let best = null;
  const at = new THREE.Vector3();
  for (const tube of tubes) {
    if (tube.spec.hollow && !Object.keys(tube.tracks).length) continue;
    let before = null;
    for (let k = 0; k < tube.count; k++) {
      const here = projected(at.fromArray(tube.at, 3 * k));
      if (before && here.z < 1 && before.z < 1) {
        const [dx, dy] = [here.x - before.x, here.y - before.y];
        const share = Math.min(Math.max(((x - before.x) * dx + (y - before.y) * dy) / (dx * dx + dy * dy || 1), 0), 1);
        const off = Math.hypot(x - before.x - share * dx, y - before.y - share * dy);
        if (off < (best ? best.off : reach)) best = { tube, off, point: k - 1 + share };
      }
      before = here;
    }
  }
  if (!best) return null;
  const { tube, point } = best;
  if (!tube.nodes.length) return { tube, point: Math.round(point), node: null };
  const nearest = tube.nodes.reduce((a, b, k) => (Math.abs(b - point) < Math.abs(tube.nodes[a] - point) ? k : a), 0);
  return { tube, point: tube.nodes[nearest], node: nearest + 1 };
}

/** What is known of a pick now, and every quantity of it for a pinned one. */
function told({ tube, point, node }, all) {
  const rows = [node === null ? tube.name : `${tube.name}, node ${node}`];
  for (const one of page.quantities) {
    if (!tube.tracks[one.name] || (!all && state.quantity && one !== state.quantity)) continue;
    const value = tube.tracks[one.name].value(state.frame, point) / one.factor;
    rows.push(`${one.text} ${isNaN(value) ? "unknown" : `${tidy(value, one.high - one.low)} ${one.unit}`.trim()}`);
  }
  return rows.join("\n");
}

const ray = new THREE.Raycaster();

/** Name of the body under a place on the page. */
function named(x, y) {
  ray.setFromCamera(new THREE.Vector2((2 * x) / innerWidth - 1, 1 - (2 * y) / innerHeight), camera);
  const hits = ray.intersectObjects(bodies.map((body) => body.mesh));
  return hits.length ? hits[0].object.name : "";
}

function hover(event) {
  const found = event.buttons ? null : picked(event.clientX, event.clientY, 10);
  const text = event.buttons ? "" : found ? told(found, false) : named(event.clientX, event.clientY);
  state.hovered = found;
  $("tip").hidden = !text;
  $("tip").textContent = text;
  const left = Math.min(event.clientX + 14, innerWidth - $("tip").offsetWidth - 8);
  const top = event.clientY + 18 + $("tip").offsetHeight > innerHeight ? event.clientY - 12 - $("tip").offsetHeight : event.clientY + 18;
  $("tip").style.transform = `translate(${left}px, ${top}px)`;
}

/** History of the picked point: of the quantity that colours, else of the first that the line has. */
function plot() {
  const { tube, point } = state.pinned;
  const shown = tube.quantity ?? page.quantities.find((one) => tube.tracks[one.name]);
  $("picked").textContent = told(state.pinned, innerWidth > 700);
  $("curve").hidden = !shown || frames < 2;
  if ($("curve").hidden) return;
  const canvas = $("curve");
  const [wide, high, scale] = [canvas.clientWidth, canvas.clientHeight, devicePixelRatio];
  [canvas.width, canvas.height] = [wide * scale, high * scale];
  const pen = canvas.getContext("2d");
  pen.scale(scale, scale);
  pen.font = "11px sans-serif";
  const values = page.time.map((_, frame) => tube.tracks[shown.name].value(frame, point) / shown.factor);
  const known = values.filter((value) => !isNaN(value));
  let [low, high_] = [Math.min(...known), Math.max(...known)];
  const least = 1e-3 * (shown.high - shown.low);
  if (high_ - low < least) [low, high_] = [0.5 * (low + high_ - least), 0.5 * (low + high_ + least)];
  const names = [low, high_].map((value) => tidy(value, Math.max(high_ - low, 0.01 * Math.abs(high_ + low))));
  const left = Math.max(...names.map((name) => pen.measureText(name).width)) + 8;
  const [first, last] = [page.time[0], page.time[frames - 1]];
  const x = (time) => left + ((wide - left - 6) * (time - first)) / (last - first || 1);
  const y = (value) => high - 20 - ((high - 42) * (value - low)) / (high_ - low);
  pen.fillStyle = "#4a4f55";
  pen.fillText(`${shown.title} over time [s]`, left, 11);
  pen.textAlign = "right";
  names.forEach((name, k) => pen.fillText(name, left - 6, y([low, high_][k]) + 4));
  pen.fillText(Number(last.toPrecision(6)), wide - 4, high - 5);
  pen.textAlign = "left";
  pen.fillText(Number(first.toPrecision(6)), left, high - 5);
  pen.strokeStyle = "#c3cad1";
  pen.strokeRect(left, y(high_), wide - left - 6, y(low) - y(high_));
  pen.strokeStyle = "#b3352b";
  pen.beginPath();
  pen.moveTo(x(page.time[state.frame]), y(low));
  pen.lineTo(x(page.time[state.frame]), y(high_));
  pen.stroke();
  pen.strokeStyle = "#2f6f9f";
  pen.lineWidth = 1.5;
  pen.beginPath();
  values.forEach((value, k) => (k && !isNaN(values[k - 1]) ? pen.lineTo(x(page.time[k]), y(value)) : pen.moveTo(x(page.time[k]), y(value))));
  pen.stroke();
}

function pin(found) {
  state.pinned = found;
  $("history").hidden = !found;
  if (found) plot();
}

// ---------------------------------------------------------------- what is pressed

const space = $("space");
let pressed = null;
space.addEventListener("pointerdown", (event) => (pressed = [event.clientX, event.clientY]));
space.addEventListener("pointerup", (event) => {
  if (!pressed || Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) > 5) return;
  const found = picked(event.clientX, event.clientY, event.pointerType === "mouse" ? 10 : 24);
  if (found) pin(found);
});
space.addEventListener("pointermove", (event) => event.pointerType === "mouse" && hover(event));
space.addEventListener("pointerleave", () => (($("tip").hidden = true), (state.hovered = null)));
$("close").addEventListener("click", () => pin(null));
$("play").addEventListener("click", () => play(!state.playing));
$("slider").addEventListener("input", () => (play(false), show(Number($("slider").value))));
$("speed").addEventListener("change", () => (state.speed = Number($("speed").value)));
$("quantity").addEventListener("change", () => paint($("quantity").value));
$("reset").addEventListener("click", fit);
$("about").addEventListener("click", () => ($("help").hidden = !$("help").hidden));
$("help").addEventListener("click", () => ($("help").hidden = true));
addEventListener("resize", resize);
// What is written above the picture grows and shrinks: the picture keeps clear of it.
new ResizeObserver(resize).observe(document.querySelector("header"));
new ResizeObserver(resize).observe($("legend"));
addEventListener("hashchange", address);

const KEYS = {
  " ": () => play(!state.playing),
  ArrowRight: (ten) => (play(false), show(state.frame + (ten ? 10 : 1))),
  ArrowLeft: (ten) => (play(false), show(state.frame - (ten ? 10 : 1))),
  Home: () => (play(false), show(0)),
  End: () => (play(false), show(frames - 1)),
  r: fit,
  h: () => ($("help").hidden = !$("help").hidden),
  Escape: () => (($("help").hidden = true), pin(null)),
};
addEventListener("keydown", (event) => {
  const act = KEYS[event.key];
  const own = event.target.tagName === "SELECT" || (event.target.tagName === "BUTTON" && event.key === " ");
  if (!act || own || event.ctrlKey || event.metaKey || event.altKey) return;
  event.preventDefault();
  act(event.shiftKey);
});

/** What the address asks for: #frame=3, #t=12.5 (the last frame by then), #colour=tension, #line=1&node=7, #play. */
function address() {
  const asked = new URLSearchParams(location.hash.slice(1));
  if (asked.has("colour")) paint(asked.get("colour"));
  if (asked.has("frame")) show(Number(asked.get("frame")) || 0);
  if (asked.has("t")) show(Math.max(page.time.findLastIndex((time) => time <= Number(asked.get("t")) + 1e-9), 0));
  const tube = tubes[Number(asked.get("line") ?? 1) - 1];
  const node = Number(asked.get("node"));
  if (tube && node >= 1 && node <= tube.nodes.length) pin({ tube, point: tube.nodes[node - 1], node });
  if (asked.has("play")) play(true);
}

// ---------------------------------------------------------------- begin

let drawn = 0;
function draw(now) {
  const seconds = Math.min((now - drawn) / 1000, 0.25);
  drawn = now;
  if (state.playing) advance(seconds);
  controls.update();
  if (state.dirty) {
    state.dirty = false;
    const away = camera.position.distanceTo(controls.target);
    [camera.near, camera.far] = [Math.max(0.003 * away, away - 3 * page.size), away + 6 * page.size];
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
    renderer.render(scene, camera);
    letter();
    compass();
    confess();
    document.body.dataset.ready = "1";
  }
  requestAnimationFrame(draw);
}

$("slider").max = frames - 1;
document.body.dataset.frames = frames;
if (frames < 2) document.querySelectorAll("#play, #slider, #speed").forEach((element) => (element.hidden = true));
speeds();
legend();
paint(page.colour);
address();
resize();
requestAnimationFrame(draw);

/** For scripts and tests: where a point of a line is on the page, px, and what would be picked there. */
globalThis.tautline = {
  state, show, play, paint,
  place: (line, point) => projected(new THREE.Vector3().fromArray(tubes[line].at, 3 * point)).toArray(),
  picked: (x, y) => { const found = picked(x, y, 10); return found && told(found, false); },
};
