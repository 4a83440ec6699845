// The arena seen from above: x to the right, y up. Wheel zooms, drag moves, click chooses, Shift+drag measures.
import { belowThreshold, countUpTo, ircomWord, plays, poseAt, roundStep, speakerLed, turretLed } from './model.js';
import { prepared } from './plot.js';

const defaultRadius = 0.035;  // m, of an e-puck
// m ahead of and left of the axle's middle: the turret's LEDs, as cameras see them (physics/camera/camera_scene.cpp).
const turretPlaces = [[0.013, -0.021], [0.013, 0.021], [-0.0325, -0.003]];
// Degrees clockwise from the front, of the eight proximity sensors (front right first).
const proximityDegrees = [17, 49, 90, 150, 210, 270, 311, 343];

export class ArenaView {
  /** `run`: head, paths, leds, beams (null until read); `chosen(index)` when a robot was clicked. */
  constructor(canvas, run, chosen, redraw) {
    this.canvas = canvas;
    this.run = run;
    this.chosen = chosen;
    this.redraw = redraw;
    this.centre = { x: 0, y: 0 };
    this.scale = 0;
    this.ruler = null;
    this.images = new Map();
    this.listen();
  }

  bounds() {
    const points = [];
    const arena = this.run.head.arena;
    if (arena) for (const [x, y] of arena.corners) points.push({ x, y });
    for (const path of this.run.paths)
      for (let i = 0; i < path.t.length; i += Math.max(1, path.t.length >> 8)) points.push({ x: path.x[i], y: path.y[i] });
    if (points.length === 0) return { left: -0.5, right: 0.5, bottom: -0.5, top: 0.5 };
    const margin = 0.05;
    const all = (pick, of) => points.reduce((best, p) => of(best, p[pick]), points[0][pick]);
    return { left: all('x', Math.min) - margin, right: all('x', Math.max) + margin, bottom: all('y', Math.min) - margin,
      top: all('y', Math.max) + margin };
  }
  fit() {
    const { left, right, bottom, top } = this.bounds();
    this.centre = { x: (left + right) / 2, y: (bottom + top) / 2 };
    this.scale = Math.min(this.canvas.clientWidth / (right - left), this.canvas.clientHeight / (top - bottom));
    this.fitted = true;
  }
  /** Pixels of a point of the world, and back. */
  at(x, y) {
    return [this.canvas.clientWidth / 2 + (x - this.centre.x) * this.scale,
      this.canvas.clientHeight / 2 - (y - this.centre.y) * this.scale];
  }
  world(px, py) {
    return { x: this.centre.x + (px - this.canvas.clientWidth / 2) / this.scale,
      y: this.centre.y - (py - this.canvas.clientHeight / 2) / this.scale };
  }

  listen() {
    const canvas = this.canvas;
    let drag = null;
    canvas.addEventListener('wheel', (event) => {
      event.preventDefault();
      const before = this.world(event.offsetX, event.offsetY);
      this.scale = Math.min(Math.max(this.scale * Math.exp(-event.deltaY * 0.0015), 5), 20000);
      const after = this.world(event.offsetX, event.offsetY);
      this.centre.x += before.x - after.x;
      this.centre.y += before.y - after.y;
      this.fitted = false;
      this.redraw();
    }, { passive: false });
    canvas.addEventListener('pointerdown', (event) => {
      canvas.setPointerCapture(event.pointerId);
      drag = { x: event.offsetX, y: event.offsetY, moved: false, measures: event.shiftKey };
      if (event.altKey && this.carry) drag.carries = this.nameAt(event.offsetX, event.offsetY);
      if (drag.measures) this.ruler = { from: this.world(drag.x, drag.y), to: this.world(drag.x, drag.y) };
      else this.ruler = null;
    });
    canvas.addEventListener('pointermove', (event) => {
      if (!drag) return;
      if (drag.carries) {
        this.ghost = this.world(event.offsetX, event.offsetY);
      } else if (drag.measures) {
        this.ruler.to = this.world(event.offsetX, event.offsetY);
      } else if (drag.moved || Math.hypot(event.offsetX - drag.x, event.offsetY - drag.y) > 3) {
        this.centre.x -= (event.offsetX - drag.x) / this.scale;
        this.centre.y += (event.offsetY - drag.y) / this.scale;
        drag = { ...drag, x: event.offsetX, y: event.offsetY, moved: true };
        this.fitted = false;
      }
      this.redraw();
    });
    canvas.addEventListener('pointerup', (event) => {
      if (drag && drag.carries && this.ghost) this.carry(drag.carries, this.ghost);
      else if (drag && !drag.moved && !drag.measures) this.choose(event.offsetX, event.offsetY);
      drag = null;
      this.ghost = null;
      this.redraw();
    });
  }
  /** The robot or thing at a place; '': none. */
  nameAt(px, py) {
    const place = this.world(px, py), arena = this.run.head.arena;
    const things = arena ? arena.things.map((thing) => ({ ...thing, reach: thing.radius || Math.hypot(thing.length, thing.width) / 2 })) : [];
    let best = '', least = Infinity;
    const look = (name, pose, reach) => {
      const away = pose ? Math.hypot(pose.x - place.x, pose.y - place.y) : Infinity;
      if (name && away < reach && away < least) { least = away; best = name; }
    };
    for (const thing of things) {
      const path = this.run.paths.find((one) => !one.robot && one.name === thing.name);
      look(thing.name, (path && poseAt(path, this.run.now)) || thing, thing.reach);
    }
    for (const path of this.run.paths) if (path.robot) look(path.name, poseAt(path, this.run.now), this.radius(path.name));
    return best;
  }
  choose(px, py) {
    let best = -1, distance = 25;  // pixels beside a robot that still mean it
    this.run.paths.forEach((path) => {
      const pose = path.robot ? poseAt(path, this.run.now) : null;
      if (!pose) return;
      const [x, y] = this.at(pose.x, pose.y);
      const away = Math.hypot(px - x, py - y) - this.radius(path.name) * this.scale;
      if (away < distance) { distance = away; best = this.run.head.stations.indexOf(path.name); }
    });
    if (best >= 0) this.chosen(best);
  }
  radius(name) {
    const robot = this.run.head.arena && this.run.head.arena.robots.find((one) => one.name === name);
    return robot ? robot.radius : defaultRadius;
  }

  draw(colours, options) {
    const { g, width, height } = prepared(this.canvas);
    if (width === 0) return;
    if (this.scale === 0 || (this.fitted && options.follow < 0)) this.fit();
    const followed = options.follow >= 0 ? this.poseOf(options.follow) : null;
    if (followed) this.centre = { x: followed.x, y: followed.y };
    this.g = g;
    this.colours = colours;
    this.named = [];
    g.fillStyle = colours.outside;
    g.fillRect(0, 0, width, height);
    this.floor();
    this.pheromones();
    this.grid(width, height);
    this.things(options);
    if (options.trail > 0) this.trails(options.trail);
    if (options.beams && this.run.beams) this.beams(options.persist);
    // The chosen robot first: its name is the one that stays.
    const chosen = this.run.head.stations[options.selected];
    const robots = this.run.paths.filter((path) => path.robot).sort((a, b) => (b.name === chosen) - (a.name === chosen));
    for (const path of robots) {
      const pose = poseAt(path, this.run.now);
      if (pose) this.robot(path.name, pose, options.selected);
    }
    if (options.tracker) this.tracked();
    if (this.ruler) this.measure();
    if (this.ghost) {
      g.beginPath();
      g.arc(...this.at(this.ghost.x, this.ghost.y), defaultRadius * this.scale, 0, 2 * Math.PI);
      g.setLineDash([4, 3]);
      g.strokeStyle = colours.text;
      g.stroke();
      g.setLineDash([]);
    }
    this.scaleBar(width, height);
  }
  poseOf(station) {
    const name = this.run.head.stations[station];
    const path = this.run.paths.find((one) => one.name === name);
    if (path) return poseAt(path, this.run.now);
    const booth = this.run.head.arena && this.run.head.arena.booths.find((one) => one.name === name);
    return booth || null;
  }
  grey(value) {
    const [dark, bright] = this.colours.floor;
    const level = Math.round(dark + (bright - dark) * value);
    return `rgb(${level},${level},${level})`;
  }
  polygon(points) {
    this.g.beginPath();
    points.forEach(([x, y]) => this.g.lineTo(...this.at(x, y)));
    this.g.closePath();
  }
  shape(shape, pose = shape) {
    if (shape.radius !== undefined) {
      this.g.beginPath();
      this.g.arc(...this.at(pose.x, pose.y), shape.radius * this.scale, 0, 2 * Math.PI);
      return;
    }
    const c = Math.cos(pose.heading), s = Math.sin(pose.heading), l = shape.length / 2, w = shape.width / 2;
    this.polygon([[l, w], [-l, w], [-l, -w], [l, -w]].map(([a, b]) => [pose.x + a * c - b * s, pose.y + a * s + b * c]));
  }
  floor() {
    const arena = this.run.head.arena, g = this.g;
    if (!arena) return;
    this.polygon(arena.corners);
    g.fillStyle = this.grey(arena.floor);
    g.fill();
    for (const patch of arena.patches) {
      this.shape(patch);
      g.fillStyle = this.grey(patch.grey);
      g.fill();
      if (patch.image) this.picture(patch);
    }
  }
  /** Where the overhead tracker saw whom. */
  tracked() {
    const g = this.g, r = 1.25 * defaultRadius * this.scale;
    g.strokeStyle = this.colours.tracker;
    g.lineWidth = 1.2;
    for (const { robot, x, y, heading } of this.run.tracked.at(this.run.now)) {
      const [px, py] = this.at(x, y);
      g.setLineDash([3, 3]);
      g.beginPath();
      g.arc(px, py, r, 0, 2 * Math.PI);
      g.moveTo(px, py);
      g.lineTo(px + 1.5 * r * Math.cos(heading), py - 1.5 * r * Math.sin(heading));
      g.stroke();
      g.setLineDash([]);
      this.label(robot, x, y, -r - 8);
    }
  }
  /** What lay where when it was last recorded. */
  pheromones() {
    const trails = (this.run.head.arena && this.run.head.arena.trails) || [], g = this.g;
    trails.forEach(({ side, grey }, i) => {
      const recorded = this.run.trails && this.run.trails[i];
      const at = recorded ? countUpTo(recorded.times, this.run.now) : 0;
      if (at === 0) return;
      g.fillStyle = this.grey(grey);
      for (const square of recorded.layers[at - 1]) {
        const [x, y] = this.at(square.x - side / 2, square.y + side / 2);
        g.globalAlpha = square.strength;
        g.fillRect(x, y, side * this.scale + 0.5, side * this.scale + 0.5);
      }
      g.globalAlpha = 1;
    });
  }
  /** Sound, from where it comes. */
  sound(x, y, from) {
    const g = this.g, [px, py] = this.at(x, y);
    g.strokeStyle = this.colours.ircom;
    g.lineWidth = 1.5;
    for (const away of [5, 10, 15]) {
      g.globalAlpha = 1 - away / 20;
      g.beginPath();
      g.arc(px, py, from + away, 0, 2 * Math.PI);
      g.stroke();
    }
    g.globalAlpha = 1;
  }
  picture(patch) {
    if (!this.images.has(patch)) this.images.set(patch, pictureOf(patch.image));
    const g = this.g;
    g.save();
    g.translate(...this.at(patch.x, patch.y));
    g.rotate(-patch.heading);
    const l = patch.length * this.scale, w = patch.width * this.scale;
    g.drawImage(this.images.get(patch), -l / 2, -w / 2, l, w);
    g.restore();
  }
  grid(width, height) {
    const step = roundStep(60 / this.scale), g = this.g;
    const low = this.world(0, height), high = this.world(width, 0);
    g.strokeStyle = this.colours.grid;
    g.lineWidth = 1;
    g.beginPath();
    for (let x = Math.ceil(low.x / step) * step; x <= high.x; x += step) {
      g.moveTo(this.at(x, 0)[0], 0);
      g.lineTo(this.at(x, 0)[0], height);
    }
    for (let y = Math.ceil(low.y / step) * step; y <= high.y; y += step) {
      g.moveTo(0, this.at(0, y)[1]);
      g.lineTo(width, this.at(0, y)[1]);
    }
    g.stroke();
  }
  things() {
    const arena = this.run.head.arena, g = this.g, colours = this.colours;
    if (!arena) return;
    for (const lamp of arena.lamps) {
      const [x, y] = this.at(lamp.x, lamp.y), reach = 0.22 * this.scale;
      const glow = g.createRadialGradient(x, y, 0, x, y, reach);
      glow.addColorStop(0, `${colours.lamp}66`);
      glow.addColorStop(1, `${colours.lamp}00`);
      g.fillStyle = glow;
      g.fillRect(x - reach, y - reach, 2 * reach, 2 * reach);
    }
    g.fillStyle = colours.wall;
    for (const wall of arena.fixed) { this.shape(wall); g.fill(); }
    for (const booth of arena.booths) this.booth(booth);
    g.lineWidth = 1.2;
    for (const thing of arena.things) {
      const path = this.run.paths.find((one) => !one.robot && one.name === thing.name);
      const pose = (path && poseAt(path, this.run.now)) || thing;
      this.shape(thing, { ...pose, heading: pose.heading || 0 });
      g.fillStyle = colours.thing;
      g.strokeStyle = colours.thingEdge;
      g.fill();
      g.stroke();
      this.label(thing.name, pose.x, pose.y, 0);
    }
    g.setLineDash([3, 3]);
    g.strokeStyle = colours.virtual;
    for (const thing of arena.virtuals || []) {
      const path = this.run.paths.find((one) => !one.robot && one.name === thing.name);
      const pose = (path && poseAt(path, this.run.now)) || thing;
      this.shape(thing, { ...pose, heading: pose.heading || 0 });
      g.stroke();
      this.label(thing.name, pose.x, pose.y, 0);
    }
    g.setLineDash([]);
    for (const [list, colour] of [[arena.lamps, colours.lamp], [arena.speakers, colours.ircom]])
      for (const one of list) {
        g.beginPath();
        g.arc(...this.at(one.x, one.y), 5, 0, 2 * Math.PI);
        g.fillStyle = colour;
        g.fill();
        this.label(one.name, one.x, one.y, 14);
      }
    for (const one of arena.speakers) if (plays(one, this.run.now)) this.sound(one.x, one.y, 5);
  }
  booth(booth) {
    const g = this.g;
    g.fillStyle = this.colours.thing;
    for (const part of booth.parts) { this.shape(part); g.fill(); }
    const changes = this.run.head.booths[booth.name] || [];
    const i = countUpTo(changes.map((one) => one[0]), this.run.now);
    const [red, green, blue] = i > 0 ? changes[i - 1].slice(1) : [0, 0, 0];
    const most = Math.max(red, green, blue);
    const c = Math.cos(booth.heading), s = Math.sin(booth.heading);
    g.beginPath();
    g.arc(...this.at(booth.x - 0.048 * c, booth.y - 0.048 * s), Math.max(0.010 * this.scale, 3), 0, 2 * Math.PI);
    g.fillStyle = most > 0 ? `rgb(${[red, green, blue].map((v) => Math.round((235 * v) / most)).join(',')})`
      : this.colours.thingEdge;
    g.fill();
    this.label(booth.name, booth.x - 0.06 * c, booth.y - 0.06 * s, 14);
  }
  /** Where there is room: what would lie over another name is left out. */
  label(text, x, y, below) {
    if (!text) return;
    const g = this.g, [px, py] = this.at(x, y);
    g.font = '11px system-ui, "DejaVu Sans", sans-serif';
    const half = g.measureText(text).width / 2 + 1, top = py + below - 6;
    if (this.named.some((one) => Math.abs(one.x - px) < one.half + half && Math.abs(one.top - top) < 11)) return;
    this.named.push({ x: px, top, half });
    g.textAlign = 'center';
    g.textBaseline = 'middle';
    g.lineWidth = 3;
    g.strokeStyle = this.colours.back;
    g.globalAlpha = 0.75;
    g.strokeText(text, px, py + below);
    g.globalAlpha = 1;
    g.fillStyle = this.colours.text;
    g.fillText(text, px, py + below);
  }
  trails(seconds) {
    const g = this.g, now = this.run.now;
    const from = now - seconds;
    this.run.paths.forEach((path) => {
      if (!path.robot) return;
      const first = Math.max(0, countUpTo(path.t, from) - 1), last = countUpTo(path.t, now);
      if (last - first < 1) return;
      const pose = poseAt(path, now), colour = this.colours.robot(this.run.head.stations.indexOf(path.name));
      const pieces = 12, step = Math.max(1, Math.ceil((last - first) / 3000));
      g.strokeStyle = colour;
      g.lineWidth = 2;
      g.lineJoin = 'round';
      for (let piece = 0; piece < pieces; ++piece) {
        const begin = first + Math.floor(((last - first) * piece) / pieces);
        const end = first + Math.floor(((last - first) * (piece + 1)) / pieces);
        g.globalAlpha = 0.15 + (0.7 * (piece + 1)) / pieces;
        g.beginPath();
        for (let i = begin; i <= Math.min(end, last - 1); i += step) g.lineTo(...this.at(path.x[i], path.y[i]));
        if (piece === pieces - 1) g.lineTo(...this.at(pose.x, pose.y));
        g.stroke();
      }
      g.globalAlpha = 1;
    });
  }
  beams(persist) {
    const { beams, now } = this.run, g = this.g, colours = this.colours;
    const longest = 0.05;  // s: no frame of light is longer
    let i = countUpTo(beams.begins, now - persist - longest);
    for (; i < beams.begins.length && beams.begins[i] <= now; ++i) {
      const age = now - beams.begins[i] - beams.durations[i];
      if (age > persist) continue;
      const from = this.poseOf(beams.senders[i]), to = this.poseOf(beams.receivers[i]);
      if (!from || !to) continue;
      const fate = beams.fates[i];
      const [ax, ay] = this.at(from.x, from.y), [bx, by] = this.at(to.x, to.y);
      g.globalAlpha = (1 - Math.max(age, 0) / persist) * (fate === belowThreshold ? 0.25 : 0.9);
      g.lineWidth = 2;
      g.setLineDash(fate === 0 ? [] : fate === ircomWord ? [2, 3] : [6, 4]);
      g.strokeStyle = fate === 0 ? colours.delivered : fate === ircomWord ? colours.ircom
        : fate === belowThreshold ? colours.dim : colours.failed;
      g.beginPath();
      g.moveTo(ax, ay);
      g.lineTo(bx, by);
      g.stroke();
      g.setLineDash([]);
      // The receiver's end: a dot where it arrived, a cross where it was lost.
      const x = bx + (ax - bx) * 0.28, y = by + (ay - by) * 0.28;
      g.beginPath();
      if (fate === 0 || fate === ircomWord) {
        g.arc(x, y, 3.2, 0, 2 * Math.PI);
        g.fillStyle = g.strokeStyle;
        g.fill();
      } else if (fate !== belowThreshold) {
        g.moveTo(x - 4, y - 4); g.lineTo(x + 4, y + 4); g.moveTo(x + 4, y - 4); g.lineTo(x - 4, y + 4);
        g.stroke();
      }
    }
    g.globalAlpha = 1;
  }
  robot(name, pose, selected) {
    const g = this.g, colours = this.colours;
    const index = this.run.head.stations.indexOf(name), colour = colours.robot(Math.max(index, 0));
    const spec = (this.run.head.arena && this.run.head.arena.robots.find((one) => one.name === name)) || {};
    const metres = Math.max(this.scale, 6 / defaultRadius);  // a robot far away stays a robot
    const r = (spec.radius || defaultRadius) * metres;
    if (index === selected) this.proximity(pose, r, metres);
    g.save();
    g.translate(...this.at(pose.x, pose.y));
    g.rotate(-pose.heading);
    if (index === selected) {
      g.beginPath();
      g.arc(0, 0, r + 4, 0, 2 * Math.PI);
      g.strokeStyle = colours.text;
      g.lineWidth = 1.5;
      g.stroke();
    }
    g.beginPath();
    g.arc(0, 0, r, 0, 2 * Math.PI);
    g.fillStyle = colours.part;
    g.fill();
    g.globalAlpha = 0.35;
    g.fillStyle = this.run.leds.isOn(index, 8, this.run.now) ? '#29c05a' : colour;
    g.fill();
    g.globalAlpha = 1;
    g.strokeStyle = colour;
    g.lineWidth = 2;
    g.stroke();
    const wheel = (spec.wheel || 0.0205) * metres, out = ((spec.axle || 0.053) / 2) * metres, tyre = 0.003 * metres;
    g.fillStyle = colours.text;
    for (const side of [-1, 1]) g.fillRect(-wheel, side * out - tyre, 2 * wheel, 2 * tyre);
    g.beginPath();
    for (const [a, b] of [[0.72, 0], [0.05, 0.34], [0.22, 0], [0.05, -0.34]]) g.lineTo(a * r, b * r);
    g.fillStyle = colour;
    g.fill();
    if (r > 9) this.leds(index, r);
    this.turret(index, r, metres);
    g.restore();
    if (this.run.leds.isOn(index, speakerLed, this.run.now)) this.sound(pose.x, pose.y, r);
    this.label(name, pose.x, pose.y, r + 11);
  }
  /** The three LEDs of the RGB turret, where the omnidirectional camera has them. */
  turret(index, r, metres) {
    const g = this.g, now = this.run.now;
    turretPlaces.forEach(([ahead, left], led) => {
      const level = [0, 1, 2].map((colour) => this.run.leds.level(index, turretLed + 3 * led + colour, now));
      const most = Math.max(...level);
      if (most === 0) return;
      g.beginPath();
      g.arc(ahead * metres, -left * metres, Math.max(0.16 * r, 2), 0, 2 * Math.PI);
      g.fillStyle = `rgb(${level.map((value) => Math.round((235 * value) / most)).join(',')})`;
      g.fill();
      g.lineWidth = 1;
      g.strokeStyle = this.colours.back;
      g.stroke();
    });
  }
  leds(index, r) {
    const g = this.g, now = this.run.now;
    const dot = (angle, at, on, colour) => {
      g.beginPath();
      g.arc(Math.cos(angle) * at, Math.sin(angle) * at, on ? 0.115 * r : 0.06 * r, 0, 2 * Math.PI);
      g.fillStyle = on ? colour : this.colours.thingEdge;
      g.fill();
      if (!on) return;
      g.lineWidth = 1;
      g.strokeStyle = this.colours.back;
      g.stroke();
    };
    // Clockwise from the front; the canvas turns clockwise, too.
    for (let led = 0; led < 8; ++led) dot((led * Math.PI) / 4, 0.86 * r, this.run.leds.isOn(index, led, now), '#ff3020');
    if (this.run.leds.isOn(index, 9, now)) dot(0, 1.08 * r, true, '#ff7060');
  }
  proximity(pose, r, metres) {
    const sensors = this.run.sensors;
    if (!sensors || !sensors.columns.has('proximity0')) return;
    const i = Math.max(0, countUpTo(sensors.t, this.run.now) - 1), g = this.g;
    const [x, y] = this.at(pose.x, pose.y);
    g.lineCap = 'round';
    proximityDegrees.forEach((degrees, sensor) => {
      const value = Math.max(0, sensors.columns.get(`proximity${sensor}`)[i]);
      const angle = -pose.heading + (degrees * Math.PI) / 180;
      const length = Math.min(1, Math.sqrt(value / 4000)) * 0.04 * metres;
      g.strokeStyle = this.colours.lamp;
      g.lineWidth = 5;
      g.beginPath();
      g.moveTo(x + Math.cos(angle) * r, y + Math.sin(angle) * r);
      g.lineTo(x + Math.cos(angle) * (r + length), y + Math.sin(angle) * (r + length));
      g.stroke();
    });
    g.lineCap = 'butt';
  }
  measure() {
    this.named = [];  // it is what one asks for
    const { from, to } = this.ruler, g = this.g;
    g.strokeStyle = this.colours.text;
    g.lineWidth = 1.5;
    g.beginPath();
    g.moveTo(...this.at(from.x, from.y));
    g.lineTo(...this.at(to.x, to.y));
    g.stroke();
    const turn = (Math.atan2(to.y - from.y, to.x - from.x) * 180) / Math.PI;
    this.label(`${(100 * Math.hypot(to.x - from.x, to.y - from.y)).toFixed(1)} cm, ${turn.toFixed(1)}°`,
      (from.x + to.x) / 2, (from.y + to.y) / 2, -12);
  }
  scaleBar(width, height) {
    const g = this.g, metres = roundStep(70 / this.scale), length = metres * this.scale;
    g.fillStyle = this.colours.text;
    g.fillRect(width - 14 - length, height - 14, length, 2);
    g.font = '11px system-ui, "DejaVu Sans", sans-serif';
    g.textAlign = 'right';
    g.textBaseline = 'bottom';
    g.fillText(metres >= 1 ? `${metres} m` : `${Math.round(metres * 1000) / 10} cm`, width - 14, height - 17);
  }
}

/** A picture on the floor: its width, then runs "RRGGBB" or "RRGGBB*count". */
function pictureOf({ width, height, pixels }) {
  const canvas = document.createElement('canvas');
  canvas.width = width;
  canvas.height = height;
  const g = canvas.getContext('2d'), data = g.createImageData(width, height);
  let at = 0;
  for (const run of pixels.split(' ').slice(1)) {
    const [hex, times] = run.split('*');
    const colour = parseInt(hex, 16);
    for (let k = 0; k < (Number(times) || 1) && at < data.data.length; ++k) {
      data.data.set([colour >> 16, (colour >> 8) & 255, colour & 255, 255], at);
      at += 4;
    }
  }
  g.putImageData(data, 0, 0);
  return canvas;
}
