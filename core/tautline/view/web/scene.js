"use strict";
// What stands in space. Everything is built once; `show` moves it to a moment: at a picture, or between two.
// Lengths are in m from the picture's middle, z up; colours are sRGB.

const SIDES = 14;
const LEAST = 3; // px, of lines that are made thick enough to see
const STRIDE = 11; // floats of a ring: middle, two normals, radius, share of the legend
const UNKNOWN = 65535;
const [NORMAL, CUSTOM, DARKER, ONE] = [1, 5, 103, 201]; // how pixels are blended, in the library's numbers

/** The bytes of the page's data: base64 of a zlib stream. */
function inflated(text) {
  const letters = atob(text.trim());
  const bytes = new Uint8Array(letters.length);
  for (let k = 0; k < letters.length; k++) bytes[k] = letters.charCodeAt(k);
  return THREE.unzlibSync(bytes);
}

/** Integers of either sign, stored as bytes of rising weight, all of one weight after the other. */
function* integers(bytes, at, count, weights) {
  for (let k = 0; k < count; k++) {
    let unsigned = 0;
    for (let weight = 0; weight < weights; weight++) unsigned |= bytes[at + weight * count + k] << (8 * weight);
    yield (unsigned >>> 1) ^ -(unsigned & 1);
  }
}

/**
 * A moment between pictures: the picture before it, the share of the way to the next one, and the weights with which
 * four pictures make up what is seen: a cubic through both whose slopes are those of parabolas through three pictures.
 */
class Moment {
  constructor(at, time) {
    const last = time.length - 1;
    this.at = Math.min(Math.max(at, 0), last);
    this.before = Math.min(Math.floor(this.at), Math.max(last - 1, 0));
    this.share = last ? this.at - this.before : 0;
    this.nearest = Math.round(this.at);
    this.between = this.share > 1e-9 && this.share < 1 - 1e-9;
    const [i, f] = [this.before, this.share];
    this.time = last ? time[i] + f * (time[i + 1] - time[i]) : time[0];
    this.rows = [Math.max(i - 1, 0), i, Math.min(i + 1, last), Math.min(i + 2, last)];
    if (!this.between) {
      this.rows.fill(this.nearest);
      this.weights = [0, 1, 0, 0];
      return;
    }
    const h = time[i + 1] - time[i];
    const [h0, h2] = [time[i] - time[this.rows[0]], time[this.rows[3]] - time[i + 1]];
    // Slopes at both ends, times h, as weights of the four pictures.
    let first = h0 > 0 && [-(h * h) / (h0 * (h0 + h)), (h - h0) / h0, h0 / (h0 + h), 0];
    let second = h2 > 0 && [0, -h2 / (h + h2), (h2 - h) / h2, (h * h) / (h2 * (h + h2))];
    const chord = [0, -1, 1, 0];
    // At the first and the last picture the parabola is that of the other end.
    if (!first) first = second ? chord.map((c, k) => 2 * c - second[k]) : chord;
    if (!second) second = chord.map((c, k) => 2 * c - first[k]);
    const [a, b] = [f * (1 - f) * (1 - f), f * f * (f - 1)];
    const to = f * f * (3 - 2 * f);
    this.weights = first.map((one, k) => a * one + b * second[k] + [0, 1 - to, to, 0][k]);
  }
}

/**
 * Rows of numbers, one for each picture (or one that holds for all). Stored are the middles, and the steps of each
 * column in all rows as differences, modulo 65536, from the row before and from the same coordinate of the point before.
 * Middles are float32; or, where numbers are decimal ones of so many `digits`, float64 that count steps of the last digit.
 */
class Track {
  constructor(spec, bytes) {
    const { at, rows, width, stride, digits } = spec;
    this.decimal = digits !== undefined;
    this.scale = this.decimal ? 10 ** Math.abs(digits) : 1;
    this.step = this.decimal ? 10 ** -digits : spec.step;
    Object.assign(this, { rows, width, digits });
    const size = this.decimal ? 8 : 4;
    const middles = bytes.slice(at, at + size * width).buffer;
    this.middles = this.decimal ? new Float64Array(middles) : new Float32Array(middles);
    const steps = (this.steps = new Uint16Array(rows * width));
    const changes = integers(bytes, at + size * width, steps.length, 2);
    for (let k = 0; k < width; k++) {
      let along = 0;
      for (let row = 0; row < rows; row++) {
        along += changes.next().value;
        steps[row * width + k] = along + (k < stride ? 0 : steps[row * width + k - stride]);
      }
    }
  }

  /** Number `k` of a row; NaN where there is none. */
  value(row, k) {
    const steps = this.steps[(this.rows === 1 ? 0 : row) * this.width + k];
    if (steps === UNKNOWN) return NaN;
    if (!this.decimal) return this.middles[k] + this.step * (steps - 32767);
    const count = this.middles[k] + (steps - 32767);
    // Divided by a power of ten, so that it is the number nearest to its decimal digits.
    return this.digits < 0 ? count * this.scale : count / this.scale;
  }

  /** Number `k` at a moment, on a straight line between two pictures. */
  linear(when, k) {
    if (!when.between) return this.value(when.nearest, k);
    return (1 - when.share) * this.value(when.before, k) + when.share * this.value(when.before + 1, k);
  }

  /** All numbers at a moment, on cubics between pictures. */
  read(when, into) {
    const { width, rows } = this;
    if (rows === 1 || !when.between) {
      const row = when.nearest;
      for (let k = 0; k < width; k++) into[k] = this.value(row, k);
      return into;
    }
    const [a, b, c, d] = when.weights;
    const [i, j, l, m] = when.rows.map((row) => row * width);
    for (let k = 0; k < width; k++) {
      const [p, q, r, s] = [this.steps[i + k], this.steps[j + k], this.steps[l + k], this.steps[m + k]];
      // The weights sum to one, so that middles need not be weighed.
      const steps = q === UNKNOWN || r === UNKNOWN ? NaN : a * (p === UNKNOWN ? q : p) + b * q + c * r + d * (s === UNKNOWN ? r : s);
      into[k] = this.middles[k] + this.step * (steps - 32767);
    }
    return into;
  }
}

const TUBE_VERTEX = `
  attribute vec3 corner; // cosine and sine about the line, and which end of a piece
  attribute vec3 fromMiddle, toMiddle, fromU, toU, fromV, toV;
  attribute vec2 fromLook, toLook;
  uniform float least, factor, height;
  varying vec3 outward, seen;
  varying float share;
  void main() {
    vec2 look = corner.z < 0.5 ? fromLook : toLook;
    vec3 u = corner.z < 0.5 ? fromU : toU, v = corner.z < 0.5 ? fromV : toV;
    vec4 eye = modelViewMatrix * vec4(corner.z < 0.5 ? fromMiddle : toMiddle, 1.0);
    float pixel = -eye.z * 2.0 / (projectionMatrix[1][1] * height);
    float radius = look.x < 0.0 ? 0.0 : max(look.x * factor, 0.5 * least * pixel);
    outward = mat3(modelViewMatrix) * (corner.x * u + corner.y * v);
    eye.xyz += radius * outward;
    seen = eye.xyz;
    share = look.y;
    gl_Position = projectionMatrix * eye;
  }`;

const TUBE_FRAGMENT = `
  uniform vec3 plain;
  uniform sampler2D table;
  uniform float opacity;
  uniform bool hollow;
  varying vec3 outward, seen;
  varying float share;
  void main() {
    vec3 normal = normalize(outward);
    vec3 colour = share < -0.01 ? plain : texture2D(table, vec2((0.5 + 255.0 * clamp(share, 0.0, 1.0)) / 256.0, 0.5)).rgb;
    if (hollow) {
      // A pipe's far side is pale, and darker where it turns towards the edge, which draws its outline.
      float square = abs(dot(normal, normalize(seen)));
      colour = mix(mix(colour, vec3(1.0), 0.15), mix(colour, vec3(1.0), 0.6), smoothstep(0.1, 0.6, square));
    } else {
      float light = max(dot(normal, normalize(vec3(-0.3, 0.6, 0.75))), 0.0);
      colour = colour * (0.72 + 0.3 * light) + 0.10 * pow(light, 24.0);
    }
    gl_FragColor = vec4(colour, opacity);
  }`;

const PLAIN_VERTEX = `
  attribute float crest;
  uniform float size;
  varying vec3 place;
  varying vec2 reach;
  void main() {
    vec4 at = modelMatrix * vec4(position.xy, crest, 1.0);
    place = at.xyz;
    reach = position.xy / size;
    gl_Position = projectionMatrix * viewMatrix * at;
  }`;

const GROUND_FRAGMENT = `
  uniform vec3 plain, line, haze;
  uniform float opacity, pitch, grid;
  varying vec3 place;
  varying vec2 reach;
  void main() {
    float share = clamp((1.0 - dot(reach, reach)) * 1.1, 0.0, 1.0);
    float faded = share * share * share;
    vec2 at = place.xy / pitch;
    vec2 wide = fwidth(at);
    vec2 off = abs(fract(at - 0.5) - 0.5) / wide;
    // Every fifth line is stronger. Where lines come closer than pixels they fade.
    vec2 fifth = step(abs(mod(floor(at + 0.5) + 2.5, 5.0) - 2.5), vec2(0.1));
    vec2 drawn = clamp(1.4 - 1.4 * off, 0.0, 1.0) * mix(0.16 * clamp(1.3 - 3.5 * wide, 0.0, 1.0), 0.3 * clamp(1.3 - 0.7 * wide, 0.0, 1.0), fifth);
    vec3 colour = mix(plain, line, grid * max(drawn.x, drawn.y));
    gl_FragColor = vec4(mix(haze, colour, faded), opacity * min(3.0 * faded, 1.0));
  }`;

const WATER_FRAGMENT = `
  uniform vec3 plain, haze, sun;
  uniform float opacity;
  varying vec3 place;
  varying vec2 reach;
  void main() {
    float share = clamp((1.0 - dot(reach, reach)) * 1.1, 0.0, 1.0);
    float faded = share * share * share;
    vec3 normal = normalize(cross(dFdx(place), dFdy(place)));
    normal *= sign(normal.z + 1e-6);
    // The flatter one looks on water the more of the sky it shows, and the less of what is below.
    float flat_ = 1.0 - abs(dot(normal, normalize(cameraPosition - place)));
    float mirror = flat_ * flat_ * flat_ * flat_;
    // What leans to the sun is brighter, more than in nature, so that waves are seen.
    float light = clamp(1.0 + 4.0 * (dot(normal, sun) - sun.z), 0.6, 1.4);
    vec3 colour = mix(plain * light, haze * (0.5 + 0.5 * light), 0.6 * mirror);
    gl_FragColor = vec4(mix(haze, colour, faded), mix(opacity, 0.97, mirror) * min(3.0 * faded, 1.0));
  }`;

const SKY_VERTEX = `
  uniform mat4 back;
  varying vec3 way;
  void main() {
    vec4 far = back * vec4(position.xy, 1.0, 1.0);
    way = far.xyz / far.w - cameraPosition;
    gl_Position = vec4(position.xy, 1.0, 1.0);
  }`;

const SKY_FRAGMENT = `
  uniform vec3 zenith, horizon, nadir;
  varying vec3 way;
  void main() {
    float up = normalize(way).z;
    vec3 colour = up > 0.0 ? mix(horizon, zenith, min(2.0 * up, 1.0)) : mix(horizon, nadir, smoothstep(0.0, 0.4, -up));
    gl_FragColor = vec4(colour, 1.0);
  }`;

const SHADE_FRAGMENT = `
  uniform vec3 middle, shade;
  uniform float reach;
  varying vec3 place;
  varying float high;
  void main() {
    if (high < 0.0) discard;
    gl_FragColor = vec4(mix(shade, vec3(1.0), smoothstep(0.4, 1.0, length(place.xy - middle.xy) / reach)), 1.0);
  }`;

const SHADE_BODY = `
  uniform vec3 sun;
  uniform float level;
  varying vec3 place;
  varying float high;
  void main() {
    vec4 at = modelMatrix * vec4(position, 1.0);
    high = at.z - level;
    place = at.xyz - sun * (high / sun.z);
    gl_Position = projectionMatrix * viewMatrix * vec4(place, 1.0);
  }`;

/** The shadow of a tube on a level: as wide as the tube, flat. */
const SHADE_TUBE = `
  attribute vec3 corner;
  attribute vec3 fromMiddle, toMiddle;
  attribute vec3 fromU, toU, fromV, toV;
  attribute vec2 fromLook, toLook;
  uniform vec3 sun;
  uniform float level, least, factor, height;
  varying vec3 place;
  varying float high;
  void main() {
    vec2 look = corner.z < 0.5 ? fromLook : toLook;
    vec3 middle = corner.z < 0.5 ? fromMiddle : toMiddle;
    vec3 u = corner.z < 0.5 ? fromU : toU, v = corner.z < 0.5 ? fromV : toV;
    high = middle.z - level;
    float pixel = -(modelViewMatrix * vec4(middle, 1.0)).z * 2.0 / (projectionMatrix[1][1] * height);
    float radius = look.x < 0.0 ? 0.0 : max(look.x * factor, 0.5 * least * pixel);
    vec3 at = middle + radius * (corner.x * u + corner.y * v);
    place = at - sun * ((at.z - level) / sun.z);
    gl_Position = projectionMatrix * viewMatrix * vec4(place, 1.0);
  }`;

/** Red, green, blue from 0 to 1 of "#RRGGBB". */
const rgb = (colour) => new THREE.Vector3(...[1, 3, 5].map((k) => parseInt(colour.slice(k, k + 2), 16) / 255));

/** 1, 2 or 5 times a power of ten, at most so much. */
function round(most) {
  const power = 10 ** Math.floor(Math.log10(most));
  return [5, 2, 1].find((digit) => digit * power <= most * 1.000001) * power;
}

/** The same of a length, m, which is round in the unit of lengths of the page. */
function round_length(most) {
  return round(most / page.length.metres) * page.length.metres;
}

/** Colours of a quantity, "rrggbb..." of 256, as a texture. */
function texture(table) {
  const bytes = new Uint8Array(4 * 256).fill(255);
  for (let k = 0; k < 256; k++) {
    for (let c = 0; c < 3; c++) bytes[4 * k + c] = parseInt(table.slice(6 * k + 2 * c, 6 * k + 2 * c + 2), 16);
  }
  const made = new THREE.DataTexture(bytes, 256, 1);
  made.magFilter = made.minFilter = THREE.LinearFilter;
  made.needsUpdate = true;
  return made;
}

/** A tube along the points of a line: one instance of a piece of tube between each ring and the next. */
class Tube {
  constructor(spec, bytes, factor) {
    Object.assign(this, { spec, name: spec.name, nodes: spec.nodes, quantity: null });
    this.points = new Track(spec.points, bytes);
    this.count = spec.points.width / 3;
    this.at = new Float32Array(spec.points.width);
    this.tracks = Object.fromEntries(Object.entries(spec.quantities).map(([name, one]) => [name, new Track(one, bytes)]));
    const end = spec.hollow ? 0 : 1; // A closed end is a ring without radius.
    this.first = end;
    this.rings = new Float32Array((this.count + 2 * end) * STRIDE);
    this.geometry = this.pieces();
    const thick = spec.thick && factor === null;
    this.material = new THREE.ShaderMaterial({
      vertexShader: TUBE_VERTEX,
      fragmentShader: TUBE_FRAGMENT,
      side: spec.hollow ? THREE.BackSide : THREE.FrontSide,
      transparent: spec.opacity < 1,
      depthWrite: spec.opacity === 1,
      uniforms: {
        plain: { value: rgb(spec.colour) }, table: { value: null }, opacity: { value: spec.opacity },
        hollow: { value: spec.hollow }, height: { value: 1 },
        least: { value: thick ? LEAST : spec.thick && !this.radius(0) ? LEAST : 0 },
        factor: { value: spec.thick && factor !== null ? factor : 1 },
      },
    });
    this.mesh = new THREE.Mesh(this.geometry, this.material);
    this.mesh.frustumCulled = false;
  }

  radius(k) {
    return Array.isArray(this.spec.radius) ? this.spec.radius[k] : this.spec.radius;
  }

  pieces() {
    const corners = [];
    const faces = [];
    for (let k = 0; k < SIDES; k++) {
      const angle = (2 * Math.PI * k) / SIDES;
      for (const end of [0, 1]) corners.push(Math.cos(angle), Math.sin(angle), end);
      const [a, b] = [2 * k, 2 * ((k + 1) % SIDES)];
      faces.push(a, b, b + 1, a, b + 1, a + 1);
    }
    const made = new THREE.InstancedBufferGeometry();
    made.setAttribute("corner", new THREE.BufferAttribute(new Float32Array(corners), 3));
    made.setIndex(faces);
    this.buffer = new THREE.InstancedInterleavedBuffer(this.rings, STRIDE, 1);
    const parts = { Middle: [3, 0], U: [3, 3], V: [3, 6], Look: [2, 9] };
    for (const [part, [size, offset]] of Object.entries(parts)) {
      made.setAttribute("from" + part, new THREE.InterleavedBufferAttribute(this.buffer, size, offset));
      made.setAttribute("to" + part, new THREE.InterleavedBufferAttribute(this.buffer, size, offset + STRIDE));
    }
    made.instanceCount = this.rings.length / STRIDE - 1;
    return made;
  }

  /** Colour it by a quantity of the page, or plainly. */
  paint(quantity, table) {
    this.quantity = quantity && this.tracks[quantity.name] ? quantity : null;
    this.material.uniforms.table.value = table;
  }

  show(when) {
    this.points.read(when, this.at);
    this.place();
    const shown = this.quantity;
    const track = shown && this.tracks[shown.name];
    for (let k = 0; k < this.count; k++) {
      let share = -1;
      if (track) {
        const value = track.linear(when, k);
        share = isNaN(value) ? -1 : Math.min(Math.max((value - shown.low) / (shown.high - shown.low), 0), 1);
      }
      const start = (this.first + k) * STRIDE;
      this.rings[start + 9] = this.radius(k);
      this.rings[start + 10] = share;
    }
    this.close();
    this.buffer.needsUpdate = true;
  }

  /** Rings across the line, each turned from the one before by no more than the line turns. */
  place() {
    const { at, rings, count } = this;
    let [tx, ty, tz] = this.direction(0, [0, 0, 1]);
    let u = Math.abs(tx) < 0.6 ? [1, 0, 0] : [0, 1, 0];
    for (let k = 0; k < count; k++) {
      [tx, ty, tz] = this.direction(k, [tx, ty, tz]);
      const along = u[0] * tx + u[1] * ty + u[2] * tz;
      let [x, y, z] = [u[0] - along * tx, u[1] - along * ty, u[2] - along * tz];
      let size = Math.hypot(x, y, z);
      if (size < 1e-6) [x, y, z, size] = Math.abs(tx) < 0.6 ? [0, tz, -ty, Math.hypot(ty, tz)] : [-tz, 0, tx, Math.hypot(tx, tz)];
      u = [x / size, y / size, z / size];
      const start = (this.first + k) * STRIDE;
      for (let c = 0; c < 3; c++) {
        rings[start + c] = at[3 * k + c];
        rings[start + 3 + c] = u[c];
      }
      rings[start + 6] = ty * u[2] - tz * u[1];
      rings[start + 7] = tz * u[0] - tx * u[2];
      rings[start + 8] = tx * u[1] - ty * u[0];
    }
  }

  /** Unit tangent at a point, or what is given where the line has none. */
  direction(k, otherwise) {
    const a = 3 * Math.max(k - 1, 0);
    const b = 3 * Math.min(k + 1, this.count - 1);
    const [x, y, z] = [this.at[b] - this.at[a], this.at[b + 1] - this.at[a + 1], this.at[b + 2] - this.at[a + 2]];
    const size = Math.hypot(x, y, z);
    return size > 1e-9 ? [x / size, y / size, z / size] : otherwise;
  }

  close() {
    if (!this.first) return;
    const last = this.rings.length - STRIDE;
    this.rings.copyWithin(0, STRIDE, 2 * STRIDE);
    this.rings.copyWithin(last, last - STRIDE, last);
    this.rings[9] = this.rings[last + 9] = -1;
  }
}

/** A body that moves without changing its shape. */
class Body {
  constructor(spec, bytes) {
    let geometry = new THREE.BufferGeometry();
    const track = new Track(spec.points, bytes);
    const points = Float32Array.from({ length: 3 * track.rows }, (_, k) => track.value(Math.floor(k / 3), k % 3));
    geometry.setAttribute("position", new THREE.BufferAttribute(points, 3));
    const corners = Uint32Array.from(integers(bytes, spec.triangles.at, 3 * spec.triangles.count, 4));
    for (let k = 3; k < corners.length; k++) corners[k] += corners[k - 3];
    geometry.setIndex(new THREE.BufferAttribute(corners, 1));
    if (spec.smooth && spec.size > 0) {
      // The library takes corners within 0.01 for one: a body is made a thousand large for it.
      geometry.scale(1000 / spec.size, 1000 / spec.size, 1000 / spec.size);
      geometry = THREE.toCreasedNormals(geometry, Math.PI / 6);
      geometry.scale(spec.size / 1000, spec.size / 1000, spec.size / 1000);
    }
    const clear = spec.opacity < 1;
    const look = { color: spec.colour, flatShading: !spec.smooth, side: THREE.DoubleSide };
    this.mesh = new THREE.Mesh(
      geometry, new THREE.MeshLambertMaterial({ ...look, opacity: spec.opacity, transparent: clear, depthWrite: !clear }),
    );
    this.mesh.name = spec.name;
    this.mesh.matrixAutoUpdate = false;
    this.spec = spec;
    this.name = spec.name;
    this.turn = new Track(spec.turn, bytes);
    this.place = new Track(spec.place, bytes);
    this.histories = spec.histories.map((one) => ({ ...one, track: new Track(one.values, bytes) }));
    this.p = new Float32Array(3);
    [this.q, this.next, this.matrix] = [new THREE.Quaternion(), new THREE.Quaternion(), new THREE.Matrix4()];
    this.axis = new THREE.Vector3(0, 0, 1);
    this.unit = new THREE.Vector3(1, 1, 1);
  }

  /** Its rotation in a picture. */
  turned(row, into) {
    const r = Array.from({ length: 9 }, (_, k) => this.turn.value(row, k));
    return into.setFromRotationMatrix(this.matrix.set(r[0], r[1], r[2], 0, r[3], r[4], r[5], 0, r[6], r[7], r[8], 0, 0, 0, 0, 1)).normalize();
  }

  /** Between pictures it turns evenly about one axis, by the whole turns that are known too. */
  show(when) {
    this.place.read(when, this.p);
    const still = this.turn.rows === 1 || !when.between;
    this.turned(still ? when.nearest : when.before, this.q);
    if (!still) {
      const change = this.turned(when.before + 1, this.next).premultiply(this.q.clone().invert());
      if (change.w < 0) change.set(-change.x, -change.y, -change.z, -change.w);
      const sine = Math.hypot(change.x, change.y, change.z);
      if (sine > 1e-9) this.axis.set(change.x / sine, change.y / sine, change.z / sine);
      const angle = 2 * Math.atan2(sine, change.w) + 2 * Math.PI * (this.spec.turns[when.before] ?? 0);
      this.q.multiply(change.setFromAxisAngle(this.axis, when.share * angle));
    }
    this.mesh.matrix.compose(new THREE.Vector3(...this.p), this.q, this.unit);
    this.mesh.matrixWorldNeedsUpdate = true;
  }

  /** Make it stand out, or not. */
  mark(on) {
    this.mesh.material.emissive.set(on ? 0x1c2733 : 0);
  }
}

/** Vectors; the longest is a tenth of the picture long. */
class Vectors {
  constructor(spec, bytes, size) {
    Object.assign(this, { spec, length: 0.1 * size, name: spec.name });
    this.points = new Track(spec.points, bytes);
    this.vectors = new Track(spec.vectors, bytes);
    const shaft = new THREE.CylinderGeometry(0.025, 0.025, 0.7, 10).rotateX(Math.PI / 2).translate(0, 0, 0.35);
    const head = new THREE.ConeGeometry(0.075, 0.3, 16).rotateX(Math.PI / 2).translate(0, 0, 0.85);
    // What pushes has its head where it acts, and its tail outside.
    const arrow = THREE.mergeGeometries([shaft, head]).translate(0, 0, spec.pushes ? -1 : 0);
    this.mesh = new THREE.InstancedMesh(arrow, new THREE.MeshLambertMaterial({ color: spec.colour }), spec.points.width / 3);
    this.mesh.name = spec.name;
    this.mesh.frustumCulled = false;
  }

  show(when) {
    const [vector, turn, scale] = [new THREE.Vector3(), new THREE.Quaternion(), new THREE.Vector3()];
    const [up, at, pose] = [new THREE.Vector3(0, 0, 1), new THREE.Vector3(), new THREE.Matrix4()];
    let drawn = 0;
    for (let k = 0; k < this.mesh.instanceMatrix.count; k++) {
      const read = (track) => [0, 1, 2].map((c) => track.linear(when, 3 * k + c));
      vector.fromArray(read(this.vectors));
      const long = (vector.length() / this.spec.longest) * this.length;
      // What the steps of storage leave of a zero is not drawn.
      if (!(vector.length() > Math.max(4 * this.vectors.step, 1e-4 * this.spec.longest))) continue;
      turn.setFromUnitVectors(up, vector.normalize());
      const wide = Math.max(long, 0.4 * this.length);
      this.mesh.setMatrixAt(drawn++, pose.compose(at.fromArray(read(this.points)), turn, scale.set(wide, wide, long)));
    }
    this.mesh.count = drawn;
    this.mesh.instanceMatrix.needsUpdate = true;
    this.mesh.boundingSphere = null;
  }
}

/** Waves as the page holds them: the height of the surface above still water. */
class Sea {
  constructor(spec) {
    Object.assign(this, spec);
  }

  /** Share of its full height that it has: a quintic, as that of every ramp in a scene. */
  grown(time) {
    const share = this.ramp > 0 ? Math.min(Math.max(time / this.ramp, 0), 1) : 1;
    return share ** 3 * (10 - 15 * share + 6 * share * share);
  }

  /** Height at a distance along the waves' direction; those shorter than `least` are left out. */
  along(s, time, least = 0) {
    let sum = 0;
    for (let k = 0; k < this.amplitude.length; k++) {
      if (this.number[k] * least > 2 * Math.PI) continue;
      sum += this.amplitude[k] * Math.sin(this.frequency[k] * time + this.phase[k] - this.number[k] * s);
    }
    return this.grown(time) * sum;
  }

  distance(x, y) {
    return (x - this.origin[0]) * this.direction[0] + (y - this.origin[1]) * this.direction[1];
  }

  elevation(x, y, time) {
    return this.along(this.distance(x, y), time);
  }
}

const FAR = 14; // radius of a level over the size of the picture
const FINE = 50; // parts of a sea from its middle to where its waves end
const AROUND = 10; // and from there to its edge

/** Water, ground or floor: a plane that fades into the haze, with a grid of round pitch or with waves. */
class Plane {
  constructor(spec, size, sun) {
    this.spec = spec;
    this.sea = spec.waves && new Sea(spec.waves);
    // Of deep water a patch of the surface is drawn: one is to see what hangs below it.
    const far = (spec.deep ? 0.5 : FAR) * size;
    // A sea is fine around what is seen, and coarse beyond. Whatever is seen is on waves of their full height.
    const longest = this.sea && 2 * Math.PI / this.sea.number[this.sea.amplitude.reduce((a, b, k, all) => (b > all[a] ? k : a), 0)];
    const near = (this.near = this.sea ? Math.min(0.9 * far, Math.max(Math.min(1.6 * size, 4 * longest), 0.65 * size)) : 0);
    const half = this.sea
      ? [...Array.from({ length: FINE + 1 }, (_, k) => (near * k) / FINE), ...Array.from({ length: AROUND }, (_, k) => near + (far - near) * ((k + 1) / AROUND) ** 2)]
      : [0, far];
    const line = [...half.slice(1).map((x) => -x).reverse(), ...half];
    const n = line.length;
    const places = new Float32Array(3 * n * n);
    const faces = [];
    for (let i = 0; i < n; i++) {
      for (let j = 0; j < n; j++) {
        const at = i * n + j;
        [places[3 * at], places[3 * at + 1]] = [line[j], line[i]];
        if (i + 1 < n && j + 1 < n) faces.push(at, at + 1, at + n + 1, at, at + n + 1, at + n);
      }
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(places, 3));
    geometry.setAttribute("crest", new THREE.BufferAttribute((this.crest = new Float32Array(n * n)), 1));
    geometry.setIndex(faces);
    this.material = new THREE.ShaderMaterial({
      vertexShader: PLAIN_VERTEX, fragmentShader: spec.clear ? WATER_FRAGMENT : GROUND_FRAGMENT, side: THREE.DoubleSide, depthWrite: false,
      transparent: spec.clear, blending: spec.clear ? NORMAL : CUSTOM, // what is not clear is drawn first, and all else over it
      blendSrcAlpha: spec.clear ? null : ONE,
      uniforms: {
        plain: { value: rgb(spec.colour) }, line: { value: rgb("#ffffff") }, haze: { value: rgb("#ffffff") }, sun: { value: sun },
        opacity: { value: spec.opacity }, pitch: { value: round_length(size / 8) }, grid: { value: spec.clear ? 0 : 1 }, size: { value: far },
      },
    });
    this.mesh = new THREE.Mesh(geometry, this.material);
    this.mesh.position.z = spec.height; // the middle of the picture is the origin
    this.mesh.renderOrder = spec.clear ? 1 : -5;
    this.mesh.frustumCulled = false;
    this.shown = NaN;
  }

  show(when) {
    if (!this.sea || when.time === this.shown) return;
    this.shown = when.time;
    const { near, sea, crest } = this;
    const count = 6 * FINE;
    const [pitch, places] = [(3 * near) / count, this.mesh.geometry.attributes.position.array];
    const first = sea.distance(0, 0) - 1.5 * near;
    const profile = Float32Array.from({ length: count + 2 }, (_, k) => sea.along(first + k * pitch, when.time, (3 * near) / FINE));
    for (let k = 0; k < crest.length; k++) {
      const [x, y] = [places[3 * k], places[3 * k + 1]];
      const off = Math.max(Math.abs(x), Math.abs(y)) / near;
      if (off >= 1) continue;
      const at = (x * sea.direction[0] + y * sea.direction[1]) / pitch + count / 2;
      const i = Math.floor(at);
      const share = at - i;
      crest[k] = (off > 0.8 ? 5 * (1 - off) : 1) * ((1 - share) * profile[i] + share * profile[i + 1]);
    }
    this.mesh.geometry.attributes.crest.needsUpdate = true;
  }

  /** The point of the mesh that is nearest to a place, above the level of still water. */
  nearest(x, y) {
    const [places, middle] = [this.mesh.geometry.attributes.position.array, this.mesh.position];
    const at = (k) => [places[3 * k] + middle.x, places[3 * k + 1] + middle.y, this.crest[k]];
    const off = (k) => Math.hypot(at(k)[0] - x, at(k)[1] - y);
    let best = 0;
    for (let k = 1; k < this.crest.length; k++) if (off(k) < off(best)) best = k;
    return at(best);
  }
}

/** The sky, which is also what lies below a horizon that no level reaches. */
class Sky {
  constructor() {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]), 3));
    this.uniforms = { back: { value: new THREE.Matrix4() }, zenith: { value: rgb("#ffffff") }, horizon: { value: rgb("#ffffff") }, nadir: { value: rgb("#ffffff") } };
    this.mesh = new THREE.Mesh(geometry, new THREE.ShaderMaterial({
      vertexShader: SKY_VERTEX, fragmentShader: SKY_FRAGMENT, uniforms: this.uniforms, depthTest: false, depthWrite: false,
    }));
    this.mesh.renderOrder = -10;
    this.mesh.frustumCulled = false;
  }

  look(camera) {
    this.uniforms.back.value.multiplyMatrices(camera.matrixWorld, camera.projectionMatrixInverse);
  }
}

/** Shadows of tubes and bodies on a level. */
class Shadows {
  constructor(tubes, bodies, level, onWater, size, sun) {
    const uniforms = { sun: { value: sun }, level: { value: level }, shade: { value: rgb("#808080") }, reach: { value: 4 * size }, middle: { value: new THREE.Vector3() } };
    const look = (vertexShader, more) => new THREE.ShaderMaterial({
      vertexShader, fragmentShader: SHADE_FRAGMENT, uniforms: { ...uniforms, ...more }, side: THREE.DoubleSide,
      // Of what is there and the shade the darker stays, so that shadows on shadows are no darker.
      depthTest: onWater, depthWrite: false, transparent: onWater, blending: CUSTOM, blendEquation: DARKER,
      polygonOffset: onWater, polygonOffsetFactor: -4, polygonOffsetUnits: -4,
    });
    const solid = look(SHADE_BODY, {});
    this.meshes = bodies.filter((body) => body.spec.opacity > 0.3).map((body) => {
      const mesh = new THREE.Mesh(body.mesh.geometry, solid);
      [mesh.matrix, mesh.matrixAutoUpdate] = [body.mesh.matrix, false];
      return mesh;
    });
    for (const tube of tubes.filter((one) => !one.spec.hollow && one.spec.thick)) {
      const { least, factor, height } = tube.material.uniforms;
      const mesh = new THREE.Mesh(tube.geometry, look(SHADE_TUBE, { least, factor, height }));
      this.meshes.push(mesh);
    }
    for (const mesh of this.meshes) {
      mesh.renderOrder = onWater ? 2 : -4;
      mesh.frustumCulled = false;
    }
    this.uniforms = uniforms;
  }

  show() {
    for (const mesh of this.meshes) mesh.matrixWorldNeedsUpdate = true;
  }
}
