// Canvases in the screen's own pixels, and small plots over time.
import { countUpTo } from './model.js';

/** The context of a canvas, scaled so that one unit is one CSS pixel; {g, width, height}. */
export function prepared(canvas, width = canvas.clientWidth, height = canvas.clientHeight) {
  const ratio = window.devicePixelRatio || 1;
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  const g = canvas.getContext('2d');
  g.setTransform(ratio, 0, 0, ratio, 0, 0);
  return { g, width, height };
}

/** What of a canvas does not change with the time that is shown: it is drawn once and copied from then on. */
export class Layer {
  constructor() {
    this.canvas = document.createElement('canvas');
    this.key = [];
  }
  /** `paint(g, width, height)` draws what `key` names; it is asked again once any of the key's values differs. */
  draw(canvas, key, paint) {
    const { g, width, height } = prepared(canvas);
    if (width === 0 || height === 0) return { g, width, height };
    const whole = [width, height, window.devicePixelRatio, ...key];
    if (whole.length !== this.key.length || whole.some((value, i) => value !== this.key[i])) {
      paint(prepared(this.canvas, width, height).g, width, height);
      this.key = whole;
    }
    g.drawImage(this.canvas, 0, 0, width, height);
    return { g, width, height };
  }
}

/** Lines [{t, values, colour}] between times `from` and `to`; the time `now` as a line. */
export function drawPlot(layer, canvas, lines, from, to, now, colours) {
  const key = [from, to, colours.back, ...lines.flatMap(({ t, values, colour }) => [t, values, colour])];
  const { g, width, height } = layer.draw(canvas, key, (...surface) => drawLines(...surface, lines, from, to, colours));
  const x = ((now - from) / (to - from)) * width;
  g.strokeStyle = colours.cursor;
  g.lineWidth = 1;
  g.beginPath();
  g.moveTo(x, 0);
  g.lineTo(x, height);
  g.stroke();
}

function drawLines(g, width, height, lines, from, to, colours) {
  g.fillStyle = colours.back;
  g.fillRect(0, 0, width, height);
  let least = Infinity, most = -Infinity;
  const parts = lines.map(({ t, values, colour }) => {
    const first = Math.max(0, countUpTo(t, from) - 1), last = Math.min(t.length, countUpTo(t, to) + 1);
    for (let i = first; i < last; ++i) {
      if (values[i] < least) least = values[i];
      if (values[i] > most) most = values[i];
    }
    return { t, values, colour, first, last };
  });
  if (!(most >= least)) return;
  const room = Math.max((most - least) * 0.08, 1e-6 * Math.abs(most), 1e-9);
  const x = (time) => ((time - from) / (to - from)) * width;
  const y = (value) => height - ((value - least + room) / (most - least + 2 * room)) * height;
  for (const { t, values, colour, first, last } of parts) {
    const step = Math.max(1, Math.floor((last - first) / (4 * width)));
    g.strokeStyle = colour;
    g.lineWidth = 1.3;
    g.beginPath();
    for (let i = first; i < last; i += step) g.lineTo(x(t[i]), y(values[i]));
    g.stroke();
  }
  g.fillStyle = colours.dim;
  g.font = '10px system-ui, "DejaVu Sans", sans-serif';
  g.textBaseline = 'top';
  g.textAlign = 'left';
  g.fillText(shortNumber(most), 3, 2);
  g.textBaseline = 'bottom';
  g.fillText(shortNumber(least), 3, height - 2);
}

export function shortNumber(value) {
  return Math.abs(value) >= 100 || value === Math.round(value) ? value.toFixed(0) : value.toPrecision(3);
}
