// Size of a page, time to open it, and time a frame: node test/measure.mjs report.html …
import { statSync } from "node:fs";
import { resolve } from "node:path";
import { launch, open } from "./browser.mjs";

/** Turns that are timed. */
const FRAMES = 10;

for (const path of process.argv.slice(2).map((name) => resolve(name))) {
  const browser = await launch();
  const { page, seconds } = await open(browser, path);
  const megabytes = statSync(path).size / 1e6;
  const opened = `${path}: ${megabytes.toFixed(2)} MB, open in ${seconds.toFixed(2)} s`;
  if ((await page.locator("#canvas").count()) === 0) {
    console.log(opened);
    await browser.close();
    continue;
  }
  const drawn = await page.evaluate(async (frames) => {
    const canvas = document.getElementById("canvas");
    const box = canvas.getBoundingClientRect();
    const pixel = new Uint8Array(4);
    const press = (key) =>
      canvas.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
    canvas.focus();
    const started = performance.now();
    for (let i = 0; i < frames; i++) {
      press("ArrowLeft");
      await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
      // Reading a pixel waits until the frame is drawn.
      const gl = canvas.getContext("webgl2");
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    }
    return {
      seconds: (performance.now() - started) / 1000 / frames,
      width: box.width,
      height: box.height,
    };
  }, FRAMES);
  const size = `${Math.round(drawn.width)} × ${Math.round(drawn.height)}`;
  console.log(
    `${opened}, ${(1000 * drawn.seconds).toFixed(0)} ms a frame at ${size}`,
  );
  await browser.close();
}
