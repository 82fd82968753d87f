// Quantities on the elements, and their means at the vertices.

import { readValues, type Model, type Phasor, type Scalar, type Values } from "./data";
import type { Geometry } from "./geometry";

/** Share that a buried element has in the means at its corners, so that a vertex among nothing else has a value. */
const BURIED = 1e-9;

/** What can be shown in false colour. */
export interface Quantity {
  name: string;
  symbol: string;
  unit: string;
  banded: boolean;
  /** About zero, of either sign. */
  diverging: boolean;
  read: (band: number, step: number, phase: number) => Promise<Float32Array>;
}

export class Fields {
  readonly quantities: Quantity[] = [];
  private readonly cache = new Map<string, Promise<Float32Array>>();
  private readonly weights: Float32Array;

  constructor(
    private readonly model: Model,
    private readonly geometry: Geometry,
  ) {
    this.weights = geometry.area.map(
      (area, i) => Math.max(geometry.exposed[i], BURIED) / (area || 1),
    );
    if (model.irradiance.length > 0) this.addLight();
    for (const phasor of model.phasors) this.addPhasor(phasor);
    for (const scalar of model.scalars) this.addScalar(scalar);
  }

  private addLight(): void {
    const add = (name: string, symbol: string, unit: string, read: Quantity["read"]): void => {
      this.quantities.push({ name, symbol, unit, banded: true, diverging: false, read });
    };
    add("Irradiance", "E", "W/m²", (band, step) => this.seen(this.irradiance(band, step)));
    add("Radiosity", "B", "W/m²", async (band, step) => this.seenRadiosity(band, step));
    const surfaces = this.model.surfaces;
    if (surfaces.some((surface) => surface.exitance)) {
      add("Exitance", "M", "W/m²", async (band) =>
        this.bySurface((s) => surfaces[s].exitance?.[band] ?? NaN),
      );
      add("Reflectance", "ρ", "", async (band) =>
        this.bySurface((s) => surfaces[s].reflectance[band] ?? NaN),
      );
    }
  }

  private addPhasor(phasor: Phasor): void {
    const { name, symbol, component, unit } = phasor;
    const instant: Quantity["read"] = async (_band, _step, phase) => {
      const [real, imaginary] = await Promise.all([
        this.values(phasor.real),
        this.values(phasor.imaginary),
      ]);
      const [cos, sin] = [Math.cos(phase), Math.sin(phase)];
      return real.map((value, i) => value * cos - imaginary[i] * sin);
    };
    this.quantities.push({
      name: `${name}: magnitude`,
      symbol: `|${symbol}|`,
      unit,
      banded: false,
      diverging: false,
      read: () => this.values(phasor.magnitude),
    });
    const shown = { name: `${name}: at a phase`, symbol: component };
    this.quantities.push({ ...shown, unit, banded: false, diverging: true, read: instant });
  }

  private addScalar({ name, symbol, unit, diverging, values }: Scalar): void {
    this.quantities.push({
      name,
      symbol,
      unit,
      banded: false,
      diverging,
      read: () => this.values(values),
    });
  }

  private values(values: Values): Promise<Float32Array> {
    const kept = this.cache.get(values.blob) ?? readValues(values);
    this.cache.set(values.blob, kept);
    return kept;
  }

  private bySurface(of: (surface: number) => number): Float32Array {
    return Float32Array.from(this.geometry.surface, of);
  }

  /** Irradiance, means over whole elements, W/m². */
  irradiance(band: number, step: number): Promise<Float32Array> {
    const steps = this.model.steps;
    return this.values(
      step < steps.length ? steps[step].irradiance[band] : this.model.irradiance[band],
    );
  }

  /** Radiosity B = M + ρ E, means over whole elements, W/m². */
  async radiosity(band: number, step: number): Promise<Float32Array> {
    const stored = this.model.radiosity[band];
    if (stored && step >= this.model.steps.length) return this.values(stored);
    const { surface } = this.geometry;
    const laws = this.model.surfaces.map((s) => [
      s.exitance?.[band] ?? 0,
      s.reflectance[band] ?? 0,
    ]);
    const irradiance = await this.irradiance(band, step);
    return irradiance.map((e, i) => laws[surface[i]][0] + laws[surface[i]][1] * e);
  }

  /** What the exposed part has, where the mean is over the whole element. */
  private async seen(means: Promise<Float32Array>): Promise<Float32Array> {
    const { exposed } = this.geometry;
    return (await means).map((value, i) => (exposed[i] > 0 ? value / exposed[i] : value));
  }

  private async seenRadiosity(band: number, step: number): Promise<Float32Array> {
    const { exposed, surface } = this.geometry;
    const exitance = this.model.surfaces.map((s) => s.exitance?.[band] ?? 0);
    return (await this.radiosity(band, step)).map((value, i) => {
      const own = exitance[surface[i]];
      return exposed[i] > 0 ? own + (value - own) / exposed[i] : value;
    });
  }

  /** Colour of the elements in linear sRGB, three numbers each, in the unit of radiosity. */
  async appearance(step: number): Promise<Float32Array> {
    const found = new Float32Array(3 * this.geometry.area.length);
    for (let band = 0; band < this.model.colours.length; band++) {
      const [r, g, b] = this.model.colours[band];
      const values = await this.seenRadiosity(band, step);
      for (let i = 0; i < values.length; i++) {
        found[3 * i] += r * values[i];
        found[3 * i + 1] += g * values[i];
        found[3 * i + 2] += b * values[i];
      }
    }
    return found;
  }

  /** Means at the vertices of `lanes` numbers an element; the smaller and the less buried elements count more. */
  smooth(values: Float32Array, lanes: number, into: Float32Array, offset: number): void {
    const { corners, starts, positions } = this.geometry;
    const total = new Float32Array(positions.length / 3);
    const sums = new Float32Array(lanes * total.length);
    for (let i = 0; i + 1 < starts.length; i++) {
      if (Number.isNaN(values[lanes * i])) continue;
      const weight = this.weights[i];
      for (let k = starts[i]; k < starts[i + 1]; k++) {
        const vertex = corners[k];
        total[vertex] += weight;
        for (let lane = 0; lane < lanes; lane++)
          sums[lanes * vertex + lane] += weight * values[lanes * i + lane];
      }
    }
    for (let vertex = 0; vertex < total.length; vertex++) {
      for (let lane = 0; lane < lanes; lane++) {
        into[4 * vertex + offset + lane] = sums[lanes * vertex + lane] / total[vertex];
      }
    }
    this.close(lanes, into, offset);
  }

  /** Gives vertices on the sides of larger elements the mean of the ends, which these have there: no crack is seen. */
  private close(lanes: number, into: Float32Array, offset: number): void {
    const { hanging } = this.geometry;
    for (let k = 0; k < hanging.length; k += 3) {
      const [vertex, a, b] = [
        4 * hanging[k] + offset,
        4 * hanging[k + 1] + offset,
        4 * hanging[k + 2] + offset,
      ];
      for (let lane = 0; lane < lanes; lane++)
        into[vertex + lane] = 0.5 * (into[a + lane] + into[b + lane]);
    }
  }

  /** Area means over the elements of a face, of given values. */
  faceMean(values: Float32Array, face: number): number {
    let [sum, area] = [0, 0];
    for (let i = 0; i < values.length; i++) {
      if (this.geometry.face[i] !== face) continue;
      sum += values[i] * this.geometry.area[i];
      area += this.geometry.area[i];
    }
    return area > 0 ? sum / area : NaN;
  }

  /** The exposure at which the logarithmic mean of the luminance, lamps left out, is mid grey. */
  async exposure(): Promise<number> {
    if (this.model.exposure !== null) return this.model.exposure;
    const colours = await this.appearance(this.model.steps.length);
    const lamps = this.model.surfaces.map((s) => s.exitance?.some((m) => m > 0) ?? false);
    const { area, surface } = this.geometry;
    const light = area.map(
      (_, i) => 0.2126 * colours[3 * i] + 0.7152 * colours[3 * i + 1] + 0.0722 * colours[3 * i + 2],
    );
    let [all, mean, logs] = [0, 0, 0];
    const each = (use: (i: number) => void): void =>
      light.forEach((_, i) => lamps[surface[i]] || use(i));
    each((i) => {
      all += area[i];
      mean += area[i] * Math.max(0, light[i]);
    });
    if (!(mean > 0)) return 1;
    each((i) => (logs += area[i] * Math.log(Math.max(light[i], (0.01 * mean) / all))));
    return MID_GREY / Math.exp(logs / all);
  }
}

/** The exposed luminance that the tone curve takes to 0.18. */
const MID_GREY = 8 * (Math.sqrt(0.82 * 0.82 + 0.045) - 0.82);
