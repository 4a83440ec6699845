// What a page knows of a run, and questions about an instant of it. Nothing here draws or asks a server.
import { Bytes } from './bytes.js';

/** The number of values of a rising array that are not above `value`. */
export function countUpTo(values, value, count = values.length) {
  let low = 0, high = count;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (values[middle] <= value) low = middle + 1; else high = middle;
  }
  return low;
}

export function parsePoses(buffer, names) {
  const bytes = new Bytes(buffer);
  return names.map(({ name, robot }) => {
    const count = bytes.number();
    const [t, x, y, heading] = [0, 1, 2, 3].map(() => bytes.array(Float32Array, count));
    return { name, robot, t, x, y, heading };
  });
}

/** Where a path is at `time`, between its points by straight lines; null where it has no points. */
export function poseAt(path, time) {
  const n = path.t.length;
  if (n === 0) return null;
  const after = countUpTo(path.t, time);
  if (after === 0 || after === n) {
    const i = after === 0 ? 0 : n - 1;
    return { x: path.x[i], y: path.y[i], heading: path.heading[i] };
  }
  const i = after - 1;
  const share = (time - path.t[i]) / (path.t[after] - path.t[i] || 1);
  const between = (values) => values[i] + share * (values[after] - values[i]);
  return { x: between(path.x), y: between(path.y), heading: between(path.heading) };
}

/** Squares of pheromones by the time at which they were recorded: [{time, trail, x, y, strength}, ...] of each trail. */
export function parseTrails(buffer) {
  const bytes = new Bytes(buffer), count = bytes.number();
  bytes.number();
  const times = bytes.array(Float64Array, count), of = bytes.array(Uint16Array, count);
  const [x, y, strength] = [0, 1, 2].map(() => bytes.array(Float32Array, count));
  const trails = [];
  for (let i = 0; i < count; ++i) {
    while (trails.length <= of[i]) trails.push({ times: [], layers: [] });
    const trail = trails[of[i]];
    if (trail.times.at(-1) !== times[i]) {
      trail.times.push(times[i]);
      trail.layers.push([]);
    }
    trail.layers.at(-1).push({ x: x[i], y: y[i], strength: strength[i] });
  }
  return trails;
}

/** What the overhead tracker saw, frame by frame: rows "t_s,arrives_s,frame,robot,x_m,y_m,theta_rad" as they come. */
export class Tracked {
  constructor() {
    this.bytes = 0;
    this.times = [];
    this.frames = [];
  }
  append(buffer) {
    this.bytes += buffer.byteLength;
    for (const line of new TextDecoder().decode(buffer).split('\n')) {
      const [time, , , robot, x, y, heading] = line.split(',');
      if (heading === undefined || Number.isNaN(Number(time))) continue;  // the header
      if (this.times.at(-1) !== Number(time)) {
        this.times.push(Number(time));
        this.frames.push([]);
      }
      this.frames.at(-1).push({ robot, x: Number(x), y: Number(y), heading: Number(heading) });
    }
  }
  /** The latest frame at `time`. */
  at(time) {
    const i = countUpTo(this.times, time);
    return i > 0 ? this.frames[i - 1] : [];
  }
}

/** Does a loudspeaker of the arena play at `time`? */
export function plays(speaker, time) {
  if (time < speaker.on) return false;
  const last = speaker.times > 0 ? speaker.times - 1 : Infinity;
  const number = speaker.every > 0 ? Math.min(Math.floor((time - speaker.on) / speaker.every), last) : 0;
  return time - speaker.on - number * speaker.every < speaker.off - speaker.on;
}

export const failedFlag = 1;

/** Numbers of what Leds knows, beside 0..7 of the ring, 8 body, 9 front: the turret's nine colours, the speaker. */
export const turretLed = 10, speakerLed = 19;
const ledsOfRobot = 32;

/** Events as they come, and of each track the numbers of its events in the order of their begins. */
export class Events {
  constructor() {
    this.clear(0);
  }
  clear(generation) {
    this.generation = generation;
    this.count = 0;
    this.begins = new Float64Array(1024);
    this.durations = new Float32Array(1024);
    this.tracks = new Uint16Array(1024);
    this.flags = new Uint8Array(1024);
    this.byTrack = [];
  }
  /** True if there may be more. A block of another generation begins everything again. */
  append(buffer) {
    const bytes = new Bytes(buffer);
    const [generation, first, count, all] = bytes.array(Uint32Array, 4);
    if (generation !== this.generation || first !== this.count) {
      this.clear(generation);
      if (first !== 0) return true;
    }
    while (this.begins.length < this.count + count) this.grow();
    this.begins.set(bytes.array(Float64Array, count), this.count);
    this.durations.set(bytes.array(Float32Array, count), this.count);
    this.tracks.set(bytes.array(Uint16Array, count), this.count);
    this.flags.set(bytes.array(Uint8Array, count), this.count);
    for (let i = this.count; i < this.count + count; ++i) {
      const track = this.tracks[i];
      while (this.byTrack.length <= track) this.byTrack.push({ numbers: [], sorted: null });
      this.byTrack[track].numbers.push(i);
      this.byTrack[track].sorted = null;
    }
    this.count += count;
    return this.count < all;
  }
  grow() {
    for (const name of ['begins', 'durations', 'tracks', 'flags']) {
      const larger = new this[name].constructor(2 * this[name].length);
      larger.set(this[name]);
      this[name] = larger;
    }
  }
  /** {numbers, begins, failed}: in the order of begins; failed[i] is how many of the first i failed. */
  track(index) {
    const track = this.byTrack[index];
    if (!track) return null;
    if (track.sorted) return track.sorted;
    const numbers = Uint32Array.from(track.numbers);
    let rising = true;
    for (let i = 1; i < numbers.length && rising; ++i)
      rising = this.begins[numbers[i - 1]] <= this.begins[numbers[i]];
    if (!rising) numbers.sort((a, b) => this.begins[a] - this.begins[b] || a - b);
    const begins = new Float64Array(numbers.length), failed = new Uint32Array(numbers.length + 1);
    for (let i = 0; i < numbers.length; ++i) {
      begins[i] = this.begins[numbers[i]];
      failed[i + 1] = failed[i] + (this.flags[numbers[i]] & failedFlag);
    }
    track.sorted = { numbers, begins, failed };
    return track.sorted;
  }
  /**
   * The nearest event that begins after (`forward`) or before `time`, of tracks for which `wanted(track)`; with
   * `failed` only one that failed. -1: none.
   */
  next(time, forward, wanted, failed) {
    let best = -1;
    for (let index = 0; index < this.byTrack.length; ++index) {
      if (!wanted(index)) continue;
      const track = this.track(index);
      const n = track.numbers.length;
      let i;
      if (forward) {
        i = countUpTo(track.begins, time);
        if (failed) i = countUpTo(track.failed, track.failed[i]) - 1;
        if (i >= n) continue;
      } else {
        i = countUpTo(track.begins, time);
        while (i > 0 && track.begins[i - 1] >= time) --i;
        if (failed) {  // the last of the first i that failed
          if (track.failed[i] === 0) continue;
          i = countUpTo(track.failed, track.failed[i] - 1);
        }
        --i;
        if (i < 0) continue;
      }
      const number = track.numbers[i];
      const nearer = best < 0 || (forward ? track.begins[i] < this.begins[best] : track.begins[i] > this.begins[best]);
      if (nearer) best = number;
    }
    return best;
  }
}

/** LEDs of robots, change by change. */
export class Leds {
  constructor() {
    this.count = 0;
    this.changes = new Map();
  }
  append(buffer) {
    const bytes = new Bytes(buffer);
    const [first, count, all] = bytes.array(Uint32Array, 4);
    if (first !== this.count) return false;
    const times = bytes.array(Float64Array, count), robots = bytes.array(Uint16Array, count);
    const leds = bytes.array(Uint8Array, count), values = bytes.array(Uint8Array, count);
    for (let i = 0; i < count; ++i) {
      const key = ledsOfRobot * robots[i] + leds[i];
      if (!this.changes.has(key)) this.changes.set(key, { times: [], values: [] });
      const list = this.changes.get(key);
      list.times.push(times[i]);
      list.values.push(values[i]);
    }
    this.count += count;
    return this.count < all;
  }
  isOn(robot, led, time) { return this.level(robot, led, time) !== 0; }
  /** 0 to 255, of a colour of the turret. */
  level(robot, led, time) {
    const list = this.changes.get(ledsOfRobot * robot + led);
    if (!list) return 0;
    const i = countUpTo(list.times, time);
    return i > 0 ? list.values[i - 1] : 0;
  }
}

export const fates = ['delivered', 'below threshold', 'queue full', 'collision', 'receiver read its peaks',
  'receiver served I2C', 'sender served I2C', 'receiver was sending', 'after an error', 'other'];
export const belowThreshold = 1, ircomWord = 32;

/** Light between stations, in the order of begins. */
export function parseBeams(buffer) {
  const bytes = new Bytes(buffer);
  const [count] = bytes.array(Uint32Array, 2);
  const begins = bytes.array(Float64Array, count), durations = bytes.array(Float32Array, count);
  const senders = bytes.array(Uint16Array, count), receivers = bytes.array(Uint16Array, count);
  const fate = bytes.array(Uint8Array, count);
  const order = Uint32Array.from(begins, (_, i) => i).sort((a, b) => begins[a] - begins[b]);
  const sorted = (values) => values.map((_, i) => values[order[i]]);
  return { begins: sorted(begins), durations: sorted(durations), senders: sorted(senders),
    receivers: sorted(receivers), fates: sorted(fate) };
}

/** Sensor values of one robot: {t, columns: Map of name to values}. */
export function parseSensors(buffer, names) {
  const bytes = new Bytes(buffer);
  const rows = bytes.number(), columns = bytes.number();
  const t = bytes.array(Float64Array, rows);
  const values = new Map();
  for (let i = 1; i < columns; ++i) values.set(names[i - 1], bytes.array(Float32Array, rows));
  return { t, columns: values };
}

/** 1, 2 or 5 times a power of ten, not below `least`. */
export function roundStep(least) {
  const power = 10 ** Math.floor(Math.log10(least));
  for (const times of [1, 2, 5]) if (times * power >= least * (1 - 1e-9)) return times * power;
  return 10 * power;
}
