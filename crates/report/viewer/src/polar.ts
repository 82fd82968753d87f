// Levels over an angle, round a circle: in decibels, or as the values themselves.

import type { Plot, Series } from "./data";
import { format } from "./numbers";
import { colour } from "./theme";

/** Room of the drawing, and the radius of its rim. */
const [WIDTH, HEIGHT, RADIUS] = [560, 470, 190];
/** Decibels from the centre to the rim, and between rings. */
const [REACH, RING] = [40, 10];
const SPACE = "http://www.w3.org/2000/svg";

type Attributes = Record<string, string | number>;

function made(tag: string, attributes: Attributes, text?: string): SVGElement {
  const element = document.createElementNS(SPACE, tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, String(value));
  if (text !== undefined) element.textContent = text;
  return element;
}

/** Rings from the centre to the rim, and what the values are. */
function rings(top: number, decibels: boolean): number[] {
  if (decibels) {
    const rim = Number.isFinite(top) ? Math.ceil(top / RING - 1e-9) * RING : 0;
    return Array.from({ length: REACH / RING + 1 }, (_, i) => rim - REACH + RING * i);
  }
  const high = top > 0 ? top : 1;
  const power = 10 ** Math.floor(Math.log10(high / 5));
  const step = [1, 2, 2.5, 5, 10].map((m) => m * power).find((s) => 5 * s >= high * (1 - 1e-9));
  const one = step ?? high;
  const count = Math.ceil(high / one - 1e-9);
  return Array.from({ length: count + 1 }, (_, i) => one * i);
}

export class Polar {
  private readonly svg: SVGElement;
  private readonly spoke = made("line", {});
  private readonly marks: SVGElement[] = [];
  private readonly numbers: HTMLElement[] = [];
  private readonly angle = document.createElement("td");
  private readonly levels: number[];

  constructor(
    frame: HTMLElement,
    private readonly plot: Plot,
    private readonly decibels: boolean,
    private readonly colours: string[],
  ) {
    const values = this.series.flatMap(({ y }) => y.map((v) => this.value(v)));
    const top = values.filter(Number.isFinite).reduce((a, b) => Math.max(a, b), -Infinity);
    this.levels = rings(top, decibels);
    const label = decibels ? plot.y.label : (plot.polar?.linear ?? "");
    this.svg = made("svg", {
      viewBox: `0 0 ${WIDTH} ${HEIGHT}`,
      role: "img",
      "aria-label": `${label}, round a circle`,
      class: "polar",
    });
    this.svg.append(
      made("text", { x: WIDTH / 2, y: 14, "text-anchor": "middle", fill: colour("--text") }, label),
    );
    this.drawGrid();
    this.series.forEach((series, i) => this.drawLine(series, colours[i]));
    frame.replaceChildren(this.svg, this.legend());
    this.svg.addEventListener("pointermove", (event) => this.point(event as PointerEvent));
    this.svg.addEventListener("pointerleave", () => this.show(null));
    this.show(null);
  }

  private get series(): Series[] {
    return this.plot.series[0];
  }

  /** What a level is drawn as. */
  private value(level: number | null): number {
    if (level === null) return NaN;
    return this.decibels ? level : 10 ** (level / (this.plot.polar?.per_decade ?? 10));
  }

  private share(value: number): number {
    const [centre, rim] = [this.levels[0], this.levels[this.levels.length - 1]];
    return Math.min(1, Math.max(0, (value - centre) / (rim - centre)));
  }

  private place(degrees: number, share: number): [number, number] {
    const radians = (degrees * Math.PI) / 180;
    const [across, up] = this.plot.polar?.clockwise_from_top
      ? [Math.sin(radians), Math.cos(radians)]
      : [Math.cos(radians), Math.sin(radians)];
    return [WIDTH / 2 + share * RADIUS * across, HEIGHT / 2 + 14 - share * RADIUS * up];
  }

  private drawGrid(): void {
    const [line, text] = [colour("--line"), colour("--muted")];
    const [x, y] = this.place(0, 0);
    for (let degrees = 0; degrees < 360; degrees += 30) {
      const [x2, y2] = this.place(degrees, 1);
      this.svg.append(made("line", { x1: x, y1: y, x2, y2, stroke: line }));
      const [at, top] = this.place(degrees, 1.1);
      this.svg.append(
        made("text", { x: at, y: top + 4, "text-anchor": "middle", fill: text }, `${degrees}°`),
      );
    }
    const named = this.plot.polar?.clockwise_from_top ? 15 : 75;
    for (const ring of this.levels.slice(1)) {
      const r = this.share(ring) * RADIUS;
      this.svg.append(made("circle", { cx: x, cy: y, r, fill: "none", stroke: line }));
      const [at, top] = this.place(named, this.share(ring));
      this.svg.append(made("text", { x: at + 3, y: top - 3, fill: text }, format(ring, 3)));
    }
  }

  private drawLine({ x, y }: Series, stroke: string): void {
    const places = x.flatMap((degrees, i) => {
      const value = this.value(y[i]);
      // What is 0 has no level: it is at the centre.
      const share = Number.isNaN(value) ? 0 : this.share(value);
      return degrees === null ? [] : [this.place(degrees, share)];
    });
    const path = places.map(([a, b], i) => `${i ? "L" : "M"}${a.toFixed(1)} ${b.toFixed(1)}`);
    this.svg.append(
      made("path", { d: path.join(""), fill: "none", stroke, "stroke-width": 2, "stroke-linejoin": "round" }),
    );
  }

  /** What the lines are called, and their values at the angle that is pointed at. */
  private legend(): HTMLElement {
    const table = document.createElement("table");
    table.className = "u-legend";
    const row = (name: string, cell: HTMLElement, stroke?: string): void => {
      const made = table.insertRow();
      const head = document.createElement("th");
      head.textContent = name;
      if (stroke) {
        head.style.borderLeft = `12px solid ${stroke}`;
      }
      made.append(head, cell);
    };
    row(this.plot.x[0].label, this.angle);
    this.svg.append(this.spoke);
    this.series.forEach(({ name }, i) => {
      const cell = document.createElement("td");
      row(name, cell, this.colours[i]);
      this.numbers.push(cell);
      const mark = made("circle", { r: 4, fill: this.colours[i] });
      this.marks.push(mark);
      this.svg.append(mark);
    });
    return table;
  }

  private point(event: PointerEvent): void {
    const box = this.svg.getBoundingClientRect();
    const scale = Math.min(box.width / WIDTH, box.height / HEIGHT);
    const [x, y] = this.place(0, 0);
    const across = (event.clientX - box.left - 0.5 * (box.width - scale * WIDTH)) / scale - x;
    const up = y - (event.clientY - box.top - 0.5 * (box.height - scale * HEIGHT)) / scale;
    if (Math.hypot(across, up) > 1.25 * RADIUS) return this.show(null);
    const radians = this.plot.polar?.clockwise_from_top
      ? Math.atan2(across, up)
      : Math.atan2(up, across);
    this.show((radians * 180) / Math.PI);
  }

  /** Shows the points nearest to an angle. */
  private show(degrees: number | null): void {
    let spoke: number | null = null;
    this.series.forEach(({ x, y }, i) => {
      let [least, at] = [Infinity, -1];
      x.forEach((own, k) => {
        if (own === null || degrees === null) return;
        const apart = Math.abs(((((own - degrees) % 360) + 540) % 360) - 180);
        if (apart < least) [least, at] = [apart, k];
      });
      const mark = this.marks[i];
      // Where there is no point within the spacing of lines there is none.
      const found = at >= 0 && least < 15;
      mark.setAttribute("visibility", found ? "visible" : "hidden");
      this.numbers[i].textContent = found ? format(this.value(y[at]), 4) : "–";
      if (!found) return;
      const own = x[at] ?? 0;
      spoke ??= own;
      const value = this.value(y[at]);
      const [cx, cy] = this.place(own, Number.isNaN(value) ? 0 : this.share(value));
      mark.setAttribute("cx", String(cx));
      mark.setAttribute("cy", String(cy));
    });
    this.angle.textContent = spoke === null ? "–" : format(spoke, 5);
    const [[x1, y1], [x2, y2]] = [this.place(spoke ?? 0, 0), this.place(spoke ?? 0, 1)];
    const ends = { x1, y1, x2, y2, stroke: colour("--muted"), "stroke-dasharray": "4 4" };
    for (const [name, value] of Object.entries(ends)) this.spoke.setAttribute(name, String(value));
    this.spoke.setAttribute("visibility", spoke === null ? "hidden" : "visible");
  }
}
