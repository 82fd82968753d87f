// The surfaces in three dimensions.

import {
  BufferAttribute,
  BufferGeometry,
  DataTexture,
  DoubleSide,
  FloatType,
  FrontSide,
  GLSL3,
  LinearFilter,
  Matrix4,
  Mesh,
  PerspectiveCamera,
  RawShaderMaterial,
  Raycaster,
  RGBAFormat,
  Scene,
  Vector2,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import type { Camera } from "./data";
import { triangulate, type Geometry } from "./geometry";
import { FRAGMENT, LEVELS, ROW, VERTEX } from "./shaders";

export interface Picked {
  element: number;
  point: Vector3;
}

/** A table of four numbers an entry that the programs look up. */
class Table {
  readonly values: Float32Array;
  readonly texture: DataTexture;

  constructor(entries: number) {
    const rows = Math.max(1, Math.ceil(entries / ROW));
    this.values = new Float32Array(4 * ROW * rows);
    this.texture = new DataTexture(this.values, ROW, rows, RGBAFormat, FloatType);
    this.texture.needsUpdate = true;
  }
}

export class View {
  readonly elements: Table;
  readonly vertices: Table;
  readonly uniforms;
  onFrame: () => void = () => {};
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(40, 1, 0.01, 100);
  private readonly material: RawShaderMaterial;
  private readonly radius: number;
  private readonly home: Camera;
  private readonly map: DataTexture;
  private controls: OrbitControls;
  private scheduled = false;
  private fov = 40;
  private aspect = 1;

  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly geometry: Geometry,
    home: Camera,
  ) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
    this.elements = new Table(geometry.starts.length - 1);
    this.vertices = new Table(geometry.positions.length / 3);
    this.map = new DataTexture(new Uint8Array(4 * 256), 256, 1);
    this.map.magFilter = this.map.minFilter = LinearFilter;
    const [x, y, z] = geometry.size;
    this.radius = 0.5 * Math.hypot(x, y, z) || 1;
    this.uniforms = {
      elements: { value: this.elements.texture },
      vertices: { value: this.vertices.texture },
      size: { value: new Vector3(x, y, z) },
      appearance: { value: true },
      smoothed: { value: true },
      bothSides: { value: false },
      meshLines: { value: false },
      logarithmic: { value: false },
      exposure: { value: 1 },
      range: { value: new Vector2(0, 1) },
      pixel: { value: this.renderer.getPixelRatio() },
      levelCount: { value: 0 },
      levels: { value: new Float32Array(LEVELS) },
      map: { value: this.map },
      back: { value: new Vector3(0.5, 0.5, 0.5) },
      accent: { value: new Vector3(1, 0.2, 0.6) },
    };
    this.material = new RawShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      uniforms: this.uniforms,
      side: FrontSide,
    });
    this.scene.add(this.mesh());
    this.home = home;
    this.controls = this.toHome();
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement ?? canvas);
    this.resize();
  }

  private mesh(): Mesh {
    const { place, element, vertex } = triangulate(this.geometry);
    const buffers = new BufferGeometry();
    buffers.setAttribute("position", new BufferAttribute(place, 4, true));
    buffers.setAttribute("element", new BufferAttribute(element, 1));
    buffers.setAttribute("vertex", new BufferAttribute(vertex, 1));
    const mesh = new Mesh(buffers, this.material);
    mesh.frustumCulled = false;
    return mesh;
  }

  /** Looks from where the scene is seen from. */
  toHome(): OrbitControls {
    const { eye, target, up, vertical_fov_degrees, width, height } = this.home;
    this.fov = vertical_fov_degrees;
    this.aspect = width / height;
    return this.look(this.local(eye), this.local(target), new Vector3(...up).normalize());
  }

  /** Looks at everything, in the direction that it is looked in now. */
  toFit(): void {
    const target = new Vector3();
    const direction = this.camera.position.clone().sub(this.controls.target).normalize();
    const half = (Math.min(this.camera.fov, this.camera.fov * this.camera.aspect) * Math.PI) / 360;
    const eye = direction.multiplyScalar((1.02 * this.radius) / Math.sin(half));
    this.look(eye, target, this.camera.up.clone());
  }

  private local(point: [number, number, number]): Vector3 {
    return new Vector3(...point).sub(new Vector3(...this.geometry.centre));
  }

  private look(eye: Vector3, target: Vector3, up: Vector3): OrbitControls {
    this.controls?.dispose();
    this.camera.up.copy(up);
    this.camera.position.copy(eye);
    // The way up is fixed when controls are made.
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.target.copy(target);
    this.controls.zoomToCursor = true;
    this.controls.minDistance = 1e-3 * this.radius;
    this.controls.maxDistance = 50 * this.radius;
    this.controls.addEventListener("change", () => this.draw());
    this.controls.update();
    this.resize();
    return this.controls;
  }

  /** Turns about the target by angles in radians. */
  turn(sideways: number, upwards: number): void {
    const offset = this.camera.position.clone().sub(this.controls.target);
    const up = this.camera.up;
    offset.applyAxisAngle(up, sideways);
    const right = new Vector3().crossVectors(up, offset).normalize();
    const turned = offset.clone().applyAxisAngle(right, upwards);
    if (Math.abs(turned.clone().normalize().dot(up)) < 0.995) offset.copy(turned);
    this.camera.position.copy(this.controls.target).add(offset);
    this.controls.update();
    this.draw();
  }

  /** Moves closer by a factor. */
  zoom(factor: number): void {
    this.camera.position.sub(this.controls.target).multiplyScalar(factor).add(this.controls.target);
    this.controls.update();
    this.draw();
  }

  /** Moves eye and target by shares of their distance. */
  pan(right: number, up: number): void {
    const distance = this.camera.position.distanceTo(this.controls.target);
    const shift = new Vector3(right * distance, up * distance, 0).applyQuaternion(
      this.camera.quaternion,
    );
    this.camera.position.add(shift);
    this.controls.target.add(shift);
    this.controls.update();
    this.draw();
  }

  /** The target is moved to a point. */
  focus(point: Vector3): void {
    this.controls.target.copy(point);
    this.controls.update();
    this.draw();
  }

  setBacks(shown: boolean): void {
    this.material.side = shown ? DoubleSide : FrontSide;
    this.material.needsUpdate = true;
    this.draw();
  }

  setMap(bytes: Uint8Array): void {
    this.map.image.data?.set(bytes);
    this.map.needsUpdate = true;
  }

  setLevels(levels: number[]): void {
    const kept = levels.slice(0, LEVELS);
    this.uniforms.levels.value.set(kept);
    this.uniforms.levelCount.value = kept.length;
  }

  setBackground(colour: string): void {
    this.renderer.setClearColor(colour, 1);
    this.draw();
  }

  /** Draws before the next picture of the screen. */
  draw(): void {
    if (this.scheduled) return;
    this.scheduled = true;
    requestAnimationFrame(() => {
      this.scheduled = false;
      this.render();
    });
  }

  /** Draws at once. */
  render(): void {
    const distance = this.camera.position.length();
    this.camera.near = Math.max(distance - this.radius, 1e-3 * this.radius) * 0.98;
    this.camera.far = (distance + this.radius) * 1.02;
    this.camera.updateProjectionMatrix();
    this.renderer.render(this.scene, this.camera);
    this.onFrame();
  }

  private resize(): void {
    const frame = this.canvas.parentElement;
    if (!frame || frame.clientWidth === 0) return;
    const [width, height] = [frame.clientWidth, frame.clientHeight];
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    // All of the picture of the scene's camera stays in sight.
    const tangent =
      Math.tan((this.fov * Math.PI) / 360) * Math.max(1, this.aspect / this.camera.aspect);
    this.camera.fov = (Math.atan(tangent) * 360) / Math.PI;
    this.render();
  }

  /** The element that is seen at a place of the window. */
  pick(clientX: number, clientY: number, backs: boolean): Picked | null {
    const box = this.canvas.getBoundingClientRect();
    const place = new Vector2(
      (2 * (clientX - box.left)) / box.width - 1,
      1 - (2 * (clientY - box.top)) / box.height,
    );
    const caster = new Raycaster();
    this.camera.updateMatrixWorld();
    caster.setFromCamera(place, this.camera);
    return this.nearest(caster, backs);
  }

  private nearest({ ray }: Raycaster, backs: boolean): Picked | null {
    const { corners, starts, positions } = this.geometry;
    const [a, b, c, hit] = [new Vector3(), new Vector3(), new Vector3(), new Vector3()];
    let found: Picked | null = null;
    let least = Infinity;
    for (let i = 0; i + 1 < starts.length; i++) {
      if (this.elements.values[4 * i + 3] < 0.5) continue;
      a.fromArray(positions, 3 * corners[starts[i]]);
      for (let k = starts[i] + 1; k + 1 < starts[i + 1]; k++) {
        b.fromArray(positions, 3 * corners[k]);
        c.fromArray(positions, 3 * corners[k + 1]);
        if (!ray.intersectTriangle(a, b, c, !backs, hit)) continue;
        const distance = hit.distanceToSquared(ray.origin);
        if (distance < least) {
          least = distance;
          found = { element: i, point: hit.clone() };
        }
      }
    }
    return found;
  }

  /** Where a point of the mesh is seen in the window; null where it is not before the eye. */
  place(point: Vector3): [number, number] | null {
    const seen = point.clone().applyMatrix4(new Matrix4().copy(this.camera.matrixWorldInverse));
    if (seen.z >= 0) return null;
    seen.applyMatrix4(this.camera.projectionMatrix);
    const box = this.canvas.getBoundingClientRect();
    return [box.left + 0.5 * (1 + seen.x) * box.width, box.top + 0.5 * (1 - seen.y) * box.height];
  }

  /** The picture as it stands, for print. */
  picture(): string {
    this.render();
    return this.canvas.toDataURL("image/png");
  }
}
