// A serial line as a terminal: what both ends sent until now, and, of a run that goes on, a line to type into.
import { countUpTo } from './model.js';

const shownBytes = 3000;  // before the time that is shown
const lostByte = 1, typedByte = 2, lineBreak = 3;  // kinds of bytes
const endings = { 'CR': '\r', 'LF': '\n', 'CR LF': '\r\n', 'nothing': '' };

/** A byte as text: null where it is none. */
function letterOf(value) {
  return value === 10 ? '\n' : value >= 32 && value < 127 ? String.fromCharCode(value) : null;
}

export class Terminal {
  /** `lines`: name, ends. `ask(request)` has the run do something; null: a recorded run. */
  constructor(element, lines, source, ask, redraw) {
    Object.assign(this, { element, source, ask, redraw, drawn: '', reading: false });
    this.lines = new Map(lines.map((line) => [line.name, line]));
    this.chooser = Object.assign(document.createElement('select'), { id: 'serial' });
    this.chooser.append(new Option('no serial line', ''), ...lines.map((line) => new Option(line.name, line.name)));
    this.chooser.addEventListener('change', () => this.choose());
    this.form = Object.assign(document.createElement('div'), { id: 'terminal-form' });
    this.hex = Object.assign(document.createElement('input'), { type: 'checkbox', id: 'terminal-hex' });
    this.hex.addEventListener('change', () => { this.drawn = ''; redraw(); });
    const hexLabel = document.createElement('label');
    hexLabel.append(this.hex, ' hex');
    this.end = Object.assign(document.createElement('select'), { id: 'terminal-end', title: 'the end that is typed at' });
    this.ending = Object.assign(document.createElement('select'), { id: 'terminal-ending', title: 'what follows each line' });
    this.ending.append(...Object.keys(endings).map((name) => new Option(name, name)));
    this.input = Object.assign(document.createElement('input'), { id: 'terminal-input', placeholder: 'type, and Enter' });
    this.input.addEventListener('keydown', (event) => {
      if (event.key === 'Enter') this.type();
      event.stopPropagation();
    });
    this.text = Object.assign(document.createElement('pre'), { id: 'terminal' });
    this.form.append(hexLabel);
    if (ask) this.form.append(this.end, this.ending, this.input);
    element.append(this.chooser, this.text, this.form);
    element.hidden = lines.length === 0;
    this.choose();
  }
  get line() { return this.lines.get(this.chooser.value); }
  choose() {
    const { line } = this;
    this.form.hidden = this.text.hidden = !line;
    this.end.replaceChildren(...(line ? line.ends : []).map((end) => new Option(`as ${end}`, end)));
    this.begin();
  }
  /** What is known of the line is read again: another line, or the run went back. */
  begin() {
    Object.assign(this, { next: 0, t: [], from: [], values: [], kinds: [], drawn: '' });
    this.generation = (this.generation || 0) + 1;
    this.text.replaceChildren();
    if (this.line) this.read().catch(() => {});
  }
  type() {
    const text = this.input.value + endings[this.ending.value];
    if (text === '') return;
    this.ask({ do: 'type', link: this.chooser.value, from: this.end.value, text });
    this.input.value = '';
  }
  /** The bytes that came since. */
  async read() {
    if (!this.line) return;
    if (this.reading === this.generation) {
      this.again = true;
      return;
    }
    const { generation } = this;
    this.reading = generation;
    try {
      for (let more = true; more;) {
        const got = await this.source.serial(this.next, this.chooser.value);
        if (generation !== this.generation) return;
        this.next = got.next;
        ({ more } = got);
        got.t.forEach((t, i) => {
          this.t.push(t);
          this.from.push(got.from[got.f[i]]);
          this.values.push(got.v[i]);
          this.kinds.push(got.k[i]);
        });
        if (got.t.length) this.redraw();
        if (this.again) more = true;
        this.again = false;
      }
    } finally {
      if (this.reading === generation) this.reading = false;
    }
  }
  draw(now) {
    if (!this.line) return;
    const end = countUpTo(this.t, now), begin = Math.max(0, end - shownBytes);
    const key = `${begin} ${end} ${this.generation}`;
    if (key === this.drawn) return;
    this.drawn = key;
    const parts = [];
    for (let i = begin; i < end; ++i) {
      const letter = this.hex.checked ? null : letterOf(this.values[i]);
      const kind = this.kinds[i];
      if (!this.hex.checked && this.values[i] === 13 && kind !== lostByte) continue;  // LF begins the line
      const name = `end${this.line.ends.indexOf(this.from[i])}${kind === lostByte ? ' lost' : kind === typedByte ? ' typed' : ''}`;
      const value = `${this.hex.checked ? '' : '\\x'}${this.values[i].toString(16).padStart(2, '0')}${this.hex.checked ? ' ' : ''}`;
      const shown = kind === lineBreak ? '[break]' : letter === null ? value : letter;
      const last = parts.at(-1);
      if (last && last.name === name) last.text += shown;
      else {
        // Another end speaks: on a line of its own.
        const turns = last && last.end !== this.from[i] && !last.text.endsWith('\n');
        parts.push({ name, end: this.from[i], text: (turns ? '\n' : '') + shown, t: this.t[i] });
      }
    }
    const atEnd = this.text.scrollTop + this.text.clientHeight >= this.text.scrollHeight - 4;
    this.text.replaceChildren(...parts.map((part) => Object.assign(document.createElement('span'), {
      className: part.name, textContent: part.text, title: `${part.end} from ${part.t.toFixed(6)} s on` })));
    if (atEnd) this.text.scrollTop = this.text.scrollHeight;
  }
}
