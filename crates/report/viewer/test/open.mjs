// Opens the pages of result folders in a headless browser and tries all that each has:
//
//     node test/open.mjs FOLDER … --pick FOLDER …
//
// Those behind --pick are only opened and picked from: software draws large ones slowly.
//
// The numbers of a picked element are compared with faces.csv or crosscheck.csv of the same folder. Nothing may be
// asked of the network, nothing complained of, no picture blank.
import assert from "node:assert/strict";
import { existsSync, readFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { launch, open } from "./browser.mjs";

let folder = "";
let path = "";

/** A table of comma-separated values without quoted commas. */
function table(name) {
  const [head, ...rows] = readFileSync(join(folder, name), "utf8")
    .trim()
    .split("\n")
    .map((line) => line.split(","));
  return rows.map((row) => Object.fromEntries(row.map((value, i) => [head[i], value])));
}

/** The canvas as it is: how many colours it has, and all its bytes to compare. */
async function picture(page) {
  await page.evaluate(
    () => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))),
  );
  await page.waitForTimeout(150);
  const data = await page.evaluate(() => document.getElementById("canvas").toDataURL());
  const colours = await page.evaluate(async () => {
    const source = document.getElementById("canvas");
    const copy = document.createElement("canvas");
    [copy.width, copy.height] = [source.width, source.height];
    const context = copy.getContext("2d");
    context.drawImage(source, 0, 0);
    const bytes = new Uint32Array(context.getImageData(0, 0, copy.width, copy.height).data.buffer);
    return new Set(bytes).size;
  });
  return { data, colours };
}

/** Clicks until an element is hit. */
async function pick(page) {
  const box = await page.locator("#canvas").boundingBox();
  for (const [x, y] of [
    [0.5, 0.75],
    [0.3, 0.5],
    [0.7, 0.4],
    [0.5, 0.5],
  ]) {
    await page.mouse.click(box.x + x * box.width, box.y + y * box.height);
    await page.waitForTimeout(200);
    if (await page.locator("#picked-element").count()) return;
  }
  assert.fail("no element was hit");
}

/** Compares all bands of the face of the picked element with faces.csv. */
async function compare(page) {
  const face = await page.locator("#picked-face").textContent();
  const surface = await page.locator("#picked-surface").textContent();
  const row = table("faces.csv")[Number(face)];
  assert.equal(surface, row.surface);
  const { bands, rounding } = await page.evaluate(() =>
    JSON.parse(document.getElementById("page").textContent),
  );
  assert.ok(rounding < 5e-4, `the values are rounded by ${rounding}`);
  const cells = page.locator('#picked td[data-of="face"]');
  assert.equal(await cells.count(), bands.length);
  for (const [i, band] of bands.entries()) {
    const [found, expected] = [
      Number(await cells.nth(i).getAttribute("data-value")),
      Number(row[`irradiance_${band}`]),
    ];
    const error = Math.abs(found - expected);
    // Elements below the face are rounded one by one, and held in single precision.
    assert.ok(
      error <= (2 * rounding + 1e-6) * Math.abs(expected),
      `face ${face}, band ${band}: ${found}, not ${expected}`,
    );
  }
  console.log(`face ${face} of ${surface}: ${bands.length} bands as in faces.csv`);
}

/** A number as the page writes it, such as −7.67 × 10⁻⁴, before its unit. */
function read(text) {
  const plain = text
    .replaceAll("−", "-")
    .replace(/ × 10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)/, (_, power) => {
      return `e${[...power].map((c) => "-0123456789"["⁻⁰¹²³⁴⁵⁶⁷⁸⁹".indexOf(c)]).join("")}`;
    });
  return Number.parseFloat(plain);
}

/** Compares what is known of the picked element: bands, a score, or a number at least. */
async function told(page) {
  if (existsSync(join(folder, "faces.csv"))) return compare(page);
  const value = read(await page.locator("#picked-value").textContent());
  assert.ok(Number.isFinite(value), "there is no number");
  if (!existsSync(join(folder, "crosscheck.csv"))) return;
  const face = await page.locator("#picked-face").textContent();
  const row = table("crosscheck.csv").find((row) => row.face === face);
  assert.equal(await page.locator("#picked-surface").textContent(), row.surface);
  const [found, expected] = [value, Number(row.z)];
  assert.ok(Math.abs(found - expected) <= 1e-3 * Math.max(1, Math.abs(expected)), `${found}, not ${expected}`);
  console.log(`face ${face}: the score of crosscheck.csv`);
}

/** Something must change in the picture. */
async function changes(page, what, act) {
  const before = await picture(page);
  await act();
  const after = await picture(page);
  assert.ok(after.colours > 8, `${what}: the picture is blank`);
  assert.ok(after.data !== before.data, `${what}: nothing changed`);
}

async function set(page, id, value) {
  await page.locator(id).evaluate((input, value) => {
    input.value = value;
    input.dispatchEvent(new Event("input"));
    input.dispatchEvent(new Event("change"));
  }, value);
}

async function controls(page) {
  assert.ok((await picture(page)).colours > 30, "the picture is blank");
  if (await page.locator("#exposure").isVisible()) {
    await changes(page, "exposure", () => set(page, "#exposure", "1.5"));
    await changes(page, "false colour", () =>
      page.locator("#modes input[value=false]").check({ force: true }),
    );
  }
  const quantities = await page.locator("#quantity option").count();
  if (quantities > 1)
    await changes(page, "quantity", () => page.locator("#quantity").selectOption({ index: 1 }));
  const title = await page.locator("#legend-title").textContent();
  if (await page.locator("#band").isVisible()) {
    await changes(page, "band", () => page.locator("#band").selectOption({ index: 1 }));
    assert.notEqual(await page.locator("#legend-title").textContent(), title);
  }
  if (await page.locator("#log").isVisible()) {
    await changes(page, "logarithm", () => page.locator("#log").check());
    await page.locator("#log").uncheck();
  }
  await changes(page, "isolines", () => page.locator("#iso").check());
  await changes(page, "mesh lines", () => page.locator("#mesh").check());
  await changes(page, "smooth", () => page.locator("#smooth").uncheck());
  await changes(page, "colours", () => page.locator("#map").selectOption("inferno"));
  const [low, high] = await Promise.all(
    ["#low", "#high"].map(async (end) => Number(await page.locator(end).inputValue())),
  );
  await changes(page, "range", () => set(page, "#high", String(0.4 * low + 0.6 * high)));
  await set(page, "#low", "1e9");
  assert.equal(await page.locator("#low").getAttribute("aria-invalid"), "true");
  await page.locator("#auto").click();
  if (await page.locator("#step").isVisible())
    await changes(page, "step", () => set(page, "#step", "0"));
  for (let i = 0; i < quantities && !(await page.locator("#phase").isVisible()); i++)
    await page.locator("#quantity").selectOption({ index: i });
  if (await page.locator("#phase").isVisible()) {
    console.log("a phase");
    await changes(page, "phase", () => set(page, "#phase", "90"));
    await page.locator("#play").click();
    await changes(page, "animation", () => page.waitForTimeout(600));
    await page.locator("#play").click();
  }
  await changes(page, "hidden surface", () => page.locator("#surfaces input").first().uncheck());
  await page.locator("#all").click();
}

async function keyboard(page) {
  await page.locator("#canvas").focus();
  await changes(page, "arrow", () => page.keyboard.press("ArrowLeft"));
  await changes(page, "plus", () => page.keyboard.press("+"));
  await changes(page, "camera", () => page.keyboard.press("c"));
  await changes(page, "backs", async () => {
    await page.keyboard.press("f");
    await page.keyboard.press("k");
    for (let i = 0; i < 12; i++) await page.keyboard.press("ArrowRight");
  });
  await page.keyboard.press("h");
  assert.ok(await page.locator("#keys").isVisible());
  await page.keyboard.press("h");
  await page.keyboard.press("c");
}

async function drag(page) {
  const box = await page.locator("#canvas").boundingBox();
  await changes(page, "drag", async () => {
    await page.mouse.move(box.x + 200, box.y + 200);
    await page.mouse.down();
    await page.mouse.move(box.x + 300, box.y + 220, { steps: 4 });
    await page.mouse.up();
  });
  await changes(page, "scroll", () => page.mouse.wheel(0, -300));
}

async function theme(page) {
  const ground = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  const before = await ground();
  const turn = () => page.locator("#theme").click();
  if (await page.locator("html.solid").count()) await changes(page, "theme", turn);
  else await turn();
  assert.notEqual(await ground(), before);
}

async function tables(page) {
  for (const sortable of await page.locator("table.sortable").all()) {
    const column = sortable.locator("tbody tr td:nth-child(2)");
    const values = async () =>
      await column.evaluateAll((cells) => cells.map((cell) => Number(cell.dataset.value)));
    if ((await values()).some((value) => Number.isNaN(value))) continue;
    const head = sortable.locator("thead th").nth(1).locator("button");
    await head.click();
    const upwards = await values();
    assert.deepEqual(
      upwards,
      [...upwards].sort((a, b) => a - b),
    );
    await head.click();
    assert.deepEqual(
      await values(),
      [...upwards].sort((a, b) => b - a),
    );
  }
}

/** Every curve is drawn, and tells its numbers to who points at it. */
async function curves(page) {
  const plots = await page.locator(".plot canvas").all();
  assert.ok(plots.length > 0, "there is no curve");
  for (const plot of plots) {
    await plot.scrollIntoViewIfNeeded();
    const colours = await plot.evaluate((canvas) => {
      const bytes = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
      return new Set(new Uint32Array(bytes.buffer)).size;
    });
    assert.ok(colours > 2, "a plot is blank");
  }
  const said = () => page.locator(".u-legend").allTextContents();
  const silent = JSON.stringify(await said());
  const over = page.locator(".u-over").first();
  await over.scrollIntoViewIfNeeded();
  const box = await over.boundingBox();
  for (const share of [0.5, 0.1, 0.3, 0.7, 0.9]) {
    await page.mouse.move(box.x + share * box.width, box.y + 0.5 * box.height);
    await page.waitForTimeout(100);
    if (JSON.stringify(await said()) !== silent) return;
  }
  assert.fail("no number beside the pointer");
}

/** A page opens, shows something, and tells what an element has. */
async function briefly(browser) {
  const { page, requests, errors, seconds } = await open(browser, path);
  await pick(page);
  await told(page);
  assert.ok((await picture(page)).colours > 30, "the picture is blank");
  assert.deepEqual([requests, errors], [[], []]);
  console.log(`${folder}: opened in ${seconds.toFixed(2)} s; no request, no complaint`);
}

async function everything(browser) {
  const { page, requests, errors, seconds } = await open(browser, path);
  const isSolid = (await page.locator("#canvas").count()) > 0;
  if (isSolid) {
    assert.ok(await page.locator("html.solid").count(), "the surfaces are not shown");
    await pick(page);
    await told(page);
    for (const part of [controls, keyboard, drag]) await part(page);
    await pick(page);
    await told(page);
  }
  for (const part of [theme, tables, curves]) await part(page);
  assert.deepEqual(requests, [], "the page asks for something");
  assert.deepEqual(errors, [], "the page complains");
  console.log(`${folder}: opened in ${seconds.toFixed(2)} s; no request, no complaint`);
  await page.context().close();
}

async function narrow(browser) {
  const { page, errors } = await open(browser, path, {
    viewport: { width: 390, height: 844 },
    hasTouch: true,
  });
  const width = await page.evaluate(() => document.documentElement.scrollWidth);
  assert.ok(width <= 390, `the page is ${width} pixels wide on 390`);
  if (await page.locator("#canvas").count()) assert.ok((await picture(page)).colours > 8);
  assert.deepEqual(errors, []);
  await page.context().close();
}

/** Without WebGL and without scripts there is still a page. */
async function fallbacks() {
  const plain = await launch(["--disable-3d-apis"]);
  const { page, requests, errors } = await open(plain, path);
  const isSolid = (await page.locator("#canvas").count()) > 0;
  const pictured = (await page.locator("img.picture").count()) > 0;
  if (isSolid) assert.ok((await page.locator("#fault").textContent()).includes("WebGL"));
  if (pictured) assert.ok(await page.locator("img.picture").isVisible());
  const tables = await page.locator("table.sortable").count();
  if (tables > 0) assert.ok(await page.locator("table.sortable").first().isVisible());
  assert.deepEqual([requests, errors.filter((text) => !/WebGL/i.test(text))], [[], []]);
  const still = await plain.newContext({ javaScriptEnabled: false });
  const tab = await still.newPage();
  await tab.goto(`file://${path}`);
  if (pictured) assert.ok(await tab.locator("img.picture").isVisible());
  const rows = await tab.locator("table.sortable tbody tr").count();
  assert.ok(rows > 0 || tables === 0);
  assert.ok(await tab.locator("h1").first().isVisible());
  await plain.close();
}

let picked = false;
for (const name of process.argv.slice(2)) {
  if (name === "--pick") {
    picked = true;
    continue;
  }
  folder = resolve(name);
  path = join(folder, "report.html");
  const browser = await launch();
  if (picked) {
    await briefly(browser);
    await browser.close();
    continue;
  }
  await everything(browser);
  await narrow(browser);
  await browser.close();
  await fallbacks();
}
console.log("all is well");
