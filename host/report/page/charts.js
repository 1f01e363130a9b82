// Charts as SVG: one series each, with axes in round numbers and a text for screen readers.

const svg_name = 'http://www.w3.org/2000/svg';
const chart_size = {left: 46, right: 12, top: 12, bottom: 41};

function svg_part(parent, name, attributes, text) {
  const part = document.createElementNS(svg_name, name);
  for (const [key, value] of Object.entries(attributes)) part.setAttribute(key, value);
  if (text !== undefined) part.textContent = text;
  parent.append(part);
  return part;
}

// Step between round numbers, for about `about` of them.
function tick_step(range, about) {
  const raw = range / about;
  const power = 10 ** Math.floor(Math.log10(raw));
  return [1, 2, 2.5, 5, 10].map((k) => k * power).find((k) => k >= raw * 0.999);
}

// About `about` round numbers up to `most`.
function ticks(most, about, from = 0) {
  const step = tick_step(most - from, about);
  const all = [];
  for (let i = Math.ceil(from / step - 1e-4); i * step <= most + 1e-4 * step; ++i) all.push(i * step);
  return all;
}

// The smallest round number above `most`.
function top_tick(most, about) {
  const step = tick_step(most, about);
  return Math.ceil(most / step - 1e-6) * step;
}

function share_text(share) {
  return share >= 0.0995 ? `${Math.round(100 * share)} %` : share >= 0.0005 ? `${fixed(100 * share, 1)} %` : '<0.1 %';
}

function tick_text(value) {
  return value >= 10000 ? grouped(Math.round(value)) : String(Number(value.toPrecision(6)));
}

// The frame of a chart: axes, and functions from values to positions.
function make_chart(holder, options) {
  const width = Math.max(260, Math.round(holder.clientWidth || 560)), height = options.height;
  const svg = svg_part(holder, 'svg', {viewBox: `0 0 ${width} ${height}`, role: 'img', 'aria-label': options.label});
  const {left, right, top, bottom} = chart_size;
  const from_x = options.from_x ?? 0;
  const x = (value) => left + ((value - from_x) / (options.max_x - from_x)) * (width - left - right);
  const y = (value) => height - bottom - (value / options.max_y) * (height - top - bottom);
  for (const value of ticks(options.max_y, 4)) {
    svg_part(svg, 'line', {class: 'grid', x1: left, x2: width - right, y1: y(value), y2: y(value)});
    svg_part(svg, 'text', {x: left - 7, y: y(value) + 4, 'text-anchor': 'end'}, options.y_text(value));
  }
  const label = (value, text) => svg_part(svg, 'text', {x: x(value), y: height - bottom + 20, 'text-anchor': 'middle'}, text);
  const labels = (options.x_ticks ?? ticks(options.max_x, width / 90, from_x)).map((value) =>
    label(value + (options.x_shift ?? 0), (options.x_text ?? tick_text)(value)));
  // The label of an open bar is needed more than those of the axis.
  if (options.x_open) labels.unshift(label(options.x_open.at, options.x_open.text));
  drop_overlapping(labels);
  svg_part(svg, 'text', {x: width - right, y: height - 4, 'text-anchor': 'end'}, options.x_unit);
  return {svg, x, y, width, height};
}

// A text at the pointer while it is over a part of a chart.
function show_on_hover(part, text) {
  svg_part(part, 'title', {}, text);
}

// Removes texts that overlap one before them in the list.
function drop_overlapping(texts, gap = 6) {
  const kept = [];
  for (const text of texts) {
    const box = text.getBBox();
    if (kept.some((other) => box.x < other.x + other.width + gap && other.x < box.x + box.width + gap))
      text.remove();
    else
      kept.push(box);
  }
}

// Bars of a histogram; the last bin has all larger values too.
function draw_histogram(holder, histogram, options) {
  holder.replaceChildren();
  if (!histogram.counts || histogram.values === 0) return;
  const counts = histogram.counts.slice(options.from ?? 0);
  while (options.trim && counts.length > options.trim && counts[counts.length - 1] === 0) counts.pop();
  const all = counts.reduce((sum, n) => sum + n, 0);
  const start = histogram.from + (options.from ?? 0) * histogram.bin;
  const first_x = options.each ? 0 : start, last = counts.length - 1;
  // Trailing empty bins are trimmed, so the last bar is that of the larger values, if there are any.
  const is_open = histogram.open;
  const chart = make_chart(holder, {
    height: 220, label: options.label, from_x: first_x,
    max_x: first_x + counts.length * histogram.bin, max_y: top_tick(Math.max(...counts) / all, 4), y_text: (share) => `${Number((100 * share).toPrecision(3))} %`,
    x_unit: options.unit, x_ticks: options.each ? counts.map((_, i) => i).filter((i) => counts.length < 14 || i % 4 === 0) : undefined,
    x_shift: options.each ? 0.5 : 0, x_text: options.each ? (i) => String(i + (options.from ?? 0)) : undefined,
    x_open: is_open && {at: first_x + (last + 0.5) * histogram.bin, text: options.open(start + last * histogram.bin)},
  });
  const bars = [];
  counts.forEach((count, i) => {
    const [low, high] = [chart.x(first_x + i * histogram.bin), chart.x(first_x + (i + 1) * histogram.bin)];
    const top = chart.y(count / all);
    const gap = Math.min(2, 0.15 * (high - low));
    if (count > 0)
      svg_part(chart.svg, 'rect', {class: 'bar', x: low + gap / 2, width: Math.max(high - low - gap, 0.6), rx: 1.5,
                                   y: Math.min(top, chart.y(0) - 1), height: Math.max(chart.y(0) - top, 1)});
    bars.push({low, high, top, count});
    const hit = svg_part(chart.svg, 'rect', {class: 'hit', x: low, width: high - low, y: chart_size.top, height: chart.y(0) - chart_size.top});
    show_on_hover(hit, `${options.bin_text(start + i * histogram.bin, histogram.bin, is_open && i === last)}: ${grouped(count)}, ${short((100 * count) / all)} %`);
  });
  if (options.each) label_bars(chart, bars, all);
}

// The share of each bar over it, of the high bars first: no text is on another text or bar.
function label_bars(chart, bars, all) {
  const kept = [], gap = 4;
  for (const bar of [...bars].sort((a, b) => b.count - a.count)) {
    if (bar.count === 0) break;
    const text = svg_part(chart.svg, 'text', {class: 'share', x: (bar.low + bar.high) / 2, y: bar.top - 5, 'text-anchor': 'middle'}, share_text(bar.count / all));
    const box = text.getBBox(), end = box.x + box.width, bottom = box.y + box.height;
    const hits = (low, high, from, to) => low < end + gap && box.x < high + gap && from < bottom && box.y < to;
    const on_bar = bars.some((other) => other !== bar && hits(other.low + gap, other.high - gap, other.top + 2, Infinity));
    if (on_bar || kept.some((other) => hits(other.x, other.x + other.width, other.y, other.y + other.height)))
      text.remove();
    else
      kept.push(box);
  }
}

// Shots per beat over time, with the mean.
function draw_utilisation(holder, use, mean) {
  holder.replaceChildren();
  if (use.share.length === 0) return;
  const seconds = use.beats_per_bin * seconds_per_beat;
  const whole = seconds * use.share.length;
  const [unit, scale] = whole < 180 ? ['s', 1] : whole < 3 * 3600 ? ['min', 60] : ['h', 3600];
  const chart = make_chart(holder, {
    height: 240, max_x: whole / scale, max_y: Math.max(1, ...use.share), x_unit: `machine time, ${unit}`,
    label: `Utilisation over time: ${fixed(100 * mean, 1)} % on average`, y_text: (share) => `${Math.round(100 * share)} %`,
  });
  const place = (i, share) => `${chart.x((i * seconds) / scale).toFixed(1)} ${chart.y(share).toFixed(1)}`;
  const line = use.share.map((share, i) => `L${place(i, share)}L${place(i + 1, share)}`).join('').slice(1);
  const end = use.share.length;
  svg_part(chart.svg, 'path', {class: 'area', d: `M${place(0, 0)}L${line}L${place(end, 0)}Z`});
  svg_part(chart.svg, 'path', {class: 'curve', d: `M${line}`});
  svg_part(chart.svg, 'line', {class: 'mean', x1: chart.x(0), x2: chart.x(whole / scale), y1: chart.y(mean), y2: chart.y(mean)});
  use.share.forEach((share, i) => {
    const from = chart.x((i * seconds) / scale);
    const hit = svg_part(chart.svg, 'rect', {class: 'hit', x: from, width: chart.x(((i + 1) * seconds) / scale) - from,
                                             y: chart_size.top, height: chart.y(0) - chart_size.top});
    show_on_hover(hit, `${time_text(i * seconds)}: ${fixed(100 * share, 1)} %`);
  });
}
