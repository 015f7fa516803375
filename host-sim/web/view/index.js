// What the page of the core and the views of `scanseg segment --open` share.
export { Cloud } from "./cloud.js";
export { colourLabels, colourOf, described, paler } from "./segments.js";
