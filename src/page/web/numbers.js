// Number formats: four digits.
function shown(value, digits = 4) {
  if (value === null || value === undefined || Number.isNaN(value)) return "not known";
  if (!Number.isFinite(value)) return value > 0 ? "no bound" : "none";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e6 || size < 1e-4) return value.toExponential(digits - 1);
  return Number(value.toPrecision(digits)).toLocaleString("en", {maximumFractionDigits: 12, useGrouping: size >= 1e4});
}

function percent(share) {
  if (share === null || share === undefined || !Number.isFinite(share)) return shown(share);
  return shown(100 * share, 3) + "\u00a0%";
}

// Durations have two digits, or all digits of whole seconds.
function duration(seconds) {
  return Number.isFinite(seconds) && seconds >= 100 ? shown(Math.round(seconds), 9) : shown(seconds, 2);
}

// The report writes units in letters alone.
const shownUnit = (unit) => unit.replace("^2", "²");

// A value with its error bar, one standard error, to the digits that this leaves of one digit: "412 lx ± 6".
function withBar(value, error, unit) {
  if (!Number.isFinite(value)) return "not known";
  if (!Number.isFinite(error) || error <= 0) return `${shown(value)}\u00a0${shownUnit(unit)}`;
  const digits = Math.min(12, Math.max(0, -Math.floor(Math.log10(error))));
  const fixed = (number) => number.toLocaleString("en", {minimumFractionDigits: digits, maximumFractionDigits: digits});
  return `${fixed(value)}\u00a0${shownUnit(unit)}\u00a0±\u00a0${fixed(error)}`;
}

function spectrum(values) {
  return values.map((value) => shown(value)).join(", ");
}

// The next of 1, 2, 5, 10, ... not below the value.
function roundedUp(value) {
  const decade = Math.pow(10, Math.floor(Math.log10(value)));
  return [1, 2, 5, 10].map((step) => step * decade).find((step) => value <= step * (1 + 1e-9));
}
