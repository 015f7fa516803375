// The page in a headless Chromium: node test.mjs PAGE NATIVE CHROMIUM [PICTURES]
// NATIVE holds what the command made of the same scans: demo/, edge/ and region/, each with points.pcd, and view/.
import assert from "node:assert/strict";
import { createServer } from "node:http";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { basename, extname, join } from "node:path";
import { chromium } from "playwright-core";

const [folder, native, executablePath, pictures] = process.argv.slice(2);
const types = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css" };
const server = createServer((request, response) => {
  try {
    const name = basename(request.url === "/" ? "index.html" : request.url);
    const bytes = readFileSync(join(folder, name));
    response.writeHead(200, { "content-type": types[extname(name)] ?? "application/octet-stream" }).end(bytes);
  } catch {
    response.writeHead(404).end();
  }
}).listen(0, "127.0.0.1");
await new Promise(listening => server.on("listening", listening));
const url = `http://127.0.0.1:${server.address().port}/`;
const browser = await chromium.launch({ executablePath, args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"] });
const errors = [];
const open = async (address, options = {}) => {
  const page = await (await browser.newContext({ viewport: pictures ? { width: 1280, height: 900 } : { width: 800, height: 600 }, ...options })).newPage();
  page.on("pageerror", error => errors.push(String(error)));
  page.on("console", message => { if (message.type() === "error") errors.push(message.text()); });
  await page.goto(address);
  return page;
};
const show = async (page, name) => {
  if (!pictures) return;
  mkdirSync(pictures, { recursive: true });
  writeFileSync(join(pictures, `${name}.png`), await page.screenshot({ fullPage: true }));
};

/** The numbers of the segments of a points.pcd: the last four bytes of each record of 20. */
const numbersOf = name => {
  const bytes = readFileSync(join(native, name, "points.pcd")), start = bytes.indexOf("DATA binary\n") + 12;
  return Array.from({ length: (bytes.length - start) / 20 }, (_, i) => bytes.readUInt32LE(start + 20 * i + 16));
};
const complete = page => page.waitForFunction(() => globalThis.page?.state()?.complete, null, { timeout: 60000 });
const compare = async (page, name) => {
  await complete(page);
  const found = await page.evaluate(() => [...globalThis.page.numbers()]), expected = numbersOf(name);
  assert.equal(found.length, expected.length, name);
  assert.equal(found.filter((number, i) => number !== expected[i]).length, 0, `${name}: pixels unlike the command's`);
  assert.ok(new Set(found).size > 1, name);
  console.log(`${name}: ${found.length} labels as by the command, ${Math.max(...found)} segments`);
};
const refused = page => page.locator("#refused");

const page = await open(url);
await page.waitForFunction(() => globalThis.page?.frames > 20);
const half = await page.evaluate(() => ({ row: globalThis.page.state().row, segments: globalThis.page.state().segments.length }));
assert.ok(half.row > 20 && half.row < 200, "the scan comes row by row");
await show(page, "half");
assert.equal(await page.evaluate(() => globalThis.page.frames - globalThis.page.state().row), 0, "a frame for each row");
await page.keyboard.press("Enter");
await compare(page, "demo");
await page.locator("#list button").first().press("Enter");
const words = await page.locator("#segment").innerText();
assert.match(words, /Segment 1[^]*normal[^]*distance[^]*mm[^]*noise[^]*Covariance/);
assert.equal(await page.locator("#segment .covariance td").count(), 16);
await show(page, "chosen");
for (const approach of ["edge", "region"]) {
  await page.selectOption("#approach", approach === "edge" ? "1" : "2");
  await compare(page, approach);
}
await page.selectOption("#approach", "0");
await page.locator("#noise").press("End");
assert.equal(await page.locator("#noise-said").innerText(), "50 mm");
await complete(page);

/** Drops files on the page. */
const drop = async files => {
  const list = files.map(([name, bytes]) => [name, [...bytes]]);
  await page.evaluate(list => {
    const data = new DataTransfer();
    list.forEach(([name, bytes]) => data.items.add(new File([new Uint8Array(bytes)], name)));
    dispatchEvent(new DragEvent("drop", { dataTransfer: data, cancelable: true }));
  }, list);
};
const file = name => [basename(name), readFileSync(join(native, name))];
const named = name => page.waitForFunction(name => document.getElementById("said").textContent.startsWith(name), name);
await drop([file("demo/geometry.toml"), file("demo/scan.pgm")]);
await named("scan.pgm");
await compare(page, "demo");
await drop([file("demo/points.pcd")]);
await named("points.pcd");
await compare(page, "cloud");
await drop([["wrong.txt", Buffer.from("no scan at all\n")]]);
await refused(page).waitFor({ state: "visible" });
assert.equal(await refused(page).innerText(), "wrong.txt: none of the formats that are read: PGM (P5), PNG, npy, PCD, PLY, E57");
await drop([["depth.png", readFileSync(join(native, "demo/scan.png"))]]);
await page.waitForFunction(() => document.getElementById("refused").textContent.startsWith("depth.png: an image alone"));
await show(page, "refused");
await page.locator("#fx").fill("300");
await page.locator("#fx").press("Enter");
await named("depth.png");
assert.ok(await refused(page).isHidden());

const phone = await open(url, { viewport: { width: 390, height: 844 }, isMobile: true, deviceScaleFactor: 2 });
await phone.waitForFunction(() => globalThis.page);
await phone.locator("#whole").click();
await complete(phone);
const wide = await phone.evaluate(() => document.documentElement.scrollWidth);
assert.ok(wide <= 390, `${wide} pixels wide on a phone`);
await show(phone, "phone");
if (pictures) {
  const dark = await open(url, { colorScheme: "dark" });
  await dark.waitForFunction(() => globalThis.page);
  await dark.locator("#whole").click();
  await complete(dark);
  await show(dark, "dark");
}

const view = await open(`file://${join(native, "view", "view.html")}`);
const listed = await view.locator("#list button").count();
assert.equal(listed, Math.max(...numbersOf("demo")));
await view.locator("#list button").first().press("Enter");
assert.match(await view.locator("#segment").innerText(), /Segment 1[^]*Covariance/);
await show(view, "view");
assert.deepEqual(errors, []);
console.log("what is wrong is refused; the view opens from a disk; no error of the console");
await browser.close();
server.close();
