// Colours of the cloud: by order, by beats, by missed points. Steps of colour differ in lightness
// too, so that they can be distinguished without hues.

// From first to last.
const order_ramps = {
  light: ['#3b1f8f', '#2a52be', '#0d7fa8', '#0f8f62', '#a88a00', '#d2541b'],
  dark: ['#7b6cf6', '#4f9bff', '#2fd0e0', '#4be59a', '#e8e34f', '#ff9d4d'],
};
// 1 beat, 2, 3, 4 and 5, 6 and more; indices of the first one and of unknown ones.
const beat_limits = [1, 2, 3, 5, 255];
const beat_names = ['1 beat', '2 beats', '3 beats', '4 to 5', '6 or more'];
const beat_colours = {
  light: ['#8fb0d4', '#1f9e77', '#d69a00', '#dc5f16', '#b3123f'],
  dark: ['#35557d', '#3fd0a0', '#ffd24d', '#ff8f45', '#ff4f7b'],
};
// Points that the job had not reached when it ended, in every mode.
const not_reached_colours = {light: '#c3c8ce', dark: '#343a43'};
// Points of an earlier run of the job, in every mode.
const before_colours = {light: '#c9b48a', dark: '#6f603f'};
const fate_colours = {light: ['#8fa3b8', '#c8102e'], dark: ['#4b5f78', '#ff5a5f']};

function rgb_of(text) {
  return [1, 3, 5].map((i) => parseInt(text.slice(i, i + 2), 16));
}

// 256 colours along a ramp.
function ramp_texture(stops) {
  const colours = stops.map(rgb_of);
  const pixels = new Uint8Array(256 * 4);
  for (let i = 0; i < 256; ++i) {
    const at = (i / 255) * (colours.length - 1);
    const k = Math.min(Math.floor(at), colours.length - 2);
    for (let c = 0; c < 3; ++c)
      pixels[4 * i + c] = colours[k][c] + (at - k) * (colours[k + 1][c] - colours[k][c]);
    pixels[4 * i + 3] = 255;
  }
  return pixels;
}

// A colour for each value of a byte.
function step_texture(colours, limits) {
  const pixels = new Uint8Array(256 * 4);
  for (let i = 0; i < 256; ++i) {
    const step = limits.findIndex((limit) => i <= limit);
    pixels.set([...rgb_of(colours[step]), 255], 4 * i);
  }
  return pixels;
}

function mode_texture(mode, theme) {
  if (mode === 'order') return ramp_texture(order_ramps[theme]);
  if (mode === 'beats') return step_texture(beat_colours[theme], beat_limits);
  return step_texture(fate_colours[theme], [0, 255]);
}
