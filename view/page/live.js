// A run that is on: its new rows as they come, and what drives it. The page whose user does something first drives;
// others look on until they take over.

const livePollMilliseconds = 100;

/** Rows "t,name,x,y,heading" after what paths have; new names become new paths. */
export function appendRows(paths, text, robot) {
  const byName = new Map(paths.filter((path) => path.robot === robot).map((path) => [path.name, path]));
  for (const line of text.split('\n')) {
    const [t, name, x, y, heading] = line.split(',');
    if (heading === undefined || Number.isNaN(Number(t))) continue;  // the header
    let path = byName.get(name);
    if (!path) {
      path = { name, robot, t: [], x: [], y: [], heading: [] };
      byName.set(name, path);
      paths.push(path);
    }
    path.t.push(Number(t));
    path.x.push(Number(x));
    path.y.push(Number(y));
    path.heading.push(Number(heading));
  }
}

export class Live {
  /** `changed()`: there is something new to draw; `trouble(error)`. */
  constructor(run, source, changed, trouble) {
    Object.assign(this, { run, source, changed, trouble });
    this.page = Array.from(crypto.getRandomValues(new Uint8Array(8)), (byte) => byte.toString(16)).join('');
    this.state = { time_s: 0, playing: false, speed: 1, over: false, why: '', driver: '', acts: [], epoch: 0, look: null };
    this.offsets = { 'new-robots': 0, 'new-objects': 0 };
    this.atEdge = true;
    this.sent = Promise.resolve();
    run.paths.length = 0;
  }
  /** The run went back: what is known of it is read again. */
  begin() {
    this.offsets = { 'new-robots': 0, 'new-objects': 0 };
    this.run.paths.length = 0;
    this.run.begin();
  }
  get drives() { return this.state.driver === '' || this.state.driver === this.page; }
  edge() {
    return this.run.paths.reduce((latest, path) => Math.max(latest, path.t.length ? path.t[path.t.length - 1] : 0), 0);
  }
  async poll() {
    for (;;) {
      const over = this.state.over;
      await this.refresh();
      if (over) return;
      await new Promise((resolve) => setTimeout(resolve, livePollMilliseconds));
    }
  }
  async refresh() {
    const { epoch } = this.state;
    this.state = await this.source.json('drive');
    if (this.state.epoch !== epoch) this.begin();
    for (const [name, robot] of [['new-robots', true], ['new-objects', false]])
      for (;;) {
        const bytes = await this.source.bytes(`${name}?from=${this.offsets[name]}`);
        if (bytes.byteLength === 0) break;
        this.offsets[name] += bytes.byteLength;
        appendRows(this.run.paths, new TextDecoder().decode(bytes), robot);
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
