// Puts .glb and .gltf files before the Khronos glTF validator; exits with 1 when one has errors or warnings.
//
//   npm install --prefix tools
//   node tools/validate_gltf.mjs baked/baked.glb ...
import { readFile } from "node:fs/promises";
import path from "node:path";
import validator from "gltf-validator";

const severities = ["error", "warning", "information", "hint"];
const files = process.argv.slice(2);
if (files.length === 0) {
  console.error("usage: node tools/validate_gltf.mjs FILE...");
  process.exit(2);
}

let failed = false;
for (const file of files) {
  const bytes = new Uint8Array(await readFile(file));
  const beside = (uri) =>
    readFile(path.resolve(path.dirname(file), decodeURIComponent(uri))).then((b) => new Uint8Array(b));
  const { issues } = await validator.validateBytes(bytes, {
    uri: path.basename(file),
    maxIssues: 0, // all: hints would take the places of warnings
    externalResourceFunction: beside,
  });
  failed ||= issues.numErrors + issues.numWarnings > 0;
  console.log(`${file}: ${issues.numErrors} errors, ${issues.numWarnings} warnings`);
  for (const issue of issues.messages.filter(({ severity }) => severity < 2).slice(0, 100))
    console.log(`  ${severities[issue.severity]} ${issue.code} at ${issue.pointer}: ${issue.message}`);
}
process.exit(failed ? 1 : 0);
