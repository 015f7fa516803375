// A cloud of points that can be turned: three.js, with the keys of a page.
import { BufferAttribute, BufferGeometry, ColorManagement, LinearSRGBColorSpace, PerspectiveCamera, Points, PointsMaterial, Raycaster, Scene, Vector2, WebGLRenderer } from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

ColorManagement.enabled = false;

/** Draws points on a canvas. x is forward, y left, z up, in metres. */
export class Cloud {
  /** `picked` is called with the number of the point that is clicked, or -1. */
  constructor(canvas, picked) {
    this.canvas = canvas;
    this.renderer = new WebGLRenderer({ canvas, antialias: false, alpha: true, preserveDrawingBuffer: true });
    // colours are shown as they are given
    this.renderer.outputColorSpace = LinearSRGBColorSpace;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(60, 1, 0.01, 1000);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", () => this.draw());
    this.material = new PointsMaterial({ size: 3, sizeAttenuation: false, vertexColors: true });
    this.points = new Points(new BufferGeometry(), this.material);
    this.points.frustumCulled = false;
    this.scene.add(this.points);
    new ResizeObserver(() => this.draw()).observe(canvas);
    let down = null;
    canvas.addEventListener("pointerdown", event => { down = [event.clientX, event.clientY]; });
    canvas.addEventListener("pointerup", event => {
      if (down && Math.hypot(event.clientX - down[0], event.clientY - down[1]) < 4) picked(this.pointAt(event));
    });
    canvas.addEventListener("keydown", event => this.key(event));
  }

  /** Shows these points: three numbers each, not a number where there is none. Unless `stay` the
   *  view is that of `home`. */
  show(positions, stay = false) {
    const geometry = new BufferGeometry();
    // what is not a number must not be drawn; far behind is
    const placed = positions.map(x => Number.isFinite(x) ? x : 1e6);
    geometry.setAttribute("position", new BufferAttribute(placed, 3));
    this.colours = new BufferAttribute(new Uint8Array(positions.length), 3, true);
    geometry.setAttribute("color", this.colours);
    this.points.geometry.dispose();
    this.points.geometry = geometry;
    this.positions = positions;
    if (!stay) this.home();
  }

  /** Looks at the cloud from behind and above its scanner. */
  home() {
    const middle = [0, 1, 2].map(axis => {
      const all = [];
      for (let i = axis; i < this.positions.length; i += 3 * 7) if (Number.isFinite(this.positions[i])) all.push(this.positions[i]);
      all.sort((a, b) => a - b);
      return all.length ? [all[all.length >> 1], all[Math.floor(all.length * 0.9)] - all[Math.floor(all.length * 0.1)]] : [0, 1];
    });
    const size = Math.max(0.5, Math.hypot(...middle.map(m => m[1])));
    const [x, y, z] = middle.map(m => m[0]);
    this.controls.target.set(x, y, z);
    this.camera.position.set(x - 0.7 * size, y + 0.2 * size, z + 0.3 * size);
    this.camera.near = size / 1000;
    this.camera.far = size * 100;
    this.controls.update();
    this.draw();
  }

  /** Draws anew, with three bytes for each point if they are given. */
  draw(colours) {
    if (colours) {
      this.colours.array.set(colours);
      this.colours.needsUpdate = true;
    }
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (!width || !height) return;
    const size = this.renderer.getSize(new Vector2());
    if (size.x !== width || size.y !== height) {
      this.renderer.setSize(width, height, false);
      this.camera.aspect = width / height;
      this.camera.updateProjectionMatrix();
    }
    this.renderer.render(this.scene, this.camera);
  }

  /** Returns the number of the nearest point within some pixels of a place, or -1. */
  pointAt(event) {
    const box = this.canvas.getBoundingClientRect();
    const at = new Vector2(2 * (event.clientX - box.left) / box.width - 1, 1 - 2 * (event.clientY - box.top) / box.height);
    const ray = new Raycaster();
    ray.setFromCamera(at, this.camera);
    const pixel = 2 * Math.tan(this.camera.fov * Math.PI / 360) / box.height;
    const { origin, direction } = ray.ray;
    let best = -1, least = Infinity;
    for (let i = 0; i < this.positions.length; i += 3) {
      const [x, y, z] = [this.positions[i] - origin.x, this.positions[i + 1] - origin.y, this.positions[i + 2] - origin.z];
      const along = x * direction.x + y * direction.y + z * direction.z;
      const aside = Math.sqrt(Math.max(0, x * x + y * y + z * z - along * along));
      if (along > this.camera.near && aside < 6 * pixel * along && along < least) [best, least] = [i / 3, along];
    }
    return best;
  }

  key(event) {
    const turn = 0.08, offset = this.camera.position.clone().sub(this.controls.target);
    const around = { ArrowLeft: turn, ArrowRight: -turn }[event.key];
    const up = { ArrowUp: turn, ArrowDown: -turn }[event.key];
    if (around) offset.applyAxisAngle(this.camera.up, around);
    else if (up) {
      const flat = Math.hypot(offset.x, offset.y), length = offset.length();
      const angle = Math.max(-1.5, Math.min(1.5, Math.atan2(offset.z, flat) + up));
      offset.set(offset.x / flat * Math.cos(angle) * length, offset.y / flat * Math.cos(angle) * length, Math.sin(angle) * length);
    } else if (event.key === "+" || event.key === "=") offset.multiplyScalar(0.9);
    else if (event.key === "-") offset.multiplyScalar(1 / 0.9);
    else if (event.key === "0") return this.home();
    else return;
    event.preventDefault();
    this.camera.position.copy(this.controls.target).add(offset);
    this.controls.update();
    this.draw();
  }
}
