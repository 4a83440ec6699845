// What there is of one robot: pose, LEDs, sensor values over the time that the timeline shows, its latest frames.
import { countUpTo, poseAt } from './model.js';
import { Layer, drawPlot, shortNumber } from './plot.js';

const groups = [
  ['proximity', 'counts', Array.from({ length: 8 }, (_, i) => `proximity${i}`)],
  ['ambient light', 'counts', Array.from({ length: 8 }, (_, i) => `ambient${i}`)],
  ['ground', 'counts', ['ground0', 'ground1', 'ground2']],
  ['wheels', 'steps/s', ['speed left', 'speed right']],
  ['accelerometer', 'counts', ['acc_x', 'acc_y', 'acc_z']],
  ['microphones', 'counts', ['mic_level0', 'mic_level1', 'mic_level2']],
  ['battery', 'V', ['battery_v']],
];
const recentCount = 12;

function changes(values) {
  return values.some((value) => value !== values[0]);
}

export class Panel {
  constructor(element, run, source, choose, jump) {
    Object.assign(this, { element, run, source, choose, jump, robot: -1, loading: null, shown: '' });
  }
  select(robot) {
    this.robot = robot;
    this.run.sensors = null;
    this.shown = '';
    this.element.replaceChildren();
    const stations = this.run.head.stations.slice(0, this.run.head.robots);
    const chooser = document.createElement('select');
    chooser.id = 'robot';
    stations.forEach((name, i) => chooser.append(new Option(name, i, false, i === robot)));
    chooser.addEventListener('change', () => this.choose(Number(chooser.value)));
    this.table = document.createElement('table');
    this.plots = document.createElement('div');
    this.recent = document.createElement('ul');
    this.recent.id = 'recent';
    const heading = document.createElement('h2');
    heading.textContent = 'Latest frames and log lines';
    this.element.append(chooser, this.table, heading, this.recent, this.plots);
    return this.load(robot);
  }
  async load(robot) {
    if (robot < 0 || robot >= this.run.head.robots) return;
    const sensors = await this.run.sensorsOf(robot);
    if (this.robot !== robot) return;
    for (const side of ['left', 'right']) {
      const steps = sensors.columns.get(`steps_${side}`);
      if (!steps) continue;
      const speed = new Float32Array(steps.length);
      for (let i = 1; i < steps.length; ++i)
        speed[i] = (steps[i] - steps[i - 1]) / (sensors.t[i] - sensors.t[i - 1] || 1);
      sensors.columns.set(`speed ${side}`, speed);
    }
    this.run.sensors = sensors;
    this.drawn = [];
    this.plots.replaceChildren();
    for (const [name, unit, columns] of groups) {
      const lines = columns.filter((column) => sensors.columns.has(column));
      if (!lines.some((column) => changes(sensors.columns.get(column)))) continue;  // a sensor that is not there
      const label = document.createElement('div'), value = document.createElement('span');
      const box = document.createElement('div'), canvas = document.createElement('canvas');
      label.className = 'name';
      label.append(`${name} (${unit})`, value);
      box.className = 'plot';
      box.append(canvas);
      this.plots.append(label, box);
      this.drawn.push({ canvas, value, layer: new Layer(), lines: lines.map((column) => ({ t: sensors.t, values: sensors.columns.get(column) })) });
    }
    this.run.redraw();
  }
  draw(colours, from, to) {
    if (this.robot < 0) return;
    const name = this.run.head.stations[this.robot];
    const path = this.run.paths.find((one) => one.name === name);
    const pose = path ? poseAt(path, this.run.now) : null;
    const lit = [...Array(10).keys()].filter((led) => this.run.leds.isOn(this.robot, led, this.run.now))
      .map((led) => (led < 8 ? `LED${led}` : led === 8 ? 'body' : 'front'));
    const rows = [];
    if (pose) {
      const degrees = (((pose.heading * 180) / Math.PI) % 360 + 540) % 360 - 180;
      rows.push(['position', `${(100 * pose.x).toFixed(2)}, ${(100 * pose.y).toFixed(2)} cm`], ['heading', `${degrees.toFixed(1)}°`]);
    }
    rows.push(['lit', lit.length ? lit.join(' ') : 'no LED']);
    if (this.run.sensors && this.run.sensors.columns.has('proximity0')) {
      const i = Math.max(0, countUpTo(this.run.sensors.t, this.run.now) - 1);
      rows.push(['proximity', groups[0][2].map((column) => shortNumber(this.run.sensors.columns.get(column)[i])).join(' ')]);
    }
    const text = rows.map((row) => row.join('\t')).join('\n');
    if (text !== this.shown) {
      this.shown = text;
      this.table.replaceChildren(...rows.map((row) => {
        const line = document.createElement('tr');
        for (const cell of row) line.append(Object.assign(document.createElement('td'), { textContent: cell }));
        return line;
      }));
    }
    if (!this.run.sensors || !this.drawn) return;
    const i = Math.max(0, countUpTo(this.run.sensors.t, this.run.now) - 1);
    for (const { canvas, value, layer, lines } of this.drawn) {
      const now = lines.length > 3 ? '' : lines.map(({ values }) => shortNumber(values[i])).join('  ');
      if (value.textContent !== now) value.textContent = now;
      drawPlot(layer, canvas, lines.map((line, k) => ({ ...line, colour: colours.robot(k) })), from, to, this.run.now, colours);
    }
  }
  /** The events of the robot just before now; asked for a few times a second at most. */
  async refreshRecent() {
    const name = this.run.head.stations[this.robot];
    if (name === undefined) return;
    const { events, tracks, now } = this.run;
    const numbers = [];
    tracks.forEach((track, index) => {
      const sorted = track.robot === name ? events.track(index) : null;
      if (!sorted) return;
      const end = countUpTo(sorted.begins, now);
      for (let i = Math.max(0, end - recentCount); i < end; ++i) numbers.push(sorted.numbers[i]);
    });
    numbers.sort((a, b) => events.begins[b] - events.begins[a] || b - a);
    const latest = numbers.slice(0, recentCount), key = `${events.generation}:${latest.join(',')}`;
    if (this.loading === key) return;
    this.loading = key;
    const texts = latest.length ? await this.source.texts(latest) : [];
    if (this.loading !== key) return;
    this.recent.replaceChildren(...latest.map((number, i) => {
      const line = document.createElement('li');
      const time = events.begins[number];
      line.textContent = `${time.toFixed(6)} ${texts[i]}`;
      line.title = `${tracks[events.tracks[number]].name}\n${texts[i]}`;
      if (events.flags[number] & 1) line.className = 'failed';
      line.addEventListener('click', () => this.jump(time, number));
      return line;
    }));
  }
}
