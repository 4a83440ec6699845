// A board's chip, as it is where the run stands: where its program is, registers, variables. Of a run that goes on.

const hex = (value, digits) => `0x${BigInt(value).toString(16).padStart(digits, '0')}`;

/** What a user typed, as a request to read: "TMR1", "U2STA.TRMT", "counter", "0x850:4". Null: nothing. */
export function itemOf(text) {
  const memory = /^(0x[0-9a-f]+|\d+)(?::(\d+))?$/i.exec(text);
  if (memory) return { text, request: { memory: Number(memory[1]), bytes: Number(memory[2] || 2) } };
  const name = /^([A-Za-z_]\w*)(?:\.([A-Za-z_]\w*))?$/.exec(text);
  if (!name) return null;
  const [, whole, field] = name;
  // Data-sheet names are upper case, but for the core's W registers, which the compiler writes in lower case.
  const register = field || /^[A-Z][A-Z0-9_]*$/.test(whole) || /^w\d+$/.test(whole);
  return { text, field, request: register ? { register: whole } : { variable: whole } };
}

/** What a user typed as the end of a step: "TMR1 >= 9", `text "ok"`, "frame link=robot0.uart value=4e". Null: nothing. */
export function conditionOf(text, board) {
  const said = /^text\s+"(.*)"$/.exec(text);
  if (said) return { text: JSON.parse(`"${said[1]}"`) };
  if (/^frame(\s|$)/.test(text)) {
    const frame = {};
    for (const word of text.split(/\s+/).slice(1)) {
      const at = word.indexOf('=');
      if (at <= 0) return null;
      frame[word.slice(0, at)] = word.slice(at + 1);
    }
    return { frame };
  }
  const compared = /^(?:(\S+)\s+)?(\S+?)\s*(==|!=|<=|>=|<|>)\s*(0x[0-9a-f]+|\d+)$/i.exec(text);
  const item = compared ? itemOf(compared[2]) : null;
  return item && !item.field ? { node: compared[1] || board, ...item.request, is: compared[3], value: Number(compared[4]) } : null;
}

function shown(reply, item) {
  if (!reply.ok) return reply.error;
  if (item.field) return item.field in reply.fields ? String(reply.fields[item.field]) : `no field ${item.field}`;
  const digits = reply.bits ? reply.bits / 4 : 2 * (reply.bytes || 1);
  if (reply.value === undefined) return reply.data;
  const fields = Object.entries(reply.fields || {}).filter(([, value]) => value !== 0).map(([name, value]) => (value === 1 ? name : `${name}=${value}`));
  return `${hex(reply.value, digits)} ${reply.value}${fields.length ? `  ${fields.join(' ')}` : ''}`;
}

export class BoardPart {
  /** `ask(request)` has the run do something. */
  constructor(element, boards, ask) {
    Object.assign(this, { element, ask, items: [], before: new Map(), drawn: '' });
    this.chooser = Object.assign(document.createElement('select'), { id: 'board' });
    this.chooser.append(new Option('no board', ''), ...boards.map((name) => new Option(name, name)));
    this.chooser.addEventListener('change', () => this.look());
    this.input = Object.assign(document.createElement('input'), { id: 'watch', placeholder: 'TMR1, U2STA.TRMT, a variable, 0x850:4', size: 26 });
    this.input.addEventListener('keydown', (event) => {
      if (event.key === 'Enter') this.add(this.input.value.trim());
      event.stopPropagation();
    });
    this.where = Object.assign(document.createElement('div'), { id: 'where' });
    this.values = Object.assign(document.createElement('table'), { id: 'watches' });
    this.code = Object.assign(document.createElement('pre'), { id: 'code' });
    this.input.hidden = true;
    element.append(this.chooser, this.where, this.input, this.values, this.code);
    element.hidden = boards.length === 0;
  }
  get board() { return this.chooser.value; }
  add(text) {
    const item = itemOf(text);
    this.input.classList.toggle('failed', !item && text !== '');
    if (!item) return;
    if (!this.items.some((one) => one.text === text)) this.items.push(item);
    this.input.value = '';
    this.look();
  }
  look() {
    this.before = new Map();
    this.drawn = '';
    this.input.hidden = this.board === '';
    for (const part of [this.where, this.values, this.code]) part.replaceChildren();
    return this.ask({ do: 'look', board: this.board, items: this.items.map((item) => item.request) });
  }
  draw(look) {
    if (!look || look.board !== this.board || look.values.length !== this.items.length) return;
    const key = `${look.time_s} ${this.items.length}`;
    if (key === this.drawn) return;
    this.drawn = key;
    const { where } = look;
    if (!where.ok) {
      this.where.textContent = where.error;
      return;
    }
    const place = [where.place, where.line].filter(Boolean).join('  ');
    this.where.textContent = `${look.time_s.toFixed(6)} s  PC ${hex(where.pc, 4)}  ${place}${where.asleep ? '  waits' : ''}`;
    const rows = this.items.map((item, i) => [item.text, shown(look.values[i], item), item]);
    for (const one of where.registers) rows.push([one.name, hex(one.value, one.bits / 4), null]);
    this.values.replaceChildren(...rows.map(([name, text, item]) => {
      const line = document.createElement('tr');
      for (const cell of [name, text]) line.append(Object.assign(document.createElement('td'), { textContent: cell }));
      if (this.before.has(name) && this.before.get(name) !== text) line.className = 'changed';
      this.before.set(name, text);
      if (item) {
        line.title = 'click to take it away';
        line.addEventListener('click', () => { this.items = this.items.filter((one) => one !== item); this.look(); });
      }
      return line;
    }));
    this.code.replaceChildren(...where.instructions.map((one) => Object.assign(document.createElement('div'), {
      className: one.pc === where.pc ? 'here' : '', textContent: `${hex(one.pc, 4)}  ${one.text}${one.place ? `   ${one.place}:` : ''}` })));
  }
}
