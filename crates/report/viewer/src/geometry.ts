// The elements of a mesh as triangles.

import { readBytes, readCorners, readDifferences, readValues, readWords, type Model } from "./data";

/** Elements over shared vertices. Positions are in metres from the middle of the box around the mesh. */
export interface Geometry {
  positions: Float32Array;
  /** Positions as they are stored: three codes a vertex. */
  codes: Uint16Array;
  size: [number, number, number];
  centre: [number, number, number];
  /** Corners of all elements, and where those of each element begin. */
  corners: Uint32Array;
  starts: Uint32Array;
  triangles: number;
  face: Uint32Array;
  surface: Uint32Array;
  /** m². */
  area: Float32Array;
  /** Exposed share of each element. */
  exposed: Float32Array;
  /** Vertices in the middle of sides of larger elements, each with the ends of the side. */
  hanging: Uint32Array;
}

export async function readGeometry(model: Model): Promise<Geometry> {
  const [sides, axes, face, surfaceOfFace, area, exposed, hanging] = await Promise.all([
    readBytes(model.sides),
    readWords(model.positions, model.vertices),
    readDifferences(model.faces, model.elements),
    readBytes(model.surface_of_face),
    readValues(model.area),
    model.exposed ? readWords(model.exposed) : null,
    readDifferences(model.hanging, 3 * model.hanging_count),
  ]);
  const starts = new Uint32Array(model.elements + 1);
  for (let i = 0; i < model.elements; i++) starts[i + 1] = starts[i] + sides[i];
  const corners = await readCorners(model.corners, starts[model.elements]);
  const surfaces = new Uint32Array(surfaceOfFace.buffer, 0, surfaceOfFace.length >> 2);
  const size = [0, 1, 2].map((axis) => model.high[axis] - model.low[axis]) as Geometry["size"];
  const centre = [0, 1, 2].map(
    (axis) => 0.5 * (model.high[axis] + model.low[axis]),
  ) as Geometry["centre"];
  const codes = new Uint16Array(3 * model.vertices);
  const positions = new Float32Array(3 * model.vertices);
  for (let axis = 0; axis < 3; axis++) {
    for (let vertex = 0; vertex < model.vertices; vertex++) {
      const code = axes[axis * model.vertices + vertex];
      codes[3 * vertex + axis] = code;
      positions[3 * vertex + axis] = (code / 65535 - 0.5) * size[axis];
    }
  }
  return {
    positions,
    codes,
    size,
    centre,
    corners,
    starts,
    triangles: corners.length - 2 * model.elements,
    face,
    surface: face.map((index) => surfaces[index]),
    area,
    exposed: exposed
      ? Float32Array.from(exposed, (code) => code / 65535)
      : new Float32Array(model.elements).fill(1),
    hanging,
  };
}

/** What the graphics processor draws: three corners a triangle. */
export interface Corners {
  /** Place in the box, and which sides of the triangle are sides of the element. */
  place: Uint16Array;
  element: Uint32Array;
  vertex: Uint32Array;
}

/** Cuts the elements into triangles. The fourth code of a corner is its number, plus 4 times the inner sides as bits. */
export function triangulate(geometry: Geometry): Corners {
  const { corners, starts, codes, triangles } = geometry;
  const place = new Uint16Array(12 * triangles);
  const element = new Uint32Array(3 * triangles);
  const vertex = new Uint32Array(3 * triangles);
  let at = 0;
  for (let i = 0; i + 1 < starts.length; i++) {
    const count = starts[i + 1] - starts[i];
    for (let k = 1; k + 1 < count; k++) {
      // The side opposite to corner c of (0, k, k + 1) is within the element for c = 1 and c = 2,
      // but for the ends of the fan.
      const inner = (k > 1 ? 4 : 0) | (k + 2 < count ? 2 : 0);
      const triangle = [0, k, k + 1];
      for (let c = 0; c < 3; c++) {
        const v = corners[starts[i] + triangle[c]];
        element[at] = i;
        vertex[at] = v;
        place.set([codes[3 * v], codes[3 * v + 1], codes[3 * v + 2], c | (inner << 2)], 4 * at);
        at++;
      }
    }
  }
  return { place, element, vertex };
}
