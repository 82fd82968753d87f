// A result as a page: surfaces in three dimensions, curves and tables, from what the page itself
// carries.

import { readPage, type Camera, type Model, type Page } from "./data";
import { Fields } from "./fields";
import { readGeometry, type Geometry } from "./geometry";
import { Links } from "./links";
import { Panel } from "./panel";
import { startPlots } from "./plots";
import { startTables } from "./tables";
import { startTheme } from "./theme";
import { View } from "./view";

/** Says what does not work, where everybody sees it. */
function fault(text: string): void {
  const notice = document.getElementById("fault");
  if (!notice) return;
  notice.textContent = text;
  notice.hidden = false;
  document.documentElement.classList.add("flat");
}

function hasWebGl(): boolean {
  return document.createElement("canvas").getContext("webgl2") !== null;
}

/** A camera in front of everything, for a scene without one. */
function framing({ size, centre }: Geometry): Camera {
  const reach = 1.6 * Math.hypot(...size) || 1;
  const direction = [0.55, -0.72, 0.42];
  const eye = centre.map((c, axis) => c + reach * direction[axis]) as [number, number, number];
  return { eye, target: centre, up: [0, 0, 1], vertical_fov_degrees: 40, width: 4, height: 3 };
}

async function startModel(page: Page, model: Model): Promise<void> {
  if (!hasWebGl()) {
    fault(
      "This browser offers no WebGL 2: the surfaces cannot be turned. The picture, curves and tables are complete.",
    );
    return;
  }
  if (typeof DecompressionStream === "undefined") {
    fault(
      "This browser cannot unpack the elements (it has no DecompressionStream): the picture and tables are complete.",
    );
    return;
  }
  const geometry = await readGeometry(model);
  const fields = new Fields(model, geometry);
  const canvas = document.getElementById("canvas") as HTMLCanvasElement;
  const view = new View(canvas, geometry, model.camera ?? framing(geometry));
  const middle = model.colours.length > 0 ? await fields.exposure() : 1;
  const links = await Links.read(model, geometry, view);
  const panel = new Panel(page, geometry, fields, view, middle, links);
  await panel.start();
  view.render();
  document.documentElement.classList.add("solid");
}

async function start(): Promise<void> {
  const began = performance.now();
  const page = readPage();
  startTheme();
  startTables();
  startPlots(page);
  if (page.model) await startModel(page, page.model);
  performance.measure("fredholm: shown", { start: began, end: performance.now() });
  document.documentElement.dataset.ready = "";
}

start().catch((error: unknown) => fault(`The page could not be shown: ${String(error)}`));
