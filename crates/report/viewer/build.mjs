// Bundles the page: dist/viewer.js and dist/viewer.css, the same bytes for the same lock file.
import { readFileSync, writeFileSync } from "node:fs";
import { build } from "esbuild";

const common = {
  bundle: true,
  minify: true,
  target: "es2022",
  charset: "utf8",
  logLevel: "warning",
};
const { metafile } = await build({
  ...common,
  metafile: true,
  entryPoints: ["src/main.ts"],
  outfile: "dist/viewer.js",
  format: "iife",
  legalComments: "none",
});
await build({
  ...common,
  entryPoints: ["src/style.css"],
  outfile: "dist/viewer.css",
  legalComments: "none",
});

// The licence of every package in the bundle goes with it.
const used = Object.values(metafile.outputs)[0].inputs;
const packages = new Set(
  Object.entries(used)
    .filter(([, { bytesInOutput }]) => bytesInOutput > 0)
    .map(([path]) => path.match(/^node_modules\/((?:@[^/]+\/)?[^/]+)/)?.[1])
    .filter((name) => name !== undefined),
);
const notice = (name) => {
  const folder = `node_modules/${name}`;
  const { version, license } = JSON.parse(readFileSync(`${folder}/package.json`, "utf8"));
  const text = readFileSync(`${folder}/LICENSE`, "utf8").trim();
  return `${name} ${version} (${license})\n\n${text}\n`;
};
const rule = `\n${"-".repeat(72)}\n\n`;
writeFileSync("dist/LICENSES.txt", [...packages].sort().map(notice).join(rule));
