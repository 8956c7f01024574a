// The page and its script as one C++ file: node build.mjs OUT.cpp
//
// Runs in a folder with node_modules beside it (export/web/bundle.cmake makes one in the build
// folder, so that the sources stay clean).
import { build } from "esbuild";
import { createHash } from "node:crypto";
import { readFile, writeFile } from "node:fs/promises";

const read = (name) => readFile(new URL(name, import.meta.url), "utf8");

/** Adjacent literals of a C++ string: every byte that is not plain ASCII as three octal digits. */
function literals(text) {
  const bytes = Buffer.from(text, "utf8");
  const lines = [];
  for (let at = 0; at < bytes.length; at += 2048) {
    let line = "";
    for (const b of bytes.subarray(at, at + 2048))
      line += b >= 32 && b < 127 && b !== 34 && b !== 92 && b !== 63
        ? String.fromCharCode(b) : `\\${b.toString(8).padStart(3, "0")}`;
    lines.push(`"${line}"`);
  }
  return lines.join("\n");
}

const licence = await read("node_modules/three/LICENSE");
const { version } = JSON.parse(await read("node_modules/three/package.json"));
const { outputFiles } = await build({
  entryPoints: [new URL("view.js", import.meta.url).pathname],
  bundle: true, minify: true, write: false, format: "iife", target: "es2022", legalComments: "none",
  banner: { js: `/*!\nThis page contains three.js ${version}, https://threejs.org\n\n${licence.trim()}\n*/` },
});
const bundled = (await read("page.html")).replace("//bundle", () => outputFiles[0].text.trim());
/** As a Content-Security-Policy names the page's only script or style: any other is not run. */
function hash(element) {
  const [, text] = bundled.match(new RegExp(`<${element}>([^]*?)</${element}>`));
  return `sha256-${createHash("sha256").update(text).digest("base64")}`;
}
const page = bundled.replace("script-hash", () => hash("script")).replace("style-hash", () => hash("style"));
const [before, after] = page.split("<!--data-->");
await writeFile(process.argv[2], `// Made by export/web/build.mjs.
#include "luxel/export/view_template.h"

#pragma GCC diagnostic ignored "-Woverlength-strings"

namespace luxel::export_ {

std::string_view view_page_before_data() {
  static constexpr char kText[] =
${literals(before)};
  return {kText, sizeof kText - 1};
}

std::string_view view_page_after_data() {
  static constexpr char kText[] =
${literals(after)};
  return {kText, sizeof kText - 1};
}

}  // namespace luxel::export_
`);
