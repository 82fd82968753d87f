// A headless Chromium that draws in software and may reach no network.
import { existsSync } from "node:fs";
import { chromium } from "playwright-core";

/** Where Debian and others put Chromium; the variable goes first. */
const PLACES = [
  process.env.FREDHOLM_CHROMIUM,
  "/usr/bin/chromium",
  "/usr/bin/chromium-browser",
  "/usr/bin/google-chrome",
  "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
];

const SOFTWARE = [
  "--no-sandbox",
  "--disable-dev-shm-usage",
  "--use-gl=angle",
  "--use-angle=swiftshader",
  "--enable-unsafe-swiftshader",
];

export function findBrowser() {
  return PLACES.find((path) => path && existsSync(path));
}

export async function launch(more = []) {
  return chromium.launch({
    executablePath: findBrowser(),
    headless: true,
    args: [...SOFTWARE, ...more],
  });
}

/** Opens a page of the disk; what it asks of the network and what it complains of is kept. */
export async function open(browser, path, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, ...options });
  const page = await context.newPage();
  const [requests, errors] = [[], []];
  page.on("request", (request) => {
    if (!/^(file|data|blob):/.test(request.url())) requests.push(request.url());
  });
  page.on("console", (message) => {
    if (
      ["error", "warning"].includes(message.type()) &&
      !/GPU stall due to ReadPixels/.test(message.text())
    )
      errors.push(message.text());
  });
  page.on("pageerror", (error) => errors.push(String(error)));
  const started = performance.now();
  await page.goto(`file://${path}`);
  await page.waitForSelector("html[data-ready]", { timeout: 120_000, state: "attached" });
  return { page, requests, errors, seconds: (performance.now() - started) / 1000 };
}
