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

function halfShell(radius, from, color, opacity) {
  const geometry = new THREE.SphereGeometry(radius, 64, 24, 0, 2 * Math.PI, from, Math.PI / 2);
  geometry.rotateX(Math.PI / 2); // its axis is y, ours z
  const material = new THREE.MeshBasicMaterial(
    { color, transparent: true, opacity, depthWrite: false, side: THREE.DoubleSide },
  );
  return new THREE.Mesh(geometry, material);
}

// The scene that one panel draws.
class Tank {
  constructor(canvas, radius, level) {
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.renderer.outputColorSpace = THREE.LinearSRGBColorSpace; // colours as the scale has them
    this.scene = new THREE.Scene();
    this.outline = line(circle(radius), INK);
    this.free = new THREE.Line(
      circle(radius * Math.sqrt(1 - level * level)),
      new THREE.LineDashedMaterial({ color: BLUE, dashSize: radius / 25, gapSize: radius / 40 }),
    );
    this.free.computeLineDistances();
    this.level = level * radius;
    this.free.visible = level !== null; // liquid that is drawn has no one level
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
      halfShell(radius, 0, GREY, 0.03), halfShell(radius, Math.PI / 2, BLUE, 0.06),
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
  show(run, values, instant, pull, { low, high, colours }) {
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
    const down = new THREE.Vector3(...pull);
    this.free.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, -1), down);
    this.free.position.copy(down).multiplyScalar(-this.level);
  }

  draw(camera) {
    const canvas = this.renderer.domElement, side = canvas.clientWidth;
    const ratio = Math.min(2, window.devicePixelRatio);
    if (canvas.width !== Math.floor(side * ratio)) {
      this.renderer.setPixelRatio(ratio);
      this.renderer.setSize(side, side, false);
    }
    this.outline.quaternion.copy(camera.quaternion); // the silhouette of a sphere
    this.light.position.set(-0.5, 0.8, 1).applyQuaternion(camera.quaternion);
    this.renderer.render(this.scene, camera);
  }
}
