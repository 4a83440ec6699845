// Joins the parts: reads the run, keeps the time, hears keys and buttons, draws when something has changed.
import { ArenaView } from './arena.js';
import { BoardPart } from './board.js';
import { Cameras } from './cameras.js';
import { FaultForm } from './fault_form.js';
import { Live, sensorsAgainAfter } from './live.js';
import { Events, Leds, belowThreshold, ircomWord, parseBeams, parsePoses, parseSensors, parseTrails, Tracked } from './model.js';
import { palette } from './palette.js';
import { NetworkPart } from './network.js';
import { Panel } from './panel.js';
import { makeSource } from './source.js';
import { Terminal } from './terminal.js';
import { TimelineView } from './timeline.js';
import { WorldForm } from './world_form.js';

const element = (id) => document.getElementById(id);
const passOf = (generation) => Math.floor(generation / 65536);  // of reading the events of a run that goes on
const pollMilliseconds = 250, recentMilliseconds = 150;

class App {
  constructor() {
    this.source = makeSource();
    this.playing = false;
    this.dirty = true;
    this.selectedEvent = -1;
    this.found = null;  // numbers of events that the search text is in, or null
    this.dark = matchMedia('(prefers-color-scheme: dark)').matches;
  }

  async begin() {
    const head = await this.source.head();
    const paths = parsePoses(await this.source.poses(), head.paths);
    this.run = { head, paths, leds: new Leds(), events: new Events(), beams: null, tracked: new Tracked(), sensors: null, tracks: [], rows: [],
      begin: () => { this.stale = passOf(this.run.events.generation); this.run.events = new Events(); this.run.leds = new Leds(); this.run.beams = null; this.run.tracked = new Tracked(); this.terminal.begin(); this.select(-1); },
      now: 0, duration: Math.max(head.duration_s, 1e-3), redraw: () => { this.dirty = true; },
      sensorsOf: async (robot) => parseSensors(await this.source.sensors(robot), head.sensors) };
    const redraw = this.run.redraw;
    this.arena = new ArenaView(element('arena'), this.run, (robot) => this.choose(robot), redraw);
    this.timeline = new TimelineView(element('timeline'), this.run, (time, number) => this.jump(time, number), redraw);
    this.cameras = new Cameras(element('cameras'), this.run, this.source);
    this.panel = new Panel(element('panel'), this.run, this.source, (robot) => this.choose(robot),
      (time, number) => this.jump(time, number));
    if (head.live) {
      this.live = new Live(this.run, this.source, redraw, (error) => this.trouble(error));
      await this.live.listen();
      element('live').hidden = false;
      element('speed').append(new Option('max', 0));
      const possible = this.possible = await this.source.json('possible');
      this.board = new BoardPart(element('board-part'), possible.boards || [], (request) => this.drive(request));
      this.faultForm = new FaultForm(element('fault-form'), possible, (request) => this.drive(request));
      this.worldForm = new WorldForm(element('world-form'), possible, () => this.objects(), (request) => this.drive(request));
      this.arena.carry = (name, to) => this.drive({ do: 'act', command: `move ${name} to ${to.x.toFixed(4)} m, ${to.y.toFixed(4)} m` });
    }
    const serial = head.live ? this.possible.places.filter((place) => place.on === 'uart') : (head.report || {}).serial;
    this.terminal = new Terminal(element('terminal-part'), this.source.serial ? serial || [] : [], this.source,
      this.live ? (request) => this.drive(request) : null, redraw);
    this.network = new NetworkPart(element('network-part'), this.source, this.live ? (request) => this.drive(request) : null);
    this.fill();
    this.listen();
    this.theme();
    this.timeline.all();
    if (head.robots > 0) this.choose(0);
    await this.cameras.load();
    document.body.dataset.ready = 'arena';
    const asked = Number(new URLSearchParams(location.search).get('t'));
    if (asked > 0 && !this.live) {
      this.seek(asked);
      this.timeline.place(asked - 1, 2);
    }
    requestAnimationFrame((time) => this.frame(time));
    await this.readEvents();
    document.body.dataset.ready = 'all';
    while (this.live) {
      await new Promise((resolve) => setTimeout(resolve, sensorsAgainAfter));
      const { over } = this.live.state;
      await this.readEvents();
      await this.panel.load(this.robot);
      await this.cameras.load();
      if (over && this.settled) break;
      this.settled = over;
    }
  }

  fill() {
    const { head } = this.run, report = head.report;
    const title = report ? report.scenario : head.live ? this.possible.scenario || 'a run that goes on' : 'a run';
    element('title').textContent = title;
    document.title = `${title} - puckloop`;
    const outcome = element('outcome');
    outcome.textContent = report ? `seed ${report.seed}, ${this.run.duration.toFixed(3)} s, ${report.success ? '' : 'failed: '}${report.ended_why}`
      : head.live ? '' : `${this.run.duration.toFixed(3)} s, no report`;
    outcome.className = report && !report.success ? 'failed' : '';
    this.notes([...head.notes, ...(report ? report.warnings : [])]);
    element('slider').max = this.run.duration;
    head.stations.forEach((name, i) => element('follow').append(new Option(name, i)));
    element('legend').replaceChildren();
    this.legend();
  }
  notes(list) {
    const notes = element('notes');
    notes.hidden = list.length === 0;
    notes.replaceChildren(...list.map((text) => Object.assign(document.createElement('li'), { textContent: text })));
  }
  legend() {
    const colours = this.colours();
    const part = (colour, style, text) => {
      const line = document.createElement('i');
      line.style.borderTopColor = colour;
      line.style.borderTopStyle = style;
      return [line, text];
    };
    const present = new Set(this.run.beams ? this.run.beams.fates : []);
    const lost = [...present].some((fate) => fate > belowThreshold && fate !== ircomWord);
    element('legend').hidden = present.size === 0;
    element('legend').replaceChildren(...(present.has(0) ? part(colours.delivered, 'solid', 'delivered') : []),
      ...(lost ? part(colours.failed, 'dashed', 'lost') : []),
      ...(present.has(belowThreshold) ? part(colours.dim, 'dashed', 'out of reach') : []),
      ...(present.has(ircomWord) ? part(colours.ircom, 'dotted', 'IRcom') : []));
  }
  colours() { return palette(this.dark); }
  theme() {
    document.documentElement.classList.toggle('dark', this.dark);
    this.legend();
    this.run.redraw();
  }

  async readEvents() {
    const { run } = this;
    for (let part; (part = await this.source.tracked(run.tracked.bytes)).byteLength > 0;) run.tracked.append(part);
    element('tracker-part').hidden = run.tracked.times.length === 0;
    if (run.head.arena && run.head.arena.trails.length > 0) run.trails = parseTrails(await this.source.trails());
    for (;;) {
      const status = await this.source.status();
      if (passOf(status.generation) === this.stale) return;  // from before the run went back
      run.tracks = status.tracks;
      this.rows();  // a run that went back has fewer
      if (status.generation !== run.events.generation && run.leds.count > 0) run.leds = new Leds();
      let more = run.events.count < status.events || run.events.generation !== status.generation;
      while (more) {
        more = run.events.append(await this.source.events(run.events.count));
        this.rows();
        run.redraw();
      }
      while (run.leds.count < status.leds && run.leds.append(await this.source.leds(run.leds.count))) run.redraw();
      if (status.done || status.beams > (run.beams ? run.beams.begins.length : 0)) {
        run.beams = parseBeams(await this.source.beams());
        this.legend();
      }
      this.rows();
      run.redraw();
      element('progress').value = status.progress;
      element('progress').title = status.reading;
      document.body.dataset.events = run.events.count;
      if (status.done) {
        element('progress').hidden = true;
        const notes = [...run.head.notes, ...(run.head.report ? run.head.report.warnings : [])];
        if (status.trouble) notes.unshift(`not everything could be read: ${status.trouble}`);
        if (status.left_out > 0) notes.push(`${status.left_out} frames in which nothing is wrong are left out, so that the page stays quick`);
        if (status.leds_left_out > 0) notes.push(`${status.leds_left_out} changes of LEDs are left out`);
        this.notes(notes);
        return;
      }
      await new Promise((resolve) => setTimeout(resolve, pollMilliseconds));
    }
  }
  /** Tracks in the order of the robots, those of nobody last; in each robot by name. */
  rows() {
    const { tracks, head } = this.run;
    const place = (track) => { const i = head.stations.indexOf(track.robot); return i < 0 ? 1e9 : i; };
    this.run.rows = tracks.map((_, i) => i).sort((a, b) => place(tracks[a]) - place(tracks[b])
      || (tracks[a].name < tracks[b].name ? -1 : 1));
    const chooser = element('find-track');
    if (chooser.options.length === tracks.length + 1) return;
    const before = chooser.value;
    chooser.replaceChildren(new Option('all tracks', -1), ...this.run.rows.map((i) => new Option(tracks[i].name, i)));
    chooser.value = before;
  }

  choose(robot) {
    this.robot = robot;
    this.panel.select(robot).catch((error) => this.trouble(error));
    this.cameras.show(this.run.head.stations[robot]);
    if (Number(element('follow').value) >= 0) element('follow').value = robot;
    document.body.dataset.robot = this.run.head.stations[robot];
    this.run.redraw();
  }
  seek(time) {
    this.run.now = Math.min(Math.max(time, 0), this.run.duration);
    element('slider').value = this.run.now;
    element('time').textContent = `${this.run.now.toFixed(this.timeline.to - this.timeline.from < 0.5 ? 6 : 3)} s`;
    document.body.dataset.time = this.run.now.toFixed(6);
    this.run.redraw();
  }
  jump(time, number) {
    if (this.live) this.live.atEdge = false; else this.play(false);
    this.seek(time);
    this.timeline.show(time);
    this.select(number).catch((error) => this.trouble(error));
  }
  async select(number) {
    this.selectedEvent = number;
    this.timeline.selected = number;
    this.run.redraw();
    if (number < 0) {
      element('detail').textContent = '';
      element('detail').className = '';
      return;
    }
    const { events, tracks, head } = this.run;
    this.timeline.reveal(events.tracks[number]);
    const track = tracks[events.tracks[number]], failed = (events.flags[number] & 1) !== 0;
    const robot = head.stations.indexOf(track.robot);
    if (robot >= 0 && robot < head.robots && robot !== this.robot) this.choose(robot);
    const [text] = await this.source.texts([number]);
    if (this.selectedEvent !== number) return;
    const took = events.durations[number] > 0 ? `, ${(1e3 * events.durations[number]).toFixed(3)} ms` : '';
    element('detail').textContent = `${events.begins[number].toFixed(6)} s${took}  ${track.name}  ${text}`;
    element('detail').className = failed ? 'failed' : '';
  }
  /** Names of all that an action can be about: what was there at the beginning, and what has come. */
  objects() {
    const known = (this.possible.objects || []).map((one) => one.name);
    return [...new Set([...known, ...this.run.paths.map((path) => path.name), 'floor', 'light'])];
  }
  /** Has the run do something; what is refused is shown. */
  drive(request) {
    return this.live.ask(request).catch((error) => {
      element('detail').textContent = error.message;
      element('detail').className = 'failed';
    });
  }
  play(on) {
    if (this.live) {
      if (on) this.live.atEdge = true;
      if (on || this.live.state.playing || this.live.state.until) this.drive(on ? { do: 'play', speed: Number(element('speed').value) } : { do: 'pause' });
      return;
    }
    if (on && this.run.now >= this.run.duration) this.seek(0);
    this.playing = on;
    element('play').textContent = on ? '❚❚' : '▶';
    document.body.dataset.playing = on;
    this.before = null;
  }

  async search() {
    const text = element('find').value.trim();
    const asked = (this.asked = (this.asked || 0) + 1);
    const numbers = text ? await this.source.find(text) : null;
    if (asked !== this.asked) return;
    this.found = numbers;
    const list = this.matches();
    this.timeline.marks = list.map((number) => this.run.events.begins[number]);
    element('found').textContent = text ? `${list.length} found` : '';
    this.run.redraw();
  }
  /** Of the search text: numbers in the order of time, of the chosen tracks. */
  matches() {
    const { events } = this.run, track = Number(element('find-track').value), failed = element('find-failed').checked;
    return [...(this.found || [])].filter((n) => n < events.count && (track < 0 || events.tracks[n] === track)
      && (!failed || (events.flags[n] & 1))).sort((a, b) => events.begins[a] - events.begins[b] || a - b);
  }
  async step(forward) {
    const { events } = this.run;
    let number = -1;
    if (element('find').value.trim()) {
      await this.search();
      const list = this.matches(), at = list.indexOf(this.selectedEvent);
      if (at >= 0) number = list[at + (forward ? 1 : -1)] ?? -1;
      else if (forward) number = list.find((n) => events.begins[n] > this.run.now) ?? -1;
      else number = list.findLast((n) => events.begins[n] < this.run.now) ?? -1;
    } else {
      const track = Number(element('find-track').value);
      number = events.next(this.run.now, forward, (index) => track < 0 || index === track,
        element('find-failed').checked || track < 0);
    }
    element('found').textContent = number < 0 ? `no ${forward ? 'later' : 'earlier'} one` : element('found').textContent.replace(/^no .*/, '');
    if (number >= 0) this.jump(events.begins[number], number);
  }
  marker(next) {
    const { markers } = this.timeline, now = this.run.now;
    if (next) {
      if (markers.length) this.jump(markers.find((time) => time > now + 1e-9) ?? markers[0], -1);
      return;
    }
    const there = markers.findIndex((time) => Math.abs(time - now) < 1e-6);
    if (there >= 0) markers.splice(there, 1); else markers.push(now);
    markers.sort((a, b) => a - b);
    this.run.redraw();
  }

  listen() {
    const on = (id, what, act) => element(id).addEventListener(what, (event) => {
      Promise.resolve(act(event)).catch((error) => this.trouble(error));
    });
    on('play', 'click', () => this.play(!(this.live ? this.live.state.playing || this.live.state.until : this.playing)));
    if (this.live) {
      on('speed', 'change', () => this.live.state.playing && this.play(true));
      on('step-1', 'click', () => { this.live.atEdge = true; return this.drive({ do: 'step', ms: 1 }); });
      on('step-100', 'click', () => { this.live.atEdge = true; return this.drive({ do: 'step', ms: 100 }); });
      on('to-edge', 'click', () => { this.live.atEdge = true; this.run.redraw(); });
      const back = (to) => { this.live.atEdge = true; return this.drive({ do: 'back', to_s: Math.max(0, to) }); };
      on('back-5', 'click', () => back(this.live.state.time_s - 5));
      on('back-here', 'click', () => back(this.run.now));
      on('fault-open', 'click', () => { this.play(false); this.faultForm.open(this.live.state.time_s); });
      on('world-open', 'click', () => this.worldForm.open(this.run.head.stations[this.robot]));
      on('press-reset', 'click', () => this.drive({ do: 'act', command: `reset ${this.run.head.stations[this.robot]}` }));
      on('end-run', 'click', () => this.drive({ do: 'end' }));
      on('take', 'click', () => this.drive({ do: 'take' }));
    }
    on('slider', 'input', () => { if (this.live) this.live.atEdge = false; this.seek(Number(element('slider').value)); this.timeline.show(this.run.now); });
    on('theme', 'click', () => { this.dark = !this.dark; this.theme(); });
    on('arena-fit', 'click', () => { element('follow').value = -1; this.arena.fit(); this.run.redraw(); });
    for (const id of ['follow', 'trail', 'beams', 'tracker']) on(id, 'change', () => this.run.redraw());
    on('find', 'input', () => this.search());
    for (const id of ['find-track', 'find-failed']) on(id, 'change', () => this.search());
    on('find-next', 'click', () => this.step(true));
    on('find-back', 'click', () => this.step(false));
    on('help-open', 'click', () => element('help').showModal());
    addEventListener('resize', () => this.run.redraw());
    addEventListener('keydown', (event) => this.key(event));
  }
  key(event) {
    const target = event.target;
    if (target.id === 'command') {
      if (event.key === 'Enter' && target.value.trim()) this.drive({ do: 'act', command: target.value.trim() });
      return undefined;
    }
    if (target.id === 'until') {
      if (event.key !== 'Enter' || !target.value.trim()) return undefined;
      target.classList.remove('failed');
      this.live.atEdge = true;
      this.drive({ do: 'until', condition: target.value.trim(), board: this.board.board });
      return undefined;
    }
    if (target.tagName === 'INPUT' && target.type !== 'range' && target.type !== 'checkbox' && target.id !== 'find') return undefined;
    if (target.id === 'find' && event.key === 'Enter') {
      event.preventDefault();
      return this.step(!event.shiftKey).catch((error) => this.trouble(error));
    }
    if (target.id === 'find' || target.tagName === 'SELECT' || event.ctrlKey || event.metaKey || element('help').open || element('fault-form').open || element('world-form').open) {
      if (target.id === 'find' && event.key === 'Escape') target.blur();
      return undefined;
    }
    const small = event.altKey ? 0.001 : event.shiftKey ? 1 : 0.1;
    const move = (by) => { if (this.live) this.live.atEdge = false; else this.play(false); this.seek(this.run.now + by); this.timeline.show(this.run.now); };
    const keys = {
      ' ': () => element('play').click(), ArrowLeft: () => move(-small), ArrowRight: () => move(small),
      Home: () => move(-1e9), End: () => move(1e9), n: () => this.step(true), N: () => this.step(false),
      '+': () => this.timeline.zoom(0.6, this.run.now), '-': () => this.timeline.zoom(1 / 0.6, this.run.now),
      0: () => this.timeline.all(), f: () => element('arena-fit').click(), m: () => this.marker(false),
      i: () => this.live && this.board.board && this.board.stepper.click(), I: () => keys.i(), M: () => this.marker(true), '/': () => element('find').focus(), '?': () => element('help').showModal(),
    };
    const act = keys[event.key];
    if (!act) return undefined;
    event.preventDefault();
    return Promise.resolve(act()).catch((error) => this.trouble(error));
  }
  /** For pictures: without what one clicks on. */
  still(dark) {
    document.body.classList.add('still');
    this.dark = dark;
    this.theme();
    this.arena.fit();
    this.timeline.all();
  }
  /** Everything as it is at a time, drawn. */
  async show(time, speed) {
    this.seek(time);
    this.stillSpeed = speed;
    await this.panel.refreshRecent();
    const drawn = () => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
    this.run.redraw();
    await drawn();
    await this.cameras.pending;
  }
  trouble(error) {
    document.body.dataset.trouble = error.message;
    element('detail').textContent = `${error.message} (is \`puckloop view\` still on?)`;
    element('detail').className = 'failed';
  }

  showLive(time) {
    const { run, live } = this, { state } = live;
    const now = live.advance(run.now, this.before ? Math.min(time - this.before, 200) : 0);
    this.before = time;
    element('slider').max = run.duration;
    if (now !== run.now) {
      this.seek(now);
      const span = this.timeline.to - this.timeline.from;
      if (now > this.timeline.to || span < 10 && run.duration < 10) this.timeline.place(Math.max(0, now - 0.8 * span), Math.max(span, Math.min(10, run.duration)));
    }
    element('play').textContent = state.playing || state.until ? '\u275a\u275a' : '\u25b6';
    element('take').hidden = live.drives;
    for (const part of element('live').querySelectorAll('button, input')) part.disabled = state.over && part.id !== 'to-edge';
    document.body.dataset.playing = state.playing;
    document.body.dataset.simulated = state.time_s.toFixed(6);
    document.body.dataset.over = state.over;
    document.body.dataset.epoch = state.epoch;
    this.board.draw(state.look);
    if (state.time_s !== this.readUntil) {
      this.readUntil = state.time_s;
      this.terminal.read().catch((error) => this.trouble(error));
    }
    const last = state.acts.at(-1);
    const line = (act) => `${act.command}: ${act.answer || 'the world has not come to it yet'}`;
    // Of the last three: what was refused is not hidden by what came after it.
    const shown = state.acts.slice(-3).filter((act) => act === last || act.refused);
    const text = state.until ? `on until ${state.until}: ${state.time_s.toFixed(3)} s; pause stops it`
      : state.over ? `the run is over: ${state.why}` : shown.map(line).join('\n');
    const said = `${last ? last.number : 0} ${text}`;
    if (said !== this.said) {
      this.said = said;
      element('detail').textContent = text;
      element('detail').className = !state.over && shown.some((act) => act.refused) ? 'failed' : '';
      if (last && last.command.startsWith('until ')) element('until').classList.toggle('failed', last.refused);
    }
  }

  frame(time) {
    requestAnimationFrame((next) => this.frame(next));
    const { run } = this, speed = this.stillSpeed || Number(element('speed').value);
    if (this.playing) {
      if (this.before !== null) this.seek(run.now + (speed * Math.min(time - this.before, 200)) / 1000);
      this.before = time;
      if (run.now >= run.duration) this.play(false);
      this.timeline.show(run.now);
    }
    if (this.live) this.showLive(time);
    if (!this.dirty) return;
    this.dirty = false;
    const colours = this.colours();
    this.arena.draw(colours, { follow: Number(element('follow').value), trail: Number(element('trail').value),
      beams: element('beams').checked, tracker: element('tracker').checked, persist: Math.max(0.1 * speed, 0.02), selected: this.robot });
    this.timeline.draw(colours);
    // Positions come each 100 ms, bytes at once.
    const known = this.live && this.live.atEdge ? Math.max(run.now, this.live.state.time_s) : run.now;
    this.terminal.draw(known);
    this.cameras.draw(run.now);
    this.network.draw(known);
    this.panel.draw(colours, Math.max(0, this.timeline.from), Math.min(this.timeline.to, run.duration));
    if (!(time - this.recentAt < recentMilliseconds)) {
      this.recentAt = time;
      this.panel.refreshRecent().catch((error) => this.trouble(error));
    } else if (!this.recentTimer) {
      this.recentTimer = setTimeout(() => {
        this.recentTimer = null;
        this.panel.refreshRecent().catch((error) => this.trouble(error));
      }, recentMilliseconds);
    }
  }
}

const app = new App();
window.puckloopView = app;  // for tests, and for who looks into the page
app.begin().catch((error) => app.trouble(error));
