// Takes pictures of pages in headless Chromium, and says which requests each page made.
//
//   node tools/screenshot.mjs [--root FOLDER]... [--size 960x720] PAGE OUT.png [[--size WxH] PAGE OUT.png]...
//
// PAGE is a file, or with --root a path on a server of those folders (the first that has a file
// gives it). The page is ready when the promise window.luxelReady is. Prints a line for each page, {"requests":
// [...], "messages": [...]}: URLs other than the page's own, data: and blob:, and what its console said.
// Chromium is spoken to in its DevTools protocol, through a pipe, so that nothing needs installing.
import { spawn } from "node:child_process";
import { mkdtemp, readFile, rm, writeFile } from "node:fs/promises";
import { createServer } from "node:http";
import { tmpdir } from "node:os";
import path from "node:path";
import { pathToFileURL } from "node:url";

function parse(args) {
  const pages = [], roots = [];
  let size = "960x720";
  while (args.length) {
    const arg = args.shift();
    if (arg === "--root") roots.push(args.shift());
    else if (arg === "--size") size = args.shift();
    else pages.push({ page: arg, out: args.shift(), size });
  }
  if (!pages.length || pages.some(({ out, size }) => !out || !/^\d+x\d+$/.test(size))) {
    console.error("usage: node tools/screenshot.mjs [--root FOLDER]... [--size WxH] PAGE OUT.png ...");
    process.exit(2);
  }
  return { pages, roots };
}

const types = { ".html": "text/html", ".js": "text/javascript", ".json": "application/json" };

async function serve(roots) {
  const server = createServer(async (request, response) => {
    const wanted = path.normalize(decodeURIComponent(new URL(request.url, "http://x").pathname));
    for (const root of roots) {
      const bytes = await readFile(path.join(root, wanted)).catch(() => null);
      if (!bytes) continue;
      response.setHeader("content-type", types[path.extname(wanted)] ?? "application/octet-stream");
      return response.end(bytes);
    }
    response.statusCode = 404;
    response.end();
  });
  await new Promise((done) => server.listen(0, "127.0.0.1", done));
  return server;
}

/** A browser with a new, empty profile: send(method, params, session), events through `heard`. */
function start(profile, heard) {
  const browser = spawn(process.env.CHROMIUM ?? "chromium", [
    "--headless", "--no-sandbox", "--disable-gpu", "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader", "--disable-quic", "--no-first-run", "--no-default-browser-check",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
    "--disable-extensions", "--hide-scrollbars", "--force-color-profile=srgb",
    `--user-data-dir=${profile}`, "--remote-debugging-pipe", "about:blank",
  ], { stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"] });
  const waiting = new Map();
  let number = 0, text = "";
  browser.stdio[4].on("data", (bytes) => {
    text += bytes;
    for (let end; (end = text.indexOf("\0")) >= 0; text = text.slice(end + 1)) {
      const message = JSON.parse(text.slice(0, end));
      const answered = waiting.get(message.id);
      waiting.delete(message.id);
      if (!answered) heard(message);
      else if (message.error) answered.reject(new Error(message.error.message));
      else answered.resolve(message.result);
    }
  });
  browser.on("error", (error) => { for (const w of waiting.values()) w.reject(error); });
  browser.on("exit", () => { for (const w of waiting.values()) w.reject(new Error("chromium ended")); });
  browser.stdio[3].on("error", () => {});
  const send = (method, params = {}, sessionId = undefined) => new Promise((resolve, reject) => {
    waiting.set(++number, { resolve, reject });
    browser.stdio[3].write(JSON.stringify({ id: number, method, params, sessionId }) + "\0");
  });
  return { browser, send };
}

const ready = `(async () => {
  if (document.readyState !== "complete") await new Promise((done) => addEventListener("load", done));
  await window.luxelReady;
  for (let i = 0; i < 3; ++i) await new Promise(requestAnimationFrame);
})()`;

async function main() {
  const { pages, roots } = parse(process.argv.slice(2));
  const profile = await mkdtemp(path.join(tmpdir(), "luxel-chromium-"));
  const server = roots.length ? await serve(roots) : null;
  let requests, messages;
  const { browser, send } = start(profile, ({ method, params }) => {
    if (method === "Network.requestWillBeSent" && !/^(data|blob):/.test(params.request.url))
      requests.push(params.request.url);
    if (method === "Runtime.consoleAPICalled")
      messages.push(params.args.map((a) => a.value ?? a.description).join(" "));
    if (method === "Log.entryAdded") messages.push(params.entry.text);
    if (method === "Runtime.exceptionThrown")
      messages.push(params.exceptionDetails.exception?.description ?? params.exceptionDetails.text);
  });
  try {
    for (const { page, out, size } of pages) {
      const [width, height] = size.split("x").map(Number);
      const [file, fragment] = page.split("#");
      const url = (server ? `http://127.0.0.1:${server.address().port}/${page}`
        : pathToFileURL(file).href + (fragment ? `#${fragment}` : ""));
      requests = [], messages = [];
      const { targetId } = await send("Target.createTarget", { url: "about:blank" });
      const { sessionId } = await send("Target.attachToTarget", { targetId, flatten: true });
      for (const domain of ["Network", "Page", "Runtime", "Log"]) await send(`${domain}.enable`, {}, sessionId);
      await send("Emulation.setDeviceMetricsOverride",
        { width, height, deviceScaleFactor: 1, mobile: false }, sessionId);
      await send("Page.navigate", { url }, sessionId);
      const { exceptionDetails } = await send("Runtime.evaluate",
        { expression: ready, awaitPromise: true }, sessionId);
      const shot = await send("Page.captureScreenshot", { format: "png" }, sessionId);
      await writeFile(out, Buffer.from(shot.data, "base64"));
      console.log(JSON.stringify({ requests: requests.filter((r) => r !== url.split("#")[0]), messages }));
      if (exceptionDetails) {
        console.error(exceptionDetails.exception?.description ?? exceptionDetails.text);
        process.exitCode = 1;
      }
      await send("Target.closeTarget", { targetId });
    }
    await send("Browser.close");
  } finally {
    if (browser.exitCode === null) await new Promise((done) => {
      browser.once("exit", done);
      setTimeout(() => browser.kill("SIGKILL"), 5000).unref();
    });
    server?.close();
    await rm(profile, { recursive: true, force: true, maxRetries: 5 });
  }
}

await main();
