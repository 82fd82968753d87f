// Colour maps: viridis, inferno and cividis are perceptually uniform; blue to red is for what has
// two signs.

import {
  interpolateCividis,
  interpolateInferno,
  interpolateRdBu,
  interpolateViridis,
} from "d3-scale-chromatic";

const SIZE = 256;

const MAPS: Record<string, (t: number) => string> = {
  viridis: interpolateViridis,
  inferno: interpolateInferno,
  cividis: interpolateCividis,
  grey: (t) => {
    const level = Math.round(255 * t);
    return `rgb(${level},${level},${level})`;
  },
  "blue to red": (t) => interpolateRdBu(1 - t),
};

export const MAP_NAMES = Object.keys(MAPS);
export const DIVERGING = "blue to red";

/** A map as `SIZE` colours of four bytes. */
export function table(name: string): Uint8Array {
  const map = MAPS[name] ?? interpolateViridis;
  const bytes = new Uint8Array(4 * SIZE);
  for (let i = 0; i < SIZE; i++) bytes.set([...channels(map(i / (SIZE - 1))), 255], 4 * i);
  return bytes;
}

function channels(colour: string): [number, number, number] {
  if (colour.startsWith("#")) {
    const code = Number.parseInt(colour.slice(1), 16);
    return [code >> 16, (code >> 8) & 255, code & 255];
  }
  const [r, g, b] = (colour.match(/[\d.]+/g) ?? []).map(Number);
  return [r, g, b];
}

/** A map as a gradient of the style sheet, from left to right. */
export function gradient(name: string): string {
  const bytes = table(name);
  const stops: string[] = [];
  for (let i = 0; i < SIZE; i += 15)
    stops.push(`rgb(${bytes[4 * i]},${bytes[4 * i + 1]},${bytes[4 * i + 2]})`);
  return `linear-gradient(to right, ${stops.join(", ")})`;
}
