// What one panel of the turnable view draws: the diaphragm of a run in its tank, at an instant.
"use strict";

const INK = 0x1c2329, GREY = 0x6b757d, BLUE = 0x0072b2;

function unpacked(text, Type) {
  return new Type(Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer);
}

function unquantised({ unit, values }) {
  return Float32Array.from(unpacked(values, Int16Array), (value) => value * unit);
}

// One run: triangles, and by instant the nodes' positions [m] and pressures [kPa].
function unpackedRun(packed) {
  const position = unquantised(packed.position), pressure = unquantised(packed.pressure);
  const dynamic = packed.dynamic ? unquantised(packed.dynamic) : new Float32Array(pressure.length);
  return {
    ...packed,
    triangles: unpacked(packed.triangles, packed.wide ? Uint32Array : Uint16Array),
    position,
    nodes: position.length / packed.cg.length / 3,
    pressure,
    dynamic,
    hydrostatic: pressure.map((value, node) => value - dynamic[node]),
  };
}

function circle(radius, points = 128) {
  return new THREE.BufferGeometry().setFromPoints(
    Array.from({ length: points + 1 }, (_, k) => {
      const angle = (2 * Math.PI * k) / points;
      return new THREE.Vector3(radius * Math.cos(angle), radius * Math.sin(angle), 0);
    }),
  );
}

function line(geometry, color, opacity = 1) {
  return new THREE.Line(
    geometry, new THREE.LineBasicMaterial({ color, transparent: opacity < 1, opacity }),
  );
}

// Part of the shell above or below the rim; rows of `profile`: r, z and the normal's r and z.
function halfShell(profile, upper, color, opacity) {
  const rows = profile.filter(([, z]) => (upper ? z >= 0 : z <= 0)), around = 64;
  const points = [], index = [];
  rows.forEach(([r, z], row) => {
    for (let k = 0; k <= around; k++) {
      const angle = (2 * Math.PI * k) / around;
      points.push(r * Math.cos(angle), r * Math.sin(angle), z);
      if (row === 0 || k === around) continue;
      const here = row * (around + 1) + k, before = here - around - 1;
      index.push(before, before + 1, here, here, before + 1, here + 1);
    }
  });
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(points), 3));
  geometry.setIndex(new THREE.BufferAttribute(new Uint16Array(index), 1));
  const material = new THREE.MeshBasicMaterial(
    { color, transparent: true, opacity, depthWrite: false, side: THREE.DoubleSide },
  );
  return new THREE.Mesh(geometry, material);
}

// The closed curve of the shell where a cos(angle) lean + b z = level, from rows (r, z, a, b) of its
// meridian; the angle is the azimuth from the direction in which the unit vector (x, y, z) leans.
function curveOf(rows, { x, y, z }, level) {
  const lean = Math.max(Math.hypot(x, y), 1e-9), turn = Math.atan2(y, x);
  const point = (r, angle, height) =>
    new THREE.Vector3(r * Math.cos(angle + turn), r * Math.sin(angle + turn), height);
  if (Math.abs(z) < lean) { // two angles to a height
    const sides = [1, -1].map((side) => rows.flatMap(([r, height, a, b]) => {
      const cosine = (level - z * b) / (lean * a);
      return Math.abs(cosine) <= 1 ? [point(r, side * Math.acos(cosine), height)] : [];
    }));
    return [...sides[0], ...sides[1].reverse(), ...sides[0].slice(0, 1)];
  }
  return Array.from({ length: 129 }, (_, k) => { // a height to an angle
    const angle = (2 * Math.PI * k) / 128;
    const beyond = rows.map(([, , a, b]) => a * lean * Math.cos(angle) + b * z - level);
    const row = beyond.findIndex((value, at) => at > 0 && value * beyond[at - 1] <= 0);
    if (row < 0) return [];
    const before = rows[row - 1], span = beyond[row - 1] - beyond[row];
    const share = span ? beyond[row - 1] / span : 0;
    const [r, height] = [0, 1].map((c) => before[c] + share * (rows[row][c] - before[c]));
    return [point(r, angle, height)];
  }).flat();
}

function redraw(curve, points) {
  curve.geometry.dispose();
  curve.geometry = new THREE.BufferGeometry().setFromPoints(points);
}

// The scene that one panel draws.
class Tank {
  constructor(canvas, { radius, profile, middle }) {
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.renderer.outputColorSpace = THREE.LinearSRGBColorSpace; // colours as the scale has them
    this.scene = new THREE.Scene();
    this.scene.position.z = -middle; // the camera turns about the shell's middle
    this.profile = profile;
    this.outline = line(new THREE.BufferGeometry(), INK);
    this.free = new THREE.Line(
      new THREE.BufferGeometry(),
      new THREE.LineDashedMaterial({ color: BLUE, dashSize: radius / 25, gapSize: radius / 40 }),
    );
    this.outline.frustumCulled = this.free.frustumCulled = false; // its bounds would be stale
    this.cg = new THREE.Mesh(
      new THREE.SphereGeometry(0.022 * radius, 16, 12),
      new THREE.MeshBasicMaterial({ color: INK, depthTest: false, transparent: true }),
    );
    this.path = line(new THREE.BufferGeometry(), INK);
    Object.assign(this.path.material, { depthTest: false, transparent: true });
    this.cg.renderOrder = this.path.renderOrder = 2;
    this.light = new THREE.DirectionalLight(0xffffff, 0.38 * Math.PI);
    this.sheet = new THREE.Mesh(new THREE.BufferGeometry(), new THREE.MeshLambertMaterial({
      vertexColors: true, flatShading: true, side: THREE.DoubleSide,
      polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
    }));
    this.edges = new THREE.Mesh(this.sheet.geometry, new THREE.MeshBasicMaterial(
      { color: INK, wireframe: true, transparent: true, opacity: 0.1, depthWrite: false },
    ));
    this.scene.add(
      new THREE.AmbientLight(0xffffff, 0.62 * Math.PI), this.light, this.sheet, this.edges,
      this.outline, this.free, this.cg, this.path, line(circle(radius), GREY),
      halfShell(profile, true, GREY, 0.03), halfShell(profile, false, BLUE, 0.06),
    );
  }

  choose(run) {
    this.sheet.geometry.dispose();
    const geometry = new THREE.BufferGeometry();
    geometry.setIndex(new THREE.BufferAttribute(run.triangles, 1));
    for (const name of ["position", "color"]) {
      geometry.setAttribute(name, new THREE.BufferAttribute(new Float32Array(3 * run.nodes), 3));
    }
    this.sheet.geometry = this.edges.geometry = geometry;
    this.sheet.frustumCulled = this.edges.frustumCulled = false; // its bounds would be stale
    this.path.geometry.setFromPoints(run.cg.map((point) => new THREE.Vector3(...point)));
  }

  // The instant's shape, coloured by `values` between `low` and `high` of `colours`.
  show(run, values, instant, pull, level, { low, high, colours }) {
    const { position, color } = this.sheet.geometry.attributes;
    const first = instant * run.nodes;
    position.array.set(run.position.subarray(3 * first, 3 * (first + run.nodes)));
    for (let node = 0; node < run.nodes; node++) {
      const share = (values[first + node] - low) / (high - low);
      const entry = 3 * Math.min(255, Math.max(0, Math.floor(256 * share)));
      for (let k = 0; k < 3; k++) color.array[3 * node + k] = colours[entry + k] / 255;
    }
    position.needsUpdate = color.needsUpdate = true;
    this.cg.position.set(...run.cg[instant]);
    const up = new THREE.Vector3(...pull).multiplyScalar(-1);
    redraw(this.free, curveOf(this.profile.map(([r, z]) => [r, z, r, z]), up, level));
    this.free.computeLineDistances();
  }

  draw(camera) {
    const canvas = this.renderer.domElement, side = canvas.clientWidth;
    const ratio = Math.min(2, window.devicePixelRatio);
    if (canvas.width !== Math.floor(side * ratio)) {
      this.renderer.setPixelRatio(ratio);
      this.renderer.setSize(side, side, false);
    }
    const towards = new THREE.Vector3(0, 0, 1).applyQuaternion(camera.quaternion);
    redraw(this.outline, curveOf(this.profile, towards, 0));
    this.light.position.set(-0.5, 0.8, 1).applyQuaternion(camera.quaternion);
    this.renderer.render(this.scene, camera);
  }
}
