// Segments in words and colours.

/** The colour of a label: one of a list of which the first is that of none. */
export function colourOf(palette, label) {
  return palette[label ? 1 + (label - 1) % (palette.length - 1) : 0];
}

/** The same colour, paler. */
export function paler(colour) {
  return colour.map(x => Math.round(0.45 * x + 0.55 * 150));
}

/** Writes three bytes of colour for each label: `colour(label)`. */
export function colourLabels(labels, colour, bytes) {
  const known = new Map();
  for (let i = 0; i < labels.length; i++) {
    let triple = known.get(labels[i]);
    if (!triple) known.set(labels[i], triple = colour(labels[i]));
    bytes[3 * i] = triple[0];
    bytes[3 * i + 1] = triple[1];
    bytes[3 * i + 2] = triple[2];
  }
}

const fixed = (x, digits) => x.toFixed(digits).replace("-", "\u2212");
const small = x => x === 0 ? "0" : x.toExponential(2).replace(/-/g, "\u2212");

/** Returns the table of a segment as HTML, made of numbers alone. */
export function described(number, segment) {
  const { pixels, plane } = segment;
  const row = (name, value) => `<tr><th scope="row">${name}</th><td>${value}</td></tr>`;
  let rows = row("pixels", pixels);
  if (!plane) return `<h3>Segment ${number}</h3><table>${rows}</table><p>It has no plane.</p>`;
  const sigma = i => Math.sqrt(Math.max(0, plane.covariance[i][i]));
  const degrees = 180 / Math.PI;
  rows += row("normal", plane.normal.map(x => fixed(x, 4)).join(", "));
  rows += row("distance", `${fixed(plane.distance_m, 4)} m, \u00b1 ${fixed(1000 * sigma(3), 2)} mm`);
  rows += row("direction", `\u00b1 ${fixed(degrees * Math.hypot(sigma(0), sigma(1), sigma(2)), 3)}\u00b0`);
  rows += row("noise (rms)", `${fixed(1000 * plane.rms_m, 2)} mm`);
  const cells = plane.covariance.map(line => `<tr>${line.map(x => `<td class="n">${small(x)}</td>`).join("")}</tr>`).join("");
  return `<h3>Segment ${number}</h3><table>${rows}</table><p class="quiet">\u00b1 is one standard deviation. Covariance of ` +
    `normal x, y, z and distance, in rad\u00b2, rad m and m\u00b2:</p><div class="wide"><table class="covariance">${cells}</table></div>`;
}
