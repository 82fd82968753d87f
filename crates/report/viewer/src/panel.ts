// What the user chooses, and what is shown of it.

import { DIVERGING, gradient, MAP_NAMES, table } from "./colours";
import type { Page } from "./data";
import type { Fields, Quantity } from "./fields";
import type { Geometry } from "./geometry";
import type { Links } from "./links";
import { format, linearTicks, logarithmicTicks, rounded } from "./numbers";
import { showBand } from "./tables";
import { colour, onTheme, toggleTheme } from "./theme";
import type { Picked, View } from "./view";

/** Most elements among which the one under the pointer is sought while it moves. */
const HOVERED = 150_000;
/** Shares of the area that a range chosen by itself may leave out at its ends. */
const OUTLIERS = [0.002, 0.02];
/** Most elements that a range is chosen by. */
const SAMPLED = 20_000;
/** Decades that a logarithmic range chosen by itself spans at most. */
const DECADES = 4;
/** Most surfaces that are listed before a filter is used. */
const LISTED = 500;
/** Inputs that are written into. */
const WRITTEN = ':not([type="checkbox"], [type="radio"], [type="range"])';
/** Seconds of a period of the animation. */
const PERIOD = 2;

function at<E extends HTMLElement>(id: string): E {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no element "${id}"`);
  return found as E;
}

function element<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  text?: string,
): HTMLElementTagNameMap[K] {
  const made = document.createElement(tag);
  if (text !== undefined) made.textContent = text;
  return made;
}

export class Panel {
  private readonly mode = at("modes");
  private readonly quantity = at<HTMLSelectElement>("quantity");
  private readonly band = at<HTMLSelectElement>("band");
  private readonly map = at<HTMLSelectElement>("map");
  private readonly low = at<HTMLInputElement>("low");
  private readonly high = at<HTMLInputElement>("high");
  private readonly log = at<HTMLInputElement>("log");
  private readonly iso = at<HTMLInputElement>("iso");
  private readonly smooth = at<HTMLInputElement>("smooth");
  private readonly lines = at<HTMLInputElement>("mesh");
  private readonly backs = at<HTMLInputElement>("backs");
  private readonly exposure = at<HTMLInputElement>("exposure");
  private readonly step = at<HTMLInputElement>("step");
  private readonly phase = at<HTMLInputElement>("phase");
  private readonly canvas = at<HTMLCanvasElement>("canvas");
  private readonly visible: boolean[];
  private readonly model;
  private range: [number, number] = [0, 1];
  /** Whether the range is the page's choice. */
  private automatic = true;
  private values: Float32Array = new Float32Array();
  private picked: number | null = null;
  private turn = 0;
  private playing = 0;

  constructor(
    private readonly page: Page,
    private readonly geometry: Geometry,
    private readonly fields: Fields,
    private readonly view: View,
    private readonly middle: number,
    private readonly links: Links | null,
  ) {
    if (!page.model) throw new Error("the page has no elements");
    this.model = page.model;
    this.visible = this.model.surfaces.map(() => true);
    this.fill();
    this.listen();
    this.listSurfaces();
    onTheme(() => this.paintTheme());
  }

  /** Shows everything for the first time. */
  async start(): Promise<void> {
    this.paintTheme();
    this.setStates();
    await this.recolour(true);
  }

  private get appearance(): boolean {
    return (
      at<HTMLInputElement>("modes").querySelector<HTMLInputElement>("input:checked")?.value ===
      "appearance"
    );
  }

  private get chosen(): Quantity {
    return this.fields.quantities[Number(this.quantity.value)];
  }

  private fill(): void {
    const { page, model } = this;
    this.fields.quantities.forEach((q, i) =>
      this.quantity.add(new Option(`${q.name} ${q.symbol}`, String(i))),
    );
    page.bands.forEach((band, i) => this.band.add(new Option(band, String(i))));
    this.band.selectedIndex = this.brightest();
    MAP_NAMES.forEach((name) => this.map.add(new Option(name, name)));
    const steps = model.steps.length;
    this.step.max = String(steps);
    this.step.value = String(steps);
    at("row-step").hidden = steps === 0;
    at("step-name").textContent = model.steps_title;
    if (model.colours.length === 0) {
      this.mode.hidden = true;
      this.setMode("false");
    }
    // A current flows on a sheet: it is the same from both sides.
    if (model.phasors.length > 0) {
      this.view.uniforms.bothSides.value = true;
      this.backs.checked = true;
      this.view.setBacks(true);
    }
    this.showStep();
  }

  /** The band in which the surfaces receive most. */
  private brightest(): number {
    const received = this.page.bands.map((_, band) => {
      return this.model.surfaces.reduce((sum, s) => sum + s.area * (s.irradiance[band] ?? 0), 0);
    });
    return received.indexOf(Math.max(...received));
  }

  private setMode(value: string): void {
    this.mode
      .querySelectorAll<HTMLInputElement>("input")
      .forEach((input) => (input.checked = input.value === value));
  }

  private listen(): void {
    const on = (target: HTMLElement, event: string, use: () => void): void =>
      target.addEventListener(event, use);
    on(this.mode, "change", () => void this.recolour(true));
    on(this.quantity, "change", () => this.reset());
    on(this.band, "change", () => this.reset());
    on(this.map, "change", () => this.paintScale());
    on(this.exposure, "input", () => this.paintScale());
    for (const input of [this.low, this.high]) on(input, "change", () => this.readRange());
    on(at("auto"), "click", () => this.reset());
    on(this.log, "change", () => (this.automatic ? this.reset() : this.paintScale()));
    for (const box of [this.iso, this.smooth, this.lines])
      on(box, "change", () => this.paintScale());
    on(this.backs, "change", () => this.view.setBacks(this.backs.checked));
    on(this.step, "input", () => {
      this.showStep();
      void this.recolour(false);
    });
    on(this.phase, "input", () => void this.recolour(false));
    on(at("play"), "click", () => this.play());
    on(at("home"), "click", () => this.view.toHome());
    on(at("fit"), "click", () => this.view.toFit());
    on(at("help"), "click", () => this.help());
    on(at("filter"), "input", () => this.listSurfaces());
    on(at("all"), "click", () => this.showAll(true));
    on(at("none"), "click", () => this.showAll(false));
    this.listenToPointer();
    document.addEventListener("keydown", (event) => this.key(event));
    window.addEventListener(
      "beforeprint",
      () => (at<HTMLImageElement>("print").src = this.view.picture()),
    );
  }

  private reset(): void {
    this.automatic = true;
    void this.recolour(true);
  }

  private help(): void {
    const keys = at("keys");
    keys.hidden = !keys.hidden;
    at("help").ariaExpanded = String(!keys.hidden);
  }

  private showStep(): void {
    const number = Number(this.step.value);
    at("step-text").textContent = this.model.steps[number]?.label ?? "solution";
  }

  /** Computes the colours of elements and vertices. The latest call wins. */
  private async recolour(range: boolean): Promise<void> {
    const turn = ++this.turn;
    const step = Number(this.step.value);
    const [band, phase] = [
      Number(this.band.value || 0),
      (Number(this.phase.value) * Math.PI) / 180,
    ];
    const quantity = this.chosen;
    const scalar = await quantity.read(band, step, phase);
    const colours = this.appearance ? await this.fields.appearance(step) : null;
    if (turn !== this.turn) return;
    if (range) showBand(this.page, band);
    this.values = scalar;
    this.upload(colours ?? scalar, colours ? 3 : 1, scalar);
    if (range && this.automatic) this.chooseRange();
    this.paintScale();
    if (this.picked !== null) await this.showPicked();
  }

  private upload(values: Float32Array, lanes: number, scalar: Float32Array): void {
    const { elements, vertices } = this.view;
    for (let i = 0; i < scalar.length; i++) {
      for (let lane = 0; lane < lanes; lane++)
        elements.values[4 * i + lane] = values[lanes * i + lane];
    }
    this.fields.smooth(values, lanes, vertices.values, 0);
    this.fields.smooth(scalar, 1, vertices.values, 3);
    elements.texture.needsUpdate = vertices.texture.needsUpdate = true;
  }

  /** Elements that are shown, lamps left out where there are others, in the order of their values; some of them where they are many. */
  private sample(): number[] {
    const { surface } = this.geometry;
    const lit = this.model.surfaces.map(
      (s) => this.chosen.banded && (s.exitance?.some((m) => m > 0) ?? false),
    );
    const stride = Math.ceil(this.values.length / SAMPLED);
    const every = Array.from(
      { length: Math.ceil(this.values.length / stride) },
      (_, k) => k * stride,
    );
    const shown = every.filter((i) => this.visible[surface[i]] && Number.isFinite(this.values[i]));
    const dull = shown.filter((i) => !lit[surface[i]]);
    return (dull.length > 0 ? dull : shown).sort((a, b) => this.values[a] - this.values[b]);
  }

  /** A range with round ends that holds nearly all that is shown. */
  private chooseRange(): void {
    const { area } = this.geometry;
    const shown = this.sample();
    const all = shown.reduce((sum, i) => sum + area[i], 0);
    const quantile = (share: number): number => {
      let sum = 0;
      for (const i of shown) if ((sum += area[i]) >= share * all) return this.values[i];
      return shown.length > 0 ? this.values[shown[shown.length - 1]] : 1;
    };
    const [low, high] = [quantile(OUTLIERS[0]), quantile(1 - OUTLIERS[1])];
    if (this.chosen.diverging || low < 0) {
      const largest = rounded(Math.max(-low, high), true) || 1;
      this.range = [-largest, largest];
      this.log.checked = false;
    } else if (this.log.checked) {
      const least = shown.find((i) => this.values[i] > 0);
      const top = rounded(high, true) || 1;
      const bottom = least === undefined ? top / 10 : Math.max(low, this.values[least]);
      this.range = [rounded(Math.min(Math.max(bottom, top / 10 ** DECADES), top / 2), false), top];
    } else {
      // Nearly the same everywhere: zero would hide what there is to see.
      const near = low > 0.6 * high;
      const top = rounded(high, true) || 1;
      this.range = [near ? rounded(low, false) : 0, top];
      if (this.range[0] >= top) this.range = [0, top];
    }
    this.map.value = this.chosen.diverging
      ? DIVERGING
      : this.map.value === DIVERGING
        ? "viridis"
        : this.map.value;
    this.low.value = String(this.range[0]);
    this.high.value = String(this.range[1]);
  }

  private readRange(): void {
    const [low, high] = [this.low, this.high].map((input) => Number(input.value.replace(",", ".")));
    const fits =
      Number.isFinite(low) &&
      Number.isFinite(high) &&
      low < high &&
      !(this.log.checked && low <= 0);
    for (const input of [this.low, this.high]) input.ariaInvalid = String(!fits);
    if (!fits) return;
    this.automatic = false;
    this.range = [low, high];
    this.paintScale();
  }

  /** Colours, lines and legend for values that are there. */
  private paintScale(): void {
    const { uniforms } = this.view;
    const appearance = this.appearance;
    const stops = Number(this.exposure.value);
    uniforms.appearance.value = appearance;
    uniforms.smoothed.value = this.smooth.checked;
    uniforms.meshLines.value = this.lines.checked;
    uniforms.logarithmic.value = this.log.checked;
    uniforms.exposure.value = this.middle * 2 ** stops;
    uniforms.range.value.set(...this.range);
    this.view.setMap(table(this.map.value));
    const ticks = this.ticks();
    this.view.setLevels(!appearance && this.iso.checked ? ticks : []);
    at("exposure-text").textContent =
      `${stops > 0 ? "+" : stops < 0 ? "−" : ""}${Math.abs(stops)} EV`;
    at("phase-text").textContent = `${this.phase.value}°`;
    for (const id of ["row-quantity", "row-map", "row-range", "row-log", "row-iso"])
      at(id).hidden = appearance;
    // What has both signs has no logarithm.
    at("row-log").hidden ||= this.chosen.diverging;
    at("row-exposure").hidden = !appearance;
    at("row-band").hidden = appearance || !this.chosen.banded || this.page.bands.length < 2;
    at("row-phase").hidden =
      appearance || !this.chosen.diverging || this.model.phasors.length === 0;
    this.paintLegend(appearance, ticks);
    this.view.draw();
  }

  private ticks(): number[] {
    const count = at("frame").clientWidth < 500 ? 4 : 8;
    const [low, high] = this.range;
    return this.log.checked ? logarithmicTicks(low, high, count) : linearTicks(low, high, count);
  }

  /** Where a value lies on the scale, from 0 to 1. */
  private share(value: number): number {
    const [low, high] = this.range;
    const f = this.log.checked ? Math.log : Number;
    return Math.min(1, Math.max(0, (f(value) - f(low)) / (f(high) - f(low))));
  }

  private paintLegend(appearance: boolean, ticks: number[]): void {
    const { name, symbol, unit, banded } = this.chosen;
    const band =
      banded && this.page.bands.length > 1
        ? `, band ${this.page.bands[Number(this.band.value || 0)]}`
        : "";
    at("scale").hidden = appearance;
    at("legend-title").textContent = appearance
      ? "Radiosity of all bands as colour; tone curve by Reinhard, exposure by the slider"
      : `${name} ${symbol}${band}${unit ? `, ${unit}` : ""}`;
    if (appearance) return;
    at("ramp").style.background = gradient(this.map.value);
    this.paintEnds();
    at("ticks").replaceChildren(
      ...ticks.map((tick) => {
        const made = element("span", format(tick, 3));
        made.style.left = `${100 * this.share(tick)}%`;
        return made;
      }),
    );
    this.mark();
  }

  /** Shows where there are values beyond the ends of the scale. */
  private paintEnds(): void {
    const { surface } = this.geometry;
    const [low, high] = this.range;
    let [below, above] = [false, false];
    for (let i = 0; i < surface.length && !(below && above); i++) {
      if (!this.visible[surface[i]]) continue;
      below ||= this.values[i] < low * (1 - 1e-6);
      above ||= this.values[i] > high * (1 + 1e-6);
    }
    const bytes = table(this.map.value);
    for (const [id, shown, at_] of [
      ["below", below, 0],
      ["above", above, bytes.length - 4],
    ] as const) {
      const end = at(id);
      end.hidden = !shown;
      end.style.color = `rgb(${bytes.slice(at_, at_ + 3).join(",")})`;
    }
  }

  /** Marks the value of the picked element on the scale. */
  private mark(): void {
    const mark = at("mark");
    const value = this.picked === null ? NaN : this.values[this.picked];
    mark.hidden = !Number.isFinite(value) || (this.log.checked && value <= 0);
    if (!mark.hidden) mark.style.left = `${100 * this.share(value)}%`;
  }

  private paintTheme(): void {
    const back = colour("--back").split(" ").map(Number);
    this.view.uniforms.back.value.set(back[0], back[1], back[2]);
    this.view.setBackground(colour("--stage"));
  }

  /** Tells the programs which elements are hidden or picked. */
  private setStates(): void {
    const { surface } = this.geometry;
    const { values, texture } = this.view.elements;
    for (let i = 0; i < surface.length; i++) values[4 * i + 3] = this.visible[surface[i]] ? 1 : 0;
    if (this.picked !== null && this.visible[surface[this.picked]]) values[4 * this.picked + 3] = 2;
    texture.needsUpdate = true;
    this.view.draw();
  }

  private listenToPointer(): void {
    const { canvas } = this;
    let down: [number, number] = [0, 0];
    canvas.addEventListener("pointerdown", (event) => {
      down = [event.clientX, event.clientY];
      at("tip").hidden = true;
    });
    canvas.addEventListener("pointerup", (event) => {
      const moved = Math.hypot(event.clientX - down[0], event.clientY - down[1]);
      if (moved < 5 && event.button === 0) this.pick(this.under(event));
    });
    canvas.addEventListener("dblclick", (event) => {
      const found = this.under(event);
      if (found) this.view.focus(found.point);
    });
    canvas.addEventListener("pointerleave", () => (at("tip").hidden = true));
    let waiting = false;
    canvas.addEventListener("pointermove", (event) => {
      if (
        waiting ||
        event.buttons > 0 ||
        event.pointerType !== "mouse" ||
        this.values.length > HOVERED
      )
        return;
      waiting = true;
      requestAnimationFrame(() => {
        waiting = false;
        this.tip(event);
      });
    });
  }

  private under(event: MouseEvent): Picked | null {
    return this.view.pick(event.clientX, event.clientY, this.backs.checked);
  }

  private tip(event: MouseEvent): void {
    const tip = at("tip");
    const found = this.under(event);
    tip.hidden = found === null;
    if (!found) return;
    const { symbol, unit } = this.chosen;
    const surface = this.model.surfaces[this.geometry.surface[found.element]];
    tip.textContent = `${surface.name}: ${symbol} = ${format(this.values[found.element])} ${unit}`;
    const box = at("frame").getBoundingClientRect();
    const right = event.clientX - box.left > 0.6 * box.width;
    tip.style.left = right ? "" : `${event.clientX - box.left + 14}px`;
    tip.style.right = right ? `${box.right - event.clientX + 14}px` : "";
    tip.style.top = `${Math.min(event.clientY - box.top + 14, box.height - 40)}px`;
  }

  private pick(found: Picked | null): void {
    this.picked = found?.element ?? null;
    this.setStates();
    void this.showPicked();
  }

  private async showPicked(): Promise<void> {
    this.mark();
    const shares = this.links?.show(this.picked) ?? [];
    const target = at("picked");
    const i = this.picked;
    if (i === null) {
      const hint = element("p", "Click an element to read its numbers.");
      hint.className = "hint";
      target.replaceChildren(hint);
      return;
    }
    const { face, surface, area, exposed } = this.geometry;
    const own = this.model.surfaces[surface[i]];
    const list = element("dl");
    const add = (name: string, value: string, id?: string): void => {
      const shown = element("dd", value);
      if (id) shown.id = id;
      list.append(element("dt", name), shown);
    };
    add("Surface", own.name, "picked-surface");
    add("Element", `${i}`, "picked-element");
    add("Face", `${face[i]}`, "picked-face");
    add("Area", `${format(area[i])} m²`);
    if (exposed[i] < 0.9999) add("Exposed share", `${format(100 * exposed[i], 3)} %`);
    const { symbol, unit, banded } = this.chosen;
    if (!banded) add(symbol, `${format(this.values[i])} ${unit}`, "picked-value");
    const parts: HTMLElement[] = [list];
    if (shares.length > 0) {
      const told = shares.map((share) => `${format(100 * share, 2)} %`).join(", ");
      add("Lit most by", `${told} of E, all bands, along the lines`, "picked-links");
    }
    if (this.model.irradiance.length > 0) parts.push(await this.bandTable(i));
    if (this.picked === i) target.replaceChildren(...parts);
  }

  /** The values of an element and of its face in each band. */
  private async bandTable(i: number): Promise<HTMLElement> {
    const step = Number(this.step.value);
    const own = this.model.surfaces[this.geometry.surface[i]];
    const box = element("div");
    box.className = "scroll";
    const made = element("table");
    const head = made.createTHead().insertRow();
    for (const title of ["Band", "E", "E, face", "B", "M", "ρ"]) head.append(element("th", title));
    const body = made.createTBody();
    for (let band = 0; band < this.page.bands.length; band++) {
      const [e, b] = await Promise.all([
        this.fields.irradiance(band, step),
        this.fields.radiosity(band, step),
      ]);
      const mean = this.fields.faceMean(e, this.geometry.face[i]);
      const row = body.insertRow();
      row.append(element("th", this.page.bands[band]));
      const [m, rho] = [own.exitance?.[band], own.reflectance[band]];
      for (const [of, value] of Object.entries({
        irradiance: e[i],
        face: mean,
        radiosity: b[i],
        exitance: m,
        reflectance: rho,
      })) {
        const cell = row.insertCell();
        cell.textContent = format(value);
        cell.dataset.of = of;
        cell.dataset.value = String(value ?? "");
      }
    }
    const rounding = `Stored with 16 bits: within ${format(100 * this.page.rounding, 2)} %.`;
    const unit = element(
      "p",
      `E, B and M in W/m²: means over the whole element or face. ${rounding}`,
    );
    unit.className = "hint";
    box.append(made);
    const both = element("div");
    both.append(box, unit);
    return both;
  }

  private listSurfaces(): void {
    const wanted = at<HTMLInputElement>("filter").value.toLowerCase();
    const { surfaces } = this.model;
    const fitting = [...surfaces.keys()].filter((i) =>
      surfaces[i].name.toLowerCase().includes(wanted),
    );
    const rows: HTMLElement[] = fitting.slice(0, LISTED).map((i) => this.surfaceRow(i));
    if (fitting.length > LISTED) {
      rows.push(element("p", `${fitting.length - LISTED} more; use the filter.`));
    }
    at("surfaces").replaceChildren(...rows);
    at("filter").hidden = surfaces.length <= 12;
  }

  private surfaceRow(i: number): HTMLElement {
    const { name, elements } = this.model.surfaces[i];
    const label = element("label");
    const box = element("input");
    box.type = "checkbox";
    box.checked = this.visible[i];
    box.addEventListener("change", () => {
      this.visible[i] = box.checked;
      this.setStates();
    });
    const count = element("small", format(elements, 7));
    label.append(box, element("span", name), count);
    label.title = `${name}: ${elements} elements`;
    return label;
  }

  private showAll(shown: boolean): void {
    this.visible.fill(shown);
    this.listSurfaces();
    this.setStates();
  }

  /** Lets the phase run, or stops it. */
  private play(): void {
    const button = at("play");
    cancelAnimationFrame(this.playing);
    const run = button.ariaPressed !== "true";
    button.ariaPressed = String(run);
    button.textContent = run ? "Stop" : "Play";
    const [start, from] = [performance.now(), Number(this.phase.value)];
    const advance = (now: number): void => {
      this.phase.value = String(Math.round(from + (360 * (now - start)) / (1000 * PERIOD)) % 360);
      void this.recolour(false);
      this.playing = requestAnimationFrame(advance);
    };
    if (run) this.playing = requestAnimationFrame(advance);
  }

  private key(event: KeyboardEvent): void {
    const typing =
      event.target instanceof HTMLElement &&
      event.target.matches(`input${WRITTEN}, select, textarea`);
    if (typing || event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key.startsWith("Arrow")) {
      if (document.activeElement !== this.canvas) return;
      this.arrow(event.key.slice(5), event.shiftKey);
    } else if (!this.command(event.key)) {
      return;
    }
    event.preventDefault();
  }

  private arrow(where: string, shift: boolean): void {
    const right = Number(where === "Right") - Number(where === "Left");
    const up = Number(where === "Up") - Number(where === "Down");
    if (shift) this.view.pan(-0.05 * right, -0.05 * up);
    else this.view.turn(-0.1 * right, -0.1 * up);
  }

  private command(key: string): boolean {
    const click = (box: HTMLInputElement): void => box.click();
    const next = (select: HTMLSelectElement): void => {
      select.selectedIndex = (select.selectedIndex + 1) % select.length;
      this.reset();
    };
    const commands: Record<string, () => void> = {
      "+": () => this.view.zoom(0.85),
      "=": () => this.view.zoom(0.85),
      "-": () => this.view.zoom(1 / 0.85),
      a: () => {
        if (this.mode.hidden) return;
        this.setMode(this.appearance ? "false" : "appearance");
        void this.recolour(true);
      },
      q: () => next(this.quantity),
      b: () => next(this.band),
      l: () => click(this.log),
      i: () => click(this.iso),
      m: () => click(this.lines),
      s: () => click(this.smooth),
      k: () => click(this.backs),
      c: () => void this.view.toHome(),
      f: () => this.view.toFit(),
      t: toggleTheme,
      h: () => this.help(),
      "?": () => this.help(),
      Escape: () => this.pick(null),
    };
    const run = commands[key];
    run?.();
    return run !== undefined;
  }
}
