// A run that is on: what the viewer sends of it, and what drives it. The page whose user does something first drives;
// others look on until they take over.
import { Bytes } from './bytes.js';

const again = 1000;  // milliseconds until a line that broke is tried again
const part = { state: 1, name: 2, rows: 3 };

/** Rows behind what paths have: `numbers` of paths, times, and x, y and heading one after the other. */
export function appendRows(paths, bytes) {
  const count = bytes.number();
  const numbers = bytes.array(Uint16Array, count), times = bytes.array(Float64Array, count);
  const [x, y, heading] = [0, 1, 2].map(() => bytes.array(Float32Array, count));
  for (let i = 0; i < count; ++i) {
    const path = paths.get(numbers[i]);
    path.t.push(times[i]);
    path.x.push(x[i]);
    path.y.push(y[i]);
    path.heading.push(heading[i]);
  }
}

export class Live {
  /** `changed()`: there is something new to draw; `trouble(error)`. */
  constructor(run, source, changed, trouble) {
    Object.assign(this, { run, source, changed, trouble });
    this.page = Array.from(crypto.getRandomValues(new Uint8Array(8)), (byte) => byte.toString(16)).join('');
    this.state = { time_s: 0, playing: false, speed: 1, over: false, why: '', driver: '', acts: [], epoch: 0, look: null };
    this.paths = new Map();
    this.atEdge = true;
    this.sent = Promise.resolve();
    run.paths.length = 0;
  }
  /** The run went back: what is known of it is read again. */
  begin() {
    this.paths.clear();
    this.run.paths.length = 0;
    this.run.begin();
  }
  get drives() { return this.state.driver === '' || this.state.driver === this.page; }
  edge() {
    return this.run.paths.reduce((latest, path) => Math.max(latest, path.t.length ? path.t[path.t.length - 1] : 0), 0);
  }
  /** Listens for as long as the run goes on; comes back with the first that is heard. */
  listen() {
    return new Promise((heard, failed) => {
      const line = new WebSocket(`${location.origin.replace('http', 'ws')}${location.pathname}live`);
      line.binaryType = 'arraybuffer';
      line.addEventListener('open', () => {  // all positions come, once more where the line broke
        this.paths.clear();
        this.run.paths.length = 0;
      });
      line.addEventListener('message', ({ data }) => {
        try {
          this.take(data);
          heard();
        } catch (error) {
          this.trouble(error);
        }
      });
      line.addEventListener('close', () => {
        failed(new Error('the viewer does not answer'));
        if (this.state.over) return;
        setTimeout(() => this.listen().catch((error) => this.trouble(error)), again);
      });
    });
  }
  /** The parts of a message (view/recording/feed.h). */
  take(message) {
    const bytes = new Bytes(message);
    while (bytes.at < message.byteLength) {
      const [kind] = bytes.array(Uint8Array, 1), size = bytes.number();
      const inner = new Bytes(bytes.array(Uint8Array, size).buffer);
      if (kind === part.state) {
        const { epoch } = this.state;
        this.state = JSON.parse(new TextDecoder().decode(inner.buffer));
        if (this.state.epoch !== epoch) this.begin();
      } else if (kind === part.name) {
        const [robot] = inner.array(Uint8Array, 1), [number] = inner.array(Uint16Array, 1);
        const name = new TextDecoder().decode(inner.buffer.slice(inner.at));
        const path = { name, robot: robot === 1, t: [], x: [], y: [], heading: [] };
        this.paths.set(number, path);
        this.run.paths.push(path);
      } else if (kind === part.rows) {
        appendRows(this.paths, inner);
      }
    }
    this.run.duration = Math.max(this.edge(), 1e-3);
    this.changed();
  }
  /** What is refused is an Error. One after the other: side by side they may arrive in another order. */
  ask(request) {
    const asked = this.sent.then(() => this.post(request));
    this.sent = asked.catch(() => {});
    return asked;
  }
  async post(request) {
    const answer = await fetch('drive', { method: 'POST', headers: { 'Content-Type': 'application/json' },
      body: JSON.stringify({ page: this.page, ...request }) });
    if (!answer.ok) throw new Error(await answer.text());
    this.changed();
  }
  /** The time to show `milliseconds` after `now`: at the run's speed, up to what is known of it. */
  advance(now, milliseconds) {
    const edge = this.run.duration;
    if (!this.atEdge) return now;
    if (!this.state.playing || this.state.speed === 0) return edge;
    // Half a second late is caught up with at once; else a little faster than the run while it is ahead.
    const late = edge - now;
    if (late > 1 * this.state.speed) return edge - 0.2 * this.state.speed;
    return Math.min(edge, now + (this.state.speed * milliseconds * (late > 0.25 * this.state.speed ? 1.2 : 1)) / 1000);
  }
}

export const sensorsAgainAfter = 1000;  // milliseconds
