"use strict";
// What stands in space. Everything is built once; `show` moves it to a frame.
// Lengths are in m from the picture's middle, z up; colours are sRGB.

const SIDES = 14;
const LEAST = 3; // px, of lines that are made thick enough to see
const STRIDE = 11; // floats of a ring: middle, two normals, radius, share of the legend
const UNKNOWN = 65535;

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
 * Rows of numbers, most often one for each frame, in 65535 steps about a middle of each column.
 * Stored are the middles (float32), and the steps of each column in all rows as differences, modulo 65536, from the
 * row before and from the same coordinate of the point before. A single row holds for every frame.
 */
class Track {
  constructor(spec, bytes) {
    const { at, rows, width, stride, step } = spec;
    Object.assign(this, { rows, width, step });
    this.middles = new Float32Array(bytes.slice(at, at + 4 * width).buffer);
    const steps = (this.steps = new Uint16Array(rows * width));
    const changes = integers(bytes, at + 4 * width, steps.length, 2);
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
    return steps === UNKNOWN ? NaN : this.middles[k] + this.step * (steps - 32767);
  }

  read(row, into) {
    for (let k = 0; k < this.width; k++) into[k] = this.value(row, k);
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

const LEVEL_FRAGMENT = `
  uniform vec3 plain;
  uniform float opacity, pitch;
  varying vec2 place;
  varying vec2 reach;
  void main() {
    float faded = 1.0 - smoothstep(0.35, 1.0, length(reach));
    vec2 off = abs(fract(place / pitch - 0.5) - 0.5) * pitch / fwidth(place);
    float grid = 0.35 * (1.0 - min(min(off.x, off.y), 1.0));
    gl_FragColor = vec4(mix(plain, vec3(1.0), grid), opacity * faded);
  }`;

const LEVEL_VERTEX = `
  varying vec2 place, reach;
  void main() {
    reach = position.xy;
    vec4 at = modelMatrix * vec4(position, 1.0);
    place = at.xy;
    gl_Position = projectionMatrix * viewMatrix * at;
  }`;

/** Red, green, blue from 0 to 1 of "#RRGGBB". */
const rgb = (colour) => new THREE.Vector3(...[1, 3, 5].map((k) => parseInt(colour.slice(k, k + 2), 16) / 255));

/** 1, 2 or 5 times a power of ten, at most so much. */
function round(most) {
  const power = 10 ** Math.floor(Math.log10(most));
  return [5, 2, 1].find((digit) => digit * power <= most * 1.000001) * power;
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

  show(frame) {
    this.points.read(frame, this.at);
    this.place();
    const shown = this.quantity;
    const track = shown && this.tracks[shown.name];
    for (let k = 0; k < this.count; k++) {
      let share = -1;
      if (track) {
        const value = track.value(frame, k) / shown.factor;
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
    this.turn = new Track(spec.turn, bytes);
    this.place = new Track(spec.place, bytes);
    [this.r, this.p] = [new Float32Array(9), new Float32Array(3)];
  }

  show(frame) {
    const r = this.turn.read(frame, this.r);
    const p = this.place.read(frame, this.p);
    this.mesh.matrix.set(r[0], r[1], r[2], p[0], r[3], r[4], r[5], p[1], r[6], r[7], r[8], p[2], 0, 0, 0, 1);
    this.mesh.matrixWorldNeedsUpdate = true;
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
    this.mesh = new THREE.InstancedMesh(
      THREE.mergeGeometries([shaft, head]), new THREE.MeshLambertMaterial({ color: spec.colour }), spec.points.width / 3,
    );
    this.mesh.name = spec.name;
    this.mesh.frustumCulled = false;
  }

  show(frame) {
    const [vector, turn, scale] = [new THREE.Vector3(), new THREE.Quaternion(), new THREE.Vector3()];
    const [up, at, pose] = [new THREE.Vector3(0, 0, 1), new THREE.Vector3(), new THREE.Matrix4()];
    let drawn = 0;
    for (let k = 0; k < this.mesh.instanceMatrix.count; k++) {
      const read = (track) => [0, 1, 2].map((c) => track.value(frame, 3 * k + c));
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

/** A plane that fades out beyond the picture, with a grid of round pitch. */
function level(spec, size, middle) {
  const mesh = new THREE.Mesh(
    new THREE.CircleGeometry(1, 96),
    new THREE.ShaderMaterial({
      vertexShader: LEVEL_VERTEX,
      fragmentShader: LEVEL_FRAGMENT,
      side: THREE.DoubleSide,
      transparent: true,
      depthWrite: false,
      uniforms: { plain: { value: rgb(spec.colour) }, opacity: { value: spec.opacity }, pitch: { value: round(size / 5) } },
    }),
  );
  mesh.scale.setScalar(2.2 * size);
  mesh.position.set(middle[0], middle[1], spec.height);
  mesh.renderOrder = 1;
  return mesh;
}
