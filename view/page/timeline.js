// The timeline: one row per track, each event as long as it took; where there are many, columns as dark as they are
// dense. Wheel zooms, drag moves, click jumps.
import { countUpTo, failedFlag, roundStep } from './model.js';
import { Layer } from './plot.js';

const rowHeight = 17, axisHeight = 22, namesWidth = 188;

export class TimelineView {
  /** `run`: events, tracks, now, duration; `jump(time, number)`: number of the event that was clicked or -1. */
  constructor(canvas, run, jump, redraw) {
    this.canvas = canvas;
    this.run = run;
    this.jump = jump;
    this.redraw = redraw;
    this.from = 0;
    this.to = 1;
    this.scroll = 0;
    this.marks = [];      // search results: times, rising
    this.markers = [];    // the user's
    this.selected = -1;
    this.layer = new Layer();
    this.listen();
  }
  all() {
    this.from = 0;
    this.to = Math.max(this.run.duration, 1e-3);
    this.redraw();
  }
  width() { return Math.max(this.canvas.clientWidth - namesWidth, 1); }
  x(time) { return namesWidth + ((time - this.from) / (this.to - this.from)) * this.width(); }
  time(px) { return this.from + ((px - namesWidth) / this.width()) * (this.to - this.from); }
  zoom(factor, around) {
    const least = 2e-6, span = Math.min(Math.max((this.to - this.from) * factor, least), this.run.duration * 1.05);
    const share = (around - this.from) / (this.to - this.from);
    this.place(around - share * span, span);
  }
  place(from, span) {
    const room = 0.02 * span;
    this.from = Math.min(Math.max(from, -room), Math.max(this.run.duration + room - span, -room));
    this.to = this.from + span;
    this.redraw();
  }
  /** Moves so that `time` is in sight; while it plays the page goes on by whole screens. */
  show(time) {
    const span = this.to - this.from;
    if (time < this.from || time > this.to) this.place(time - 0.1 * span, span);
  }
  /** Scrolls so that a track's row is in sight. */
  reveal(track) {
    const y = this.run.rows.indexOf(track) * rowHeight, seen = this.canvas.clientHeight - axisHeight;
    if (y < 0) return;
    if (y < this.scroll || y + rowHeight > this.scroll + seen)
      this.scroll = Math.min(Math.max(0, y - seen / 2), Math.max(0, this.run.rows.length * rowHeight - seen));
  }
  row(py) { return Math.floor((py - axisHeight + this.scroll) / rowHeight); }

  listen() {
    const canvas = this.canvas;
    let drag = null;
    const scrollBy = (pixels) => {
      const most = Math.max(0, this.run.rows.length * rowHeight + axisHeight - canvas.clientHeight);
      this.scroll = Math.min(Math.max(this.scroll + pixels, 0), most);
      this.redraw();
    };
    canvas.addEventListener('wheel', (event) => {
      event.preventDefault();
      const amount = event.deltaY || event.deltaX;
      if (event.shiftKey || event.offsetX < namesWidth) return scrollBy(amount);
      this.zoom(Math.exp(amount * 0.0016), this.time(event.offsetX));
    }, { passive: false });
    canvas.addEventListener('pointerdown', (event) => {
      canvas.setPointerCapture(event.pointerId);
      drag = { x: event.offsetX, y: event.offsetY, from: this.from, moved: false };
    });
    canvas.addEventListener('pointermove', (event) => {
      if (!drag) return this.hover(event);
      if (!drag.moved && Math.hypot(event.offsetX - drag.x, event.offsetY - drag.y) < 4) return;
      drag.moved = true;
      const span = this.to - this.from;
      scrollBy(drag.y - event.offsetY);
      drag.y = event.offsetY;
      this.place(drag.from - ((event.offsetX - drag.x) / this.width()) * span, span);
    });
    canvas.addEventListener('pointerup', (event) => {
      if (drag && !drag.moved && event.offsetX >= namesWidth) {
        const number = this.under(event.offsetX, event.offsetY);
        this.jump(number >= 0 ? this.run.events.begins[number] : this.time(event.offsetX), number);
      }
      drag = null;
    });
    canvas.addEventListener('dblclick', (event) => {
      const number = this.under(event.offsetX, event.offsetY);
      if (number < 0) return this.zoom(0.2, this.time(event.offsetX));
      const begin = this.run.events.begins[number], span = Math.max(this.run.events.durations[number] * 3, 1e-4);
      this.place(begin - span / 3, span);
    });
  }
  hover(event) {
    const row = this.run.rows[this.row(event.offsetY)];
    this.canvas.title = event.offsetX < namesWidth && row !== undefined ? this.run.tracks[row].name : '';
  }
  /** The event at or nearest to a place, within 6 pixels; -1: none. */
  under(px, py) {
    const index = this.run.rows[this.row(py)];
    const track = index === undefined || py < axisHeight ? null : this.run.events.track(index);
    if (!track) return -1;
    const near = (6 * (this.to - this.from)) / this.width(), time = this.time(px);
    let best = -1, least = near;
    const after = countUpTo(track.begins, time + near);
    for (let i = after - 1; i >= Math.max(0, after - 200); --i) {
      const number = track.numbers[i], begin = track.begins[i], end = begin + this.run.events.durations[number];
      let away = time < begin ? begin - time : time > end ? time - end : 0;
      if (this.run.events.flags[number] & failedFlag) away -= near / 3;  // what failed is what one looks for
      if (away < least) { least = away; best = number; }
    }
    return best;
  }

  draw(colours) {
    const { events, rows, tracks } = this.run;
    const key = [this.from, this.to, this.scroll, this.selected, colours.back, this.marks, this.markers.join(),
      events, events.generation, events.count, rows.map((row) => tracks[row].name).join()];
    const { g, width, height } = this.layer.draw(this.canvas, key, (...surface) => this.paint(...surface, colours));
    const now = this.x(this.run.now);
    if (width === 0 || now < namesWidth) return;
    g.fillStyle = colours.cursor;
    g.fillRect(now - 0.5, 0, 1.5, height);
  }
  /** All but the time that is shown. */
  paint(g, width, height, colours) {
    g.fillStyle = colours.back;
    g.fillRect(0, 0, width, height);
    const first = Math.floor(this.scroll / rowHeight);
    const last = Math.min(this.run.rows.length, first + Math.ceil(height / rowHeight) + 1);
    for (let row = first; row < last; ++row) {
      const y = axisHeight + row * rowHeight - this.scroll;
      const track = this.run.tracks[this.run.rows[row]];
      if (row % 2 === 1) {
        g.fillStyle = colours.part;
        g.fillRect(0, y, width, rowHeight);
      }
      this.events(g, colours, this.run.rows[row], y, width);
      g.fillStyle = row % 2 === 1 ? colours.part : colours.back;
      g.fillRect(0, y, namesWidth, rowHeight);
      g.font = '11px system-ui, "DejaVu Sans", sans-serif';
      g.textAlign = 'left';
      g.textBaseline = 'middle';
      const station = this.run.head.stations.indexOf(track.robot);
      g.fillStyle = station >= 0 ? colours.robot(station) : colours.dim;
      g.fillRect(0, y, 4, rowHeight);
      g.fillStyle = this.selected >= 0 && this.run.events.tracks[this.selected] === this.run.rows[row] ? colours.strong : colours.text;
      g.save();
      g.beginPath();
      g.rect(0, y, namesWidth - 6, rowHeight);
      g.clip();
      g.fillText(track.name, 9, y + rowHeight / 2 + 0.5);
      g.restore();
    }
    this.axis(g, colours, width, height);
    this.bar(g, colours, height);
  }
  events(g, colours, index, y, width) {
    const track = this.run.events.track(index);
    if (!track || track.numbers.length === 0) return;
    const events = this.run.events, kind = colours.kind(this.run.tracks[index].kind);
    const first = countUpTo(track.begins, this.from), last = countUpTo(track.begins, this.to);
    const perPixel = (this.to - this.from) / this.width();
    g.save();
    g.beginPath();
    g.rect(namesWidth, y, width - namesWidth, rowHeight);
    g.clip();
    if (last - first < 3 * this.width()) {
      for (const wantFailed of [false, true])  // what failed lies on top
        for (let i = Math.max(0, first - 3); i < last; ++i) {
          const number = track.numbers[i];
          if (((events.flags[number] & failedFlag) !== 0) !== wantFailed) continue;
          const x = this.x(track.begins[i]), long = Math.max(events.durations[number] / perPixel, 1.6);
          g.fillStyle = wantFailed ? colours.failed : kind;
          if (wantFailed) g.fillRect(x, y + 1, Math.max(long, 2.5), rowHeight - 2);
          else g.fillRect(x, y + 4, long, rowHeight - 8);
        }
    } else {
      const most = (last - first) / this.width();
      let from = first;
      for (let px = namesWidth; px < width; ++px) {
        const to = countUpTo(track.begins, this.time(px + 1));
        if (to > from) {
          g.globalAlpha = Math.min(1, 0.3 + (0.5 * (to - from)) / (2 * most));
          g.fillStyle = kind;
          g.fillRect(px, y + 4, 1, rowHeight - 8);
          g.globalAlpha = 1;
          if (track.failed[to] > track.failed[from]) {
            g.fillStyle = colours.failed;
            g.fillRect(px, y + 1, 2, rowHeight - 2);
          }
        }
        from = to;
      }
    }
    if (this.selected >= 0 && events.tracks[this.selected] === index) {
      const x = this.x(events.begins[this.selected]), long = events.durations[this.selected] / perPixel;
      g.strokeStyle = colours.text;
      g.lineWidth = 1.5;
      g.strokeRect(x - 2, y + 1.5, Math.max(long, 2) + 4, rowHeight - 3);
    }
    g.restore();
  }
  axis(g, colours, width, height) {
    g.fillStyle = colours.part;
    g.fillRect(0, 0, width, axisHeight);
    const span = this.to - this.from, step = roundStep((span * 95) / this.width());
    const digits = Math.max(0, Math.min(9, -Math.floor(Math.log10(step) + 1e-9)));
    g.font = '11px system-ui, "DejaVu Sans", sans-serif';
    g.textAlign = 'center';
    g.textBaseline = 'middle';
    for (let k = Math.ceil(this.from / step); k * step <= this.to; ++k) {
      const x = this.x(k * step);
      g.fillStyle = colours.grid;
      g.fillRect(x, axisHeight, 1, height);
      g.fillStyle = colours.dim;
      if (x > namesWidth + 12) g.fillText(`${(k * step).toFixed(digits)} s`, x, axisHeight / 2);
    }
    const shown = countUpTo(this.marks, this.from), end = countUpTo(this.marks, this.to);
    const every = Math.max(1, Math.ceil((end - shown) / (2 * this.width())));
    g.fillStyle = colours.lamp;
    for (let i = shown; i < end; i += every) g.fillRect(this.x(this.marks[i]) - 1, axisHeight - 5, 2, 5);
    this.markers.forEach((time, i) => {
      const x = this.x(time);
      if (x < namesWidth) return;
      g.fillStyle = colours.ircom;
      g.fillRect(x, axisHeight, 1, height);
      g.fillRect(x - 7, 2, 15, 13);
      g.fillStyle = colours.back;
      g.fillText(`${i + 1}`, x + 0.5, 9);
    });
    g.fillStyle = colours.part;
    g.fillRect(0, 0, namesWidth, axisHeight);
    g.fillStyle = colours.dim;
    g.textAlign = 'left';
    g.fillText(`${this.run.rows.length} tracks`, 9, axisHeight / 2);
    g.fillStyle = colours.line;
    g.fillRect(namesWidth - 1, 0, 1, height);
    g.fillRect(0, axisHeight, width, 1);
  }
  bar(g, colours, height) {
    const all = this.run.rows.length * rowHeight, seen = height - axisHeight;
    if (all <= seen) return;
    g.fillStyle = colours.line;
    g.fillRect(namesWidth - 5, axisHeight + (this.scroll / all) * seen, 4, (seen / all) * seen);
  }
}
