// What the page carries: a JSON description, and arrays as deflated bytes in base64.
//
// An array of words holds 16-bit codes: each is the difference to the one before modulo 2¹⁶, folded
// so that small differences of either sign are small numbers; all upper bytes come first, then all
// lower bytes. An array of varints holds integers of seven bits a byte, the lowest first.

/** How 16-bit codes stand for numbers: 0 for 0, else ±low (high/low)^((|code| − 1)/(levels − 1)). */
export interface Scale {
  low: number;
  high: number;
  levels: number;
  signed: boolean;
  /** Largest relative error of a number that is at least `low`. */
  error: number;
}

export interface Values {
  blob: string;
  scale: Scale;
}

export interface Camera {
  eye: Vector;
  target: Vector;
  up: Vector;
  vertical_fov_degrees: number;
  width: number;
  height: number;
}

export type Vector = [number, number, number];

export interface Surface {
  name: string;
  elements: number;
  area: number;
  /** Per band; null where it cannot be told. */
  reflectance: (number | null)[];
  exitance: number[] | null;
  irradiance: number[];
  radiosity: number[];
}

export interface Step {
  label: string;
  irradiance: Values[];
}

/** A complex quantity on the elements: its real part times cos φ minus its imaginary part times sin φ is shown. */
export interface Phasor {
  name: string;
  symbol: string;
  component: string;
  unit: string;
  real: Values;
  imaginary: Values;
  magnitude: Values;
}

export interface Model {
  elements: number;
  vertices: number;
  low: Vector;
  high: Vector;
  positions: string;
  sides: string;
  corners: string;
  /** Vertices in the middle of sides of larger elements, each with the ends of the side. */
  hanging: string;
  hanging_count: number;
  faces: string;
  area: Values;
  exposed: string | null;
  /** Linear sRGB of a unit in each band. */
  colours: Vector[];
  exposure: number | null;
  camera: Camera | null;
  surfaces: Surface[];
  surface_of_face: string;
  irradiance: Values[];
  radiosity: (Values | null)[];
  steps: Step[];
  /** What the steps are. */
  steps_title: string;
  scalars: Scalar[];
  phasors: Phasor[];
  links: Links | null;
}

/** What lights the elements most: middles of senders, and of each element their numbers and 255 times their shares. */
export interface Links {
  senders: number;
  centres: string;
  counts: string;
  total: number;
  from: string;
  shares: string;
}

/** A further quantity on the elements. */
export interface Scalar {
  name: string;
  symbol: string;
  unit: string;
  diverging: boolean;
  values: Values;
}

export interface Axis {
  label: string;
  logarithmic: boolean;
}

export interface Series {
  name: string;
  colour: string | null;
  dashed: boolean;
  x: (number | null)[];
  y: (number | null)[];
}

export interface Plot {
  id: string;
  x: Axis[];
  y: Axis;
  /** One list of lines for each choice of the axis across. */
  series: Series[][];
  polar: Round | null;
}

/** How levels over an angle are drawn round a circle. */
export interface Round {
  /** Whether angles run clockwise from the top rather than counter-clockwise from the right. */
  clockwise_from_top: boolean;
  /** Decibels of a decade of the values. */
  per_decade: number;
  /** Quantity and unit of the values themselves. */
  linear: string;
}

export interface Page {
  format: string;
  bands: string[];
  /** Largest relative error of a number on an element, and the grain of positions, m. */
  rounding: number;
  grain: number;
  model: Model | null;
  plots: Plot[];
}

/** The description of the page. */
export function readPage(): Page {
  return JSON.parse(document.getElementById("page")?.textContent ?? "{}") as Page;
}

/** The bytes of an array. */
export async function readBytes(id: string): Promise<Uint8Array> {
  const text = document.getElementById(id)?.textContent ?? "";
  const binary = atob(text);
  const packed = Uint8Array.from(binary, (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** The 16-bit codes of an array, in runs of `run` codes that each begin at 0. */
export async function readWords(id: string, run?: number): Promise<Uint16Array> {
  const bytes = await readBytes(id);
  const count = bytes.length >> 1;
  const words = new Uint16Array(count);
  let last = 0;
  for (let i = 0; i < count; i++) {
    if (run !== undefined && i % run === 0) last = 0;
    const folded = (bytes[i] << 8) | bytes[count + i];
    const difference = (folded >>> 1) ^ -(folded & 1);
    last = (last + difference) & 0xffff;
    words[i] = last;
  }
  return words;
}

/** The integers of an array. */
export async function readVarints(id: string, count: number): Promise<Uint32Array> {
  const bytes = await readBytes(id);
  const found = new Uint32Array(count);
  let at = 0;
  for (let i = 0; i < count; i++) {
    let value = 0;
    let shift = 0;
    for (;;) {
      const byte = bytes[at++];
      value |= (byte & 127) << shift;
      if (byte < 128) break;
      shift += 7;
    }
    found[i] = value >>> 0;
  }
  return found;
}

/** Integers that are stored as folded differences. */
export async function readDifferences(id: string, count: number): Promise<Uint32Array> {
  const folded = await readVarints(id, count);
  let last = 0;
  return folded.map((value) => (last = (last + ((value >>> 1) ^ -(value & 1))) >>> 0));
}

/** Corners of the elements: each is stored as its distance from the next vertex that has not occurred. */
export async function readCorners(id: string, count: number): Promise<Uint32Array> {
  const distances = await readVarints(id, count);
  let fresh = 0;
  return distances.map((distance) => {
    const vertex = fresh - distance;
    if (distance === 0) fresh++;
    return vertex;
  });
}

/** The numbers that codes stand for. */
export async function readValues(values: Values): Promise<Float32Array> {
  const words = await readWords(values.blob);
  const { low, high, levels, signed } = values.scale;
  const step = levels > 1 ? Math.log(high / low) / (levels - 1) : 0;
  const table = new Float32Array(levels + 1);
  for (let code = 1; code <= levels; code++) table[code] = low * Math.exp((code - 1) * step);
  const found = new Float32Array(words.length);
  for (let i = 0; i < words.length; i++) {
    const word = words[i];
    const negative = signed && word >= 0x8000;
    found[i] = negative ? -table[0x10000 - word] : table[word];
  }
  return found;
}
