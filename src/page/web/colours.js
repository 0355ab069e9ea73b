// False colours as in the pictures of patchlight: blue, cyan, green, yellow, red; grey where a value is not known.
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

// From 0 to a round number with a twentieth of the area above it: lamps are so much brighter than what they light.
function usualScale(values, areas) {
  const order = Array.from(values.keys()).filter((k) => values[k] > 0 && Number.isFinite(values[k])).sort((a, b) => values[a] - values[b]);
  const total = order.reduce((sum, k) => sum + areas[k], 0);
  let below = 0;
  for (const k of order) {
    below += areas[k];
    if (below >= 0.95 * total) return {low: 0, high: roundedUp(values[k]), logarithmic: false};
  }
  return {low: 0, high: 1, logarithmic: false};
}

function drawBar(canvas) {
  const context = canvas.getContext("2d");
  for (let x = 0; x < canvas.width; ++x) {
    context.fillStyle = "rgb(" + falseColour(x / (canvas.width - 1)).join(",") + ")";
    context.fillRect(x, 0, 1, canvas.height);
  }
}
