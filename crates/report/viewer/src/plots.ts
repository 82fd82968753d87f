// Curves.

import uPlot from "uplot";
import type { Page, Plot, Series } from "./data";
import { interpolateViridis } from "d3-scale-chromatic";
import { decade, decades, format, logarithmicTicks } from "./numbers";
import { Polar } from "./polar";
import { colour, isDark, onTheme } from "./theme";

/** Lines of the fonts and heights of a plot, pixels. */
const HEIGHT = 320;

export function startPlots(page: Page): void {
  for (const plot of page.plots) {
    const frame = document.getElementById(plot.id);
    if (frame) new Curves(frame, plot);
  }
}

/** Red, green and blue for bands of these names; colours that are told apart for a few lines; a ramp for many. */
function lineColour(name: string, number: number, count: number): string {
  const named: Record<string, string> = {
    r: "--red",
    red: "--red",
    g: "--green",
    green: "--green",
    b: "--blue",
    blue: "--blue",
  };
  const variable = named[name.toLowerCase()];
  if (variable && count === 3) return colour(variable);
  if (count <= 8) return colour(`--series-${number + 1}`);
  const [first, last] = isDark() ? [0.3, 1] : [0, 0.85];
  return interpolateViridis(first + ((last - first) * number) / (count - 1));
}

/** Lines across a logarithmic plot: powers of ten, and more between them where these are few. */
function levels(low: number, high: number): number[] {
  return high / low < 1e3 ? logarithmicTicks(low, high, 8) : decades(low, high, HEIGHT / 36);
}

class Curves {
  private across = 0;
  private logarithmic: boolean;
  private form = "straight";
  private chart: uPlot | null = null;
  private readonly frame: HTMLElement;

  constructor(
    section: HTMLElement,
    private readonly plot: Plot,
  ) {
    this.logarithmic = plot.y.logarithmic;
    this.frame = document.createElement("div");
    this.frame.className = "curves";
    section.append(this.controls(), this.frame);
    new ResizeObserver(() => this.chart?.setSize({ width: this.width(), height: HEIGHT })).observe(
      this.frame,
    );
    onTheme(() => this.make());
    this.make();
  }

  private width(): number {
    return Math.max(240, this.frame.clientWidth);
  }

  private controls(): HTMLElement {
    const bar = document.createElement("div");
    bar.className = "bar";
    if (this.plot.x.length > 1) {
      const select = document.createElement("select");
      select.ariaLabel = "Axis across";
      this.plot.x.forEach((axis, i) => select.add(new Option(`over ${axis.label}`, String(i))));
      select.addEventListener("change", () => {
        this.across = Number(select.value);
        this.make();
      });
      bar.append(select);
    }
    if (this.plot.polar) {
      // Levels are logarithms already.
      bar.append(this.forms());
      return bar;
    }
    const label = document.createElement("label");
    const box = document.createElement("input");
    box.type = "checkbox";
    box.checked = this.logarithmic;
    box.addEventListener("change", () => {
      this.logarithmic = box.checked;
      this.make();
    });
    label.append(box, " logarithmic");
    bar.append(label);
    return bar;
  }

  /** The choice between a straight axis and polar plots. */
  private forms(): HTMLElement {
    const select = document.createElement("select");
    select.ariaLabel = "Form of the plot";
    select.add(new Option("over a straight axis", "straight"));
    select.add(new Option("polar, in decibels", "decibels"));
    select.add(new Option("polar, linear", "linear"));
    select.addEventListener("change", () => {
      this.form = select.value;
      this.make();
    });
    return select;
  }

  private make(): void {
    this.chart?.destroy();
    this.chart = null;
    const series = this.plot.series[this.across];
    if (this.form !== "straight") {
      const colours = series.map(({ name }, i) => lineColour(name, i, series.length));
      new Polar(this.frame, this.plot, this.form === "decibels", colours);
      return;
    }
    this.frame.replaceChildren();
    const axis = this.plot.x[this.across];
    this.chart = new uPlot(
      this.options(series, axis.label, axis.logarithmic),
      this.data(series),
      this.frame,
    );
  }

  private data(series: Series[]): uPlot.AlignedData {
    const positive = (values: (number | null)[], wanted: boolean): (number | null)[] =>
      wanted ? values.map((value) => (value !== null && value > 0 ? value : null)) : values;
    const across = this.plot.x[this.across].logarithmic;
    const tables = series.map(({ x, y }) => {
      const kept = x
        .map((value, i) => [value, y[i]] as const)
        .filter(([v]) => v !== null && (!across || v > 0));
      return [
        kept.map(([v]) => v),
        positive(
          kept.map(([, w]) => w),
          this.logarithmic,
        ),
      ] as uPlot.AlignedData;
    });
    return tables.length === 1 ? tables[0] : uPlot.join(tables);
  }

  private options(series: Series[], label: string, acrossLogarithmic: boolean): uPlot.Options {
    const [text, grid] = [colour("--muted"), colour("--line")];
    const axis = {
      stroke: text,
      grid: { stroke: grid, width: 1 },
      ticks: { stroke: grid, width: 1, size: 6 },
    };
    const font = "12px system-ui, sans-serif";
    const number = (_: uPlot, ticks: (number | null)[]): string[] =>
      ticks.map((v) => (v === null ? "" : format(v, 3)));
    const power = (chart: uPlot, ticks: (number | null)[]): string[] => {
      const few = ticks.some((v) => v !== null && Math.abs(Math.log10(v) % 1) > 1e-9);
      return few ? number(chart, ticks) : ticks.map((v) => (v === null ? "" : decade(v)));
    };
    return {
      width: this.width(),
      height: HEIGHT,
      scales: {
        x: { time: false, distr: acrossLogarithmic ? 3 : 1 },
        y: { distr: this.logarithmic ? 3 : 1 },
      },
      legend: { live: true },
      cursor: { drag: { x: true, y: true, uni: 20 }, focus: { prox: 24 } },
      focus: { alpha: 0.35 },
      series: [
        { label, value: (_, value) => format(value, 4) },
        ...series.map(({ name, colour: own, dashed }, i) => ({
          label: name,
          stroke:
            own ?? (dashed ? text : lineColour(name, i, series.filter((s) => !s.dashed).length)),
          width: dashed ? 1.25 : 2,
          dash: dashed ? [6, 4] : undefined,
          spanGaps: true,
          points: { show: dashed ? false : undefined },
          value: (_: uPlot, value: number | null) => format(value, 4),
        })),
      ],
      axes: [
        {
          ...axis,
          font,
          labelFont: font,
          label,
          labelSize: 22,
          size: 36,
          values: number,
          splits: acrossLogarithmic
            ? (_, __, low, high) => logarithmicTicks(low, high, 8)
            : undefined,
          filter: (_, ticks) => ticks,
        },
        {
          ...axis,
          font,
          labelFont: font,
          label: this.plot.y.label,
          labelSize: 26,
          // As wide as its numbers.
          size: (_, values) =>
            Math.max(62, 16 + 7 * Math.max(0, ...(values ?? []).map((v) => v.length))),
          values: this.logarithmic ? power : number,
          splits: this.logarithmic ? (_, __, low, high) => levels(low, high) : undefined,
          filter: (_, ticks) => ticks,
        },
      ],
    };
  }
}
