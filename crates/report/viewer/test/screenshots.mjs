// Screenshots of a page, to look at: node test/screenshots.mjs report.html folder
import { mkdirSync } from "node:fs";
import { resolve } from "node:path";
import { launch, open } from "./browser.mjs";

const [report, folder] = process.argv.slice(2).map((path) => resolve(path));
mkdirSync(folder, { recursive: true });
const browser = await launch();
for (const [name, width, height] of [
  ["wide", 1280, 800],
  ["phone", 390, 844],
]) {
  for (const colorScheme of ["light", "dark"]) {
    const { page, errors, seconds } = await open(browser, report, {
      viewport: { width, height },
      colorScheme,
    });
    await page.screenshot({ path: `${folder}/${name}-${colorScheme}.png` });
    const solid = await page.locator("html.solid").count();
    if (solid) {
      await page.locator("#modes input[value=false]").check({ force: true });
      await page.waitForTimeout(500);
      const box = await page.locator("#canvas").boundingBox();
      await page.mouse.click(box.x + 0.5 * box.width, box.y + 0.8 * box.height);
      await page.waitForTimeout(500);
      await page.screenshot({ path: `${folder}/${name}-${colorScheme}-false.png` });
    }
    await page.screenshot({ path: `${folder}/${name}-${colorScheme}-full.png`, fullPage: true });
    console.log(name, colorScheme, `${seconds.toFixed(2)} s`, errors);
    await page.close();
  }
}
await browser.close();
