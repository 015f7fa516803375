// The page that runs the core: it pushes rows to it, and draws what it tells.
const { Cloud, colourLabels, colourOf, described, paler } = globalThis.scanseg;

/** Bytes of the core; packed, unless the server has unpacked them. */
async function bytesOf(url) {
  const bytes = await (await fetch(url)).arrayBuffer();
  const [a, b] = new Uint8Array(bytes);
  if (a !== 0x1f || b !== 0x8b) return bytes;
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
}

const core = (await WebAssembly.instantiate(await bytesOf("scanseg.wasm.gz"))).instance.exports;
const $ = id => document.getElementById(id);

/** Calls the core. Returns what it tells, or throws the sentence with which it refuses. */
function ask(name, ...numbers) {
  core[name](...numbers);
  const told = JSON.parse(new TextDecoder().decode(new Uint8Array(core.memory.buffer, core.text(), core.text_length())));
  if (told.error) throw new Error(told.error);
  return told;
}

/** Returns a copy of numbers of the core. */
function array(which, Kind, length) {
  const start = core.array(which); // after which the memory may be another one
  return new Kind(core.memory.buffer.slice(start, start + 4 * length));
}

/** Gives the core bytes. */
function input(which, bytes) {
  const start = core.input(which, bytes.length);
  new Uint8Array(core.memory.buffer, start, bytes.length).set(bytes);
}

let office = 0, isOffice = true, scan = null, state = null, playing = true, chosen = 0, ranges = null, labels = null, cloudColours = null, dropped = [], tints = new Map();
const image = $("image"), cloud = new Cloud($("cloud"), pixel => choose(pixel < 0 ? 0 : labels[pixel]));

/** The colour of a range: matplotlib's plasma, near yellow, far blue. */
const PLASMA = [[240, 249, 33], [253, 195, 40], [248, 148, 65], [229, 107, 93], [204, 70, 120], [169, 35, 149], [126, 3, 168], [76, 2, 161], [13, 8, 135]];
function rangeColour(range) {
  if (!(range > 0)) return [190, 205, 225];
  const t = 8 * Math.min(1, Math.max(0, (range - scan.near_m) / (scan.far_m - scan.near_m || 1))), i = Math.min(7, Math.floor(t));
  return PLASMA[i].map((x, k) => x + (PLASMA[i + 1][k] - x) * (t - i));
}

/** Returns where on the picture a pixel of the scan is shown. */
function shownAt(row, column) {
  let [x, y] = scan.transpose ? [row, column] : [column, row];
  if (scan.mirror) x = image.width - 1 - x;
  if (scan.flip) y = image.height - 1 - y;
  return [x, y];
}

/** Takes a new scan; row by row, or all at once and from where one looks. */
function take(told, slowly = true) {
  scan = told;
  const pixels = scan.rows * scan.columns;
  ranges = array(0, Float32Array, pixels);
  [image.width, image.height] = scan.transpose ? [scan.rows, scan.columns] : [scan.columns, scan.rows];
  scan.place = new Uint32Array(pixels);
  scan.ranges = new Uint8Array(3 * pixels);
  for (let i = 0; i < pixels; i++) {
    const [x, y] = shownAt(Math.floor(i / scan.columns), i % scan.columns);
    scan.place[i] = y * image.width + x;
    scan.ranges.set(rangeColour(ranges[i]), 3 * i);
  }
  cloudColours = new Uint8Array(3 * pixels);
  cloud.show(array(1, Float32Array, 3 * pixels), !slowly);
  $("near").textContent = `${scan.near_m.toFixed(1)} m`;
  $("far").textContent = `${scan.far_m.toFixed(1)} m`;
  begin(slowly);
}

/** Begins the scan anew; then row by row, or all at once. */
function begin(slowly) {
  const noise = Number($("noise").value) / 1000;
  // 0 is what the file says, and without that what the default measures
  attempt(() => {
    state = ask("begin", Number($("approach").value), noise || -1);
    chosen = 0;
    tints = new Map();
    playing = slowly;
    if (slowly) draw();
    else step(scan.rows);
  });
}

/** Does what may be refused, and says so. Returns whether it was done. */
function attempt(what) {
  try {
    what();
    $("refused").hidden = true;
    return true;
  } catch (error) {
    $("refused").textContent = error.message;
    $("refused").hidden = false;
    return false;
  }
}

function step(rows) {
  attempt(() => {
    state = ask("push", rows);
    draw();
  });
}

/** Gives each area of 30 pixels or more a colour, which it keeps: the one that is seen least. */
function tint() {
  const pixels = new Map();
  for (const label of labels) if (label) pixels.set(label, (pixels.get(label) ?? 0) + 1);
  for (const label of tints.keys()) if (!pixels.has(label)) tints.delete(label); // it joined another one
  const used = new Uint32Array(scan.palette.length);
  used[0] = Infinity;
  for (const [label, at] of tints) used[at] += pixels.get(label);
  for (const [label, count] of pixels) {
    if (count < 30 || tints.has(label)) continue;
    let least = 1;
    for (let at = 2; at < used.length; at++) if (used[at] < used[least]) least = at;
    tints.set(label, least);
    used[least] += count;
  }
}
const colour = label => colourOf(scan.palette, tints.get(label) ?? label);

function draw() {
  const pixels = scan.rows * scan.columns;
  labels = array(2, Uint32Array, pixels);
  const complete = new Set(state.segments.map(segment => segment.label));
  // by edges, rows wait for others
  const seen = state.complete ? pixels : Math.max(0, state.row - (Number($("approach").value) === 1 ? 3 : 0)) * scan.columns;
  tint();
  colourLabels(labels, label => label && (!complete.has(label) || (chosen && label !== chosen)) ? paler(colour(label)) : colour(label), cloudColours);
  cloudColours.set(scan.ranges.subarray(3 * seen), 3 * seen);
  const context = image.getContext("2d"), picture = context.createImageData(image.width, image.height);
  for (let i = 0; i < pixels; i++) {
    const at = 4 * scan.place[i], none = !(ranges[i] > 0), from = none ? scan.ranges : cloudColours;
    picture.data[at] = from[3 * i];
    picture.data[at + 1] = from[3 * i + 1];
    picture.data[at + 2] = from[3 * i + 2];
    picture.data[at + 3] = 255;
  }
  context.putImageData(picture, 0, 0);
  cloud.draw(cloudColours);
  tell();
}

/** Returns row and column of a pixel of a segment: the middle of its longest run, not near its first or last row. */
function middle({ label, first_row, last_row, first_column, last_column }) {
  const quarter = Math.floor((last_row - first_row) / 4);
  let best = [first_row, first_column], longest = 0;
  for (let row = first_row + quarter; row <= last_row - quarter; row++) {
    for (let column = first_column, run = 0; column <= last_column; column++) {
      run = labels[row * scan.columns + column] === label ? run + 1 : 0;
      if (run > longest) [best, longest] = [[row, column - Math.floor(run / 2)], run];
    }
  }
  return best;
}

/** Writes down what is known. What does not change is not touched. */
function tell() {
  const noise = state.noise_m ? ` The noise that counts at 3 m is ${(1000 * state.noise_m).toFixed(1)} mm.` : "";
  const remarks = scan.remarks.map(remark => ` ${remark[0].toUpperCase()}${remark.slice(1)}.`).join("");
  const so_far = state.complete ? "Complete" : `Row ${state.row} of ${scan.rows}`;
  $("said").textContent = `${scan.name}, ${scan.columns} × ${scan.rows}. ${so_far}: ${state.segments.length} segments of 30 pixels or more.${noise}${remarks}`;
  $("play").textContent = state.complete ? "Again" : playing ? "Pause" : "Go on";
  const key = JSON.stringify([chosen, state.segments.map(segment => [segment.label, segment.pixels])]);
  if (key === tell.key) return;
  tell.key = key;
  const rows = [], numbers = [];
  state.segments.forEach((segment, i) => {
    const row = document.createElement("tr"), plane = segment.plane;
    row.className = segment.label === chosen ? "chosen" : "";
    row.innerHTML = `<td><i style="background: rgb(${colour(segment.label)})"></i><button type="button">${i + 1}</button></td>` +
      `<td class="n">${segment.pixels}</td><td class="n">${plane ? plane.distance_m.toFixed(3) : ""}</td><td class="n">${plane ? (1000 * plane.rms_m).toFixed(1) : ""}</td>`;
    row.addEventListener("click", () => choose(segment.label));
    rows.push(row);
    const [x, y] = shownAt(...middle(segment));
    if (segment.pixels * 400 < image.width * image.height && segment.label !== chosen) return;
    const number = document.createElement("span");
    number.textContent = i + 1;
    [number.style.left, number.style.top] = [`${100 * (x + .5) / image.width}%`, `${100 * (y + .5) / image.height}%`];
    numbers.push(number);
  });
  const focused = [...$("list").children].findIndex(row => row.contains(document.activeElement));
  $("list").replaceChildren(...rows);
  if (rows[focused]) rows[focused].querySelector("button").focus({ preventScroll: true });
  $("numbers").replaceChildren(...numbers);
  const at = state.segments.findIndex(segment => segment.label === chosen);
  $("segment").innerHTML = at >= 0 ? described(at + 1, state.segments[at]) : "<h3>No segment chosen</h3><p class=\"quiet\">Click one, or choose it in the list.</p>";
}

function choose(label) {
  chosen = label === chosen ? 0 : label;
  if (!state.segments.some(segment => segment.label === chosen)) chosen = 0;
  draw();
}

/** Scans an office, with the noise of the slider in its ranges. */
function scanOffice(number, slowly) {
  [office, isOffice] = [number, true];
  $("focal").hidden = true;
  attempt(() => take(ask("office", office, Number($("noise").value) / 1000), slowly));
}

const isGeometry = file => /\.(toml|ya?ml|json)$/i.test(file.name);

/** Reads what was dropped: a scan, and its geometry file if there is one. */
async function read(files) {
  const known = [...files].filter(file => file.size <= 2 ** 28);
  // a geometry file that comes later is for the image before it
  if (known.length && known.every(isGeometry) && dropped.length) known.push(dropped.find(file => !isGeometry(file)));
  dropped = known;
  const file = known.find(file => file && !isGeometry(file)) ?? known[0], geometry = known.find(other => isGeometry(other) && other !== file);
  if (!file) return attempt(() => { throw new Error("files of more than 256 MiB are for the command"); });
  const encoded = text => new TextEncoder().encode(text);
  const parts = [new Uint8Array(await file.arrayBuffer()), encoded(file.name),
    geometry ? new Uint8Array(await geometry.arrayBuffer()) : new Uint8Array(), encoded(geometry?.name ?? "")];
  const fx = $("focal").hidden ? 0 : Number($("fx").value);
  parts.forEach((bytes, which) => input(which, bytes));
  const done = attempt(() => {
    const told = ask("read", fx);
    isOffice = false;
    $("noise").value = 0;
    take(told);
    said();
  });
  // an image alone
  if (!done && !geometry && /\.(pgm|png)$/i.test(file.name)) $("focal").hidden = false;
  return done;
}

function said() {
  const mm = Number($("noise").value);
  $("noise-said").textContent = mm || isOffice ? `${mm} mm` : scan.range_noise_m ? "as the file says" : "as measured";
}

$("play").addEventListener("click", () => {
  if (state.complete) return begin(true);
  playing = !playing;
  draw();
});
$("whole").addEventListener("click", () => step(scan.rows));
$("next").addEventListener("click", () => scanOffice((office + 1) % 25, true));
$("approach").addEventListener("change", () => begin(false));
$("noise").addEventListener("input", () => {
  said();
  if (isOffice) scanOffice(office, false);
  else begin(false);
});
$("fx").addEventListener("change", () => read(dropped));
$("files").addEventListener("change", event => read(event.target.files));
image.addEventListener("click", event => {
  const box = image.getBoundingClientRect();
  const x = Math.floor((event.clientX - box.left) / box.width * image.width), y = Math.floor((event.clientY - box.top) / box.height * image.height);
  choose(labels[scan.place.indexOf(y * image.width + x)]);
});
addEventListener("dragover", event => { event.preventDefault(); document.body.classList.add("over"); });
addEventListener("dragleave", event => { if (!event.relatedTarget) document.body.classList.remove("over"); });
addEventListener("drop", event => {
  event.preventDefault();
  document.body.classList.remove("over");
  read(event.dataTransfer.files);
});
addEventListener("keydown", event => {
  if (event.target.closest("button, input, select, label") || event.ctrlKey || event.metaKey || event.altKey) return;
  const button = { " ": "play", Enter: "whole", n: "next" }[event.key];
  if (!button) return;
  event.preventDefault();
  $(button).click();
});

scanOffice(0, true);
/** What a test asks: how far the scan is, frames drawn, and the numbers of the segments as the command has them. */
globalThis.page = {
  frames: 0,
  state: () => state,
  numbers: () => array(3, Uint32Array, scan.rows * scan.columns),
};
const frame = () => {
  // a hundred frames or more for a scan, however high it is
  if (playing && state && !state.complete) {
    step(Math.ceil(scan.rows / 400));
    page.frames++;
  }
  requestAnimationFrame(frame);
};
requestAnimationFrame(frame);
