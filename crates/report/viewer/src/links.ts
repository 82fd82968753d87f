// The links of the picked element, drawn over the surfaces: a line from what lights it, the wider the more.

import { Vector3 } from "three";
import { readBytes, readVarints, readWords, type Model } from "./data";
import type { Geometry } from "./geometry";
import type { View } from "./view";

const SPACE = "http://www.w3.org/2000/svg";
/** Width of the line of the largest share, and of the least, pixels. */
const [WIDEST, LEAST] = [9, 1];

interface Link {
  centre: Vector3;
  share: number;
}

export class Links {
  private readonly layer = document.createElementNS(SPACE, "svg");
  private shown: { to: Vector3; links: Link[] } | null = null;

  private constructor(
    frame: HTMLElement,
    private readonly geometry: Geometry,
    private readonly view: View,
    private readonly centres: Vector3[],
    private readonly starts: Uint32Array,
    private readonly from: Uint32Array,
    private readonly shares: Uint8Array,
  ) {
    this.layer.setAttribute("class", "links");
    frame.append(this.layer);
    view.onFrame = () => this.draw();
  }

  /** The links that the page carries; none where it has none. */
  static async read(model: Model, geometry: Geometry, view: View): Promise<Links | null> {
    const frame = document.getElementById("frame");
    if (!model.links || !frame) return null;
    const { senders, total } = model.links;
    const [codes, counts, from, shares] = await Promise.all([
      readWords(model.links.centres, Math.max(1, senders)),
      readBytes(model.links.counts),
      readVarints(model.links.from, total),
      readBytes(model.links.shares),
    ]);
    const along = (i: number, axis: number): number =>
      (codes[axis * senders + i] / 65535 - 0.5) * geometry.size[axis];
    const centres = Array.from(
      { length: senders },
      (_, i) => new Vector3(along(i, 0), along(i, 1), along(i, 2)),
    );
    const starts = new Uint32Array(counts.length + 1);
    counts.forEach((count, i) => (starts[i + 1] = starts[i] + count));
    return new Links(frame, geometry, view, centres, starts, from, shares);
  }

  /** Shows the links of an element, or none; tells their shares, the largest first. */
  show(element: number | null): number[] {
    if (element === null) {
      this.shown = null;
      this.draw();
      return [];
    }
    const { corners, starts, positions } = this.geometry;
    const to = new Vector3();
    const [first, end] = [starts[element], starts[element + 1]];
    for (let k = first; k < end; k++) to.add(new Vector3().fromArray(positions, 3 * corners[k]));
    to.divideScalar(Math.max(1, end - first));
    const links: Link[] = [];
    for (let k = this.starts[element]; k < this.starts[element + 1]; k++)
      links.push({ centre: this.centres[this.from[k]], share: this.shares[k] / 255 });
    this.shown = { to, links };
    this.draw();
    return links.map(({ share }) => share);
  }

  private draw(): void {
    const lines: SVGElement[] = [];
    const box = this.layer.getBoundingClientRect();
    const to = this.shown ? this.view.place(this.shown.to) : null;
    const shown = (to && this.shown?.links) || [];
    const most = Math.max(...shown.map(({ share }) => share));
    for (const { centre, share } of shown) {
      const from = this.view.place(centre);
      if (!from || !to) continue;
      const ends = {
        x1: from[0] - box.left,
        y1: from[1] - box.top,
        x2: to[0] - box.left,
        y2: to[1] - box.top,
      };
      // Light on a dark edge, so that it stands out from every colour.
      for (const [name, more] of [
        ["edge", 2],
        ["link", 0],
      ] as const) {
        const line = document.createElementNS(SPACE, "line");
        for (const [end, value] of Object.entries(ends)) line.setAttribute(end, value.toFixed(1));
        line.setAttribute("class", name);
        line.setAttribute("stroke-width", String(Math.max(LEAST, (WIDEST * share) / most) + more));
        lines.push(line);
      }
    }
    this.layer.replaceChildren(...lines);
  }
}
