// The turnable view of the report: one or two tanks that turn and run together. What it shows is
// packed by viewer.py; three.js, as THREE, and tank.js stand before it in the page.
"use strict";

const LOOP = 4000; // ms at least that a period takes when played
const NAMES = {
  pressure: "net pressure (kPa)",
  hydrostatic: "hydrostatic part (kPa)",
  dynamic: "dynamic pressure p* (kPa)",
};
const TURN = Math.PI / 36; // of an arrow key

// A panel's canvas, its choices, its scale and its caption.
class Panel {
  constructor(figure, data, runs, view, changed) {
    Object.assign(this, { figure, runs });
    this.canvas = figure.querySelector("canvas");
    this.tank = new Tank(this.canvas, data.tank);
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
    const half = 1.06 * this.data.tank.half;
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
    const distance = 10 * this.data.tank.half, flat = distance * Math.cos(elevation);
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
    const { time, tank, pull, levels } = this.data, instant = Number(this.slider.value);
    const moved = Math.round(1000 * tank.displacement[instant]);
    const text = `t = ${time[instant].toFixed(3)} s, tank at ${tank.axis} = ${moved} mm`
      .replace("-", "−");
    this.root.querySelector("output").textContent = text;
    this.slider.setAttribute("aria-valuetext", text);
    for (const panel of this.panels) {
      const scale = this.scaleOf(panel);
      panel.tank.show(
        panel.run, panel.run[panel.quantity.value], instant, pull[instant], levels[instant], scale,
      );
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
