// The turnable view of the report: the diaphragm in the tank, one or two scenes that turn and run
// together. What it draws is packed by viewer.py; three.js stands before it in the page as THREE.
"use strict";

const LOOP = 4000; // ms at least that a period takes when played
const NAMES = {
  pressure: "net pressure (kPa)",
  hydrostatic: "hydrostatic part (kPa)",
  dynamic: "dynamic pressure p* (kPa)",
};
const INK = 0x1c2329, GREY = 0x6b757d, BLUE = 0x0072b2;
const TURN = Math.PI / 36; // of an arrow key

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
    this.cg = new THREE.Mesh(
      new THREE.SphereGeometry(0.022 * radius, 16, 12),
      new THREE.MeshBasicMaterial({ color: INK, depthTest: false, transparent: true }),
    );
    this.path = line(new THREE.BufferGeometry(), INK);
    Object.assign(this.path.material, { depthTest: false, transparent: true });
    this.cg.renderOrder = this.path.renderOrder = 2;
    this.light = new THREE.DirectionalLight(0xffffff, 0.5 * Math.PI);
    this.sheet = new THREE.Mesh(new THREE.BufferGeometry(), new THREE.MeshLambertMaterial({
      vertexColors: true, flatShading: true, side: THREE.DoubleSide,
      polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
    }));
    this.edges = new THREE.Mesh(this.sheet.geometry, new THREE.MeshBasicMaterial(
      { color: INK, wireframe: true, transparent: true, opacity: 0.1, depthWrite: false },
    ));
    this.scene.add(
      new THREE.AmbientLight(0xffffff, 0.6 * Math.PI), this.light, this.sheet, this.edges,
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

// A panel's canvas, its choices, its scale and its caption.
class Panel {
  constructor(figure, data, runs, view, changed) {
    Object.assign(this, { figure, runs });
    this.canvas = figure.querySelector("canvas");
    this.tank = new Tank(this.canvas, data.tank.radius, data.level);
    this.model = figure.querySelector(".viewer-model");
    this.quantity = figure.querySelector(".viewer-quantity");
    for (const { model } of runs) this.model.add(new Option(model, model));
    this.model.hidden = runs.length === 1;
    this.model.value = view.model;
    this.quantity.value = view.quantity;
    this.model.addEventListener("change", () => { this.choose(); changed(); });
    this.quantity.addEventListener("change", changed);
    this.choose();
  }

  choose() {
    this.run = this.runs.find(({ model }) => model === this.model.value);
    this.tank.choose(this.run);
  }

  get range() { return this.run.range[this.quantity.value]; }

  describe({ low, high, colours }) {
    const [bar, ...marks] = this.figure.querySelectorAll(".viewer-scale > *");
    const stops = Array.from({ length: 16 }, (_, k) => 3 * 17 * k);
    bar.style.background = `linear-gradient(to right, ${stops
      .map((entry) => `rgb(${colours.slice(entry, entry + 3).join(",")})`).join(",")})`;
    const name = NAMES[this.quantity.value];
    [plain(low), name, plain(high)].forEach((text, k) => { marks[k].textContent = text; });
    const none = !this.run.flow && this.quantity.value !== "hydrostatic";
    this.figure.querySelector("figcaption").textContent = none
      ? `${this.run.model} computes no flow: its p* is zero, its pressure all hydrostatic.` : "";
    this.canvas.setAttribute(
      "aria-label", `Diaphragm in the tank, ${this.run.model}, coloured by ${name}`,
    );
  }
}

function plain(value) {
  return String(Number(value.toPrecision(2))).replace("-", "−");
}

class Viewer {
  constructor(root) {
    this.data = JSON.parse(root.querySelector("script").textContent);
    this.root = root;
    this.colours = {};
    for (const [name, text] of Object.entries(this.data.colours)) {
      this.colours[name] = unpacked(text, Uint8Array);
    }
    const runs = this.data.runs.map(unpackedRun), template = root.querySelector("template");
    THREE.ColorManagement.enabled = false;
    this.panels = this.data.views.map((view) => {
      const figure = template.content.firstElementChild.cloneNode(true);
      root.querySelector(".viewer-panels").append(figure);
      return new Panel(figure, this.data, runs, view, () => this.update());
    });
    this.slider = root.querySelector("input[type=range]");
    this.common = root.querySelector(".viewer-common");
    this.common.hidden = this.panels.length === 1;
    this.play = root.querySelector(".viewer-play");
    this.slider.max = this.data.time.length - 1;
    this.setUpCamera();
    this.slider.addEventListener("input", () => { this.stop(); this.update(); });
    this.common.addEventListener("change", () => this.update());
    this.play.addEventListener("click", () => (this.playing ? this.stop() : this.start()));
    root.querySelector(".viewer-reset").addEventListener("click", () => this.lookFromTheSide());
    new ResizeObserver(() => this.draw()).observe(root);
    this.update();
  }

  // One camera for all panels, so that they turn together.
  setUpCamera() {
    const half = 1.06 * this.data.tank.radius;
    this.camera = new THREE.OrthographicCamera(-half, half, half, -half, 0, 20 * half);
    this.camera.up.set(0, 0, 1);
    this.controls = this.panels.map(({ canvas }) => {
      // Without Ctrl the wheel scrolls the page, and so does one finger up and down.
      canvas.addEventListener("wheel", (event) => {
        if (!event.ctrlKey) event.stopImmediatePropagation();
      }, { capture: true });
      canvas.addEventListener("keydown", (event) => this.turn(event));
      const controls = new THREE.OrbitControls(this.camera, canvas);
      Object.assign(controls, { enablePan: false, minZoom: 0.5, maxZoom: 8 });
      canvas.style.touchAction = "pan-y";
      controls.addEventListener("change", () => this.draw());
      return controls;
    });
    this.lookFromTheSide();
  }

  lookFromTheSide() {
    const { azimuth, elevation } = this.data.camera;
    this.camera.zoom = 1;
    this.camera.updateProjectionMatrix();
    this.look((azimuth * Math.PI) / 180, (elevation * Math.PI) / 180);
  }

  look(azimuth, elevation) {
    const distance = 10 * this.data.tank.radius, flat = distance * Math.cos(elevation);
    this.camera.position.set(
      flat * Math.cos(azimuth), flat * Math.sin(azimuth), distance * Math.sin(elevation),
    );
    this.controls.forEach((controls) => controls.update());
    this.draw();
  }

  turn(event) {
    const turns = { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    if (!(event.key in turns)) return;
    event.preventDefault();
    const { x, y, z } = this.camera.position, [around, over] = turns[event.key];
    const elevation = Math.atan2(z, Math.hypot(x, y)) + TURN * over;
    const most = Math.PI / 2 - 1e-3;
    this.look(Math.atan2(y, x) + TURN * around, Math.min(most, Math.max(-most, elevation)));
  }

  start() {
    const { time } = this.data, count = time.length, last = count - 1;
    const real = last ? (1000 * (time[last] - time[0]) * count) / last : 0;
    const loop = Math.max(LOOP, real);
    const begin = performance.now() - (Number(this.slider.value) / count) * loop;
    const tick = (now) => {
      this.playing = requestAnimationFrame(tick);
      const instant = Math.floor((Math.max(0, now - begin) / loop) * count) % count;
      if (instant === Number(this.slider.value)) return;
      this.slider.value = instant;
      this.update();
    };
    this.playing = requestAnimationFrame(tick);
    this.play.textContent = "Pause";
  }

  stop() {
    cancelAnimationFrame(this.playing);
    this.playing = 0;
    this.play.textContent = "Play";
  }

  // The colours' range of a panel: p* about zero, and one for both where that is asked for.
  scaleOf(panel) {
    const together = this.common.querySelector("input").checked ? this.panels : [panel];
    const ranges = together.map(({ range }) => range);
    let low = Math.min(...ranges.map((range) => range[0]));
    let high = Math.max(...ranges.map((range) => range[1]));
    const diverging = together.some(({ quantity }) => quantity.value === "dynamic");
    if (diverging) low = -(high = Math.max(-low, high));
    if (high <= low) [low, high] = [low - 1, high + 1];
    return { low, high, colours: this.colours[diverging ? "diverging" : "sequential"] };
  }

  update() {
    const { time, tank, pull } = this.data, instant = Number(this.slider.value);
    const moved = Math.round(1000 * tank.displacement[instant]);
    const text = `t = ${time[instant].toFixed(3)} s, tank at ${tank.axis} = ${moved} mm`
      .replace("-", "−");
    this.root.querySelector("output").textContent = text;
    this.slider.setAttribute("aria-valuetext", text);
    for (const panel of this.panels) {
      const scale = this.scaleOf(panel);
      panel.tank.show(panel.run, panel.run[panel.quantity.value], instant, pull[instant], scale);
      panel.describe(scale);
    }
    this.draw();
  }

  draw() {
    this.panels.forEach(({ tank }) => tank.draw(this.camera));
  }
}

for (const root of document.querySelectorAll(".viewer")) {
  root.hidden = false;
  if (document.createElement("canvas").getContext("webgl2")) {
    root.nextElementSibling.hidden = true;
    new Viewer(root);
  } else {
    root.hidden = true;
  }
}
