// False colors as in the pictures of patchlight: blue, cyan, green, yellow, red; gray where a value is not known.
const stops = [[25, 40, 190], [0, 165, 215], [40, 190, 60], [250, 225, 40], [215, 25, 25]];

function falseColour(share) {
  if (Number.isNaN(share)) return [128, 128, 128];
  const position = 4 * Math.min(1, Math.max(0, share));
  const stop = Math.min(3, Math.floor(position));
  const part = position - stop;
  return stops[stop].map((from, channel) => Math.round((1 - part) * from + part * stops[stop + 1][channel]));
}

// Where a value lies between the ends of the scale, 0 to 1.
function shareOf(value, scale) {
  if (!scale.logarithmic) return scale.high > scale.low ? (value - scale.low) / (scale.high - scale.low) : 0;
  const low = Math.max(scale.low, scale.high * 1e-4);
  return value > 0 ? Math.log(value / low) / Math.log(scale.high / low) : (Number.isNaN(value) ? NaN : 0);
}

function valueAt(share, scale) {
  if (!scale.logarithmic) return scale.low + share * (scale.high - scale.low);
  const low = Math.max(scale.low, scale.high * 1e-4);
  return low * Math.pow(scale.high / low, share);
}

// The rows with known values, by day only those of enclosed patches as long as some light is there, from the lowest to
// the highest: {row, value, area}.
function ranked(values, areas, enclosed) {
  const known = Array.from(values.keys()).filter((row) => Number.isFinite(values[row]));
  const inside = enclosed ? known.filter((row) => enclosed[row] === 1) : [];
  const counted = inside.some((row) => values[row] > 0) ? inside : known;
  return counted.map((row) => ({row, value: values[row], area: areas[row]})).sort((a, b) => a.value - b.value);
}

// The value that a share of the area stays at or below.
function quantile(order, share) {
  const total = order.reduce((sum, {area}) => sum + area, 0);
  let below = 0;
  for (const {value, area} of order) {
    below += area;
    if (below >= share * total) return value;
  }
  return order.length > 0 ? order[order.length - 1].value : NaN;
}

// From 0 to a round number with a twentieth of the lit area above it: lamps are so much brighter than all else.
function usualScale(order) {
  const high = quantile(order.filter(({value}) => value > 0), 0.95);
  return {low: 0, high: high > 0 ? roundedUp(high) : 1, logarithmic: false};
}

// All but the lowest and the highest half percent of the area: single patches do not decide.
function widerScale(order) {
  return {low: quantile(order, 0.005), high: quantile(order, 0.995)};
}

function shareBeyond(order, scale) {
  const total = order.reduce((sum, {area}) => sum + area, 0);
  return order.reduce((sum, {value, area}) => sum + (value < scale.low || value > scale.high ? area : 0), 0) / total;
}

function drawBar(canvas) {
  const context = canvas.getContext("2d");
  for (let x = 0; x < canvas.width; ++x) {
    context.fillStyle = "rgb(" + falseColour(x / (canvas.width - 1)).join(",") + ")";
    context.fillRect(x, 0, 1, canvas.height);
  }
}
