// A board's chip, as it is where the run stands: where its program is, registers, variables. Of a run that goes on.

const hex = (value, digits) => `0x${BigInt(value).toString(16).padStart(digits, '0')}`;

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
    this.image = Object.assign(document.createElement('input'), { id: 'flash-file', placeholder: 'path of an image: build/robot.elf', size: 26 });
    this.image.addEventListener('keydown', (event) => {
      if (event.key === 'Enter') this.flash();
      event.stopPropagation();
    });
    this.burn = Object.assign(document.createElement('button'), { id: 'flash', textContent: 'flash',
      title: 'write this image into the board; its chip is reset, RAM stays' });
    this.burn.addEventListener('click', () => this.flash());
    this.stack = Object.assign(document.createElement('pre'), { id: 'stack' });
    this.interrupts = Object.assign(document.createElement('table'), { id: 'interrupts' });
    this.counting = Object.assign(document.createElement('input'), { id: 'count-interrupts', type: 'checkbox' });
    this.counting.addEventListener('change', () => this.ask({ do: 'interrupts', board: this.board, count: this.counting.checked }));
    this.counter = document.createElement('label');
    this.counter.title = 'counts what the program takes from now on; the run is slower meanwhile';
    this.counter.append(this.counting, ' interrupts');
    this.stepper = Object.assign(document.createElement('button'), { id: 'step-instruction', textContent: 'one instruction',
      title: 'on by one instruction of this board (I)' });
    this.stepper.addEventListener('click', () => this.ask({ do: 'instruction', board: this.board }));
    this.flasher = document.createElement('div');
    this.flasher.append(this.image, this.burn);
    this.flasher.hidden = this.input.hidden = this.counter.hidden = this.stepper.hidden = true;
    element.append(this.chooser, this.stepper, this.where, this.input, this.values, this.code, this.stack, this.counter, this.interrupts, this.flasher);
    element.hidden = boards.length === 0;
  }
  get board() { return this.chooser.value; }
  add(text) {
    if (text === '') return;
    if (!this.items.includes(text)) this.items.push(text);
    this.input.value = '';
    this.look();
  }
  flash() {
    const file = this.image.value.trim();
    if (file) this.ask({ do: 'flash', board: this.board, file });
  }
  look() {
    this.before = new Map();
    this.drawn = '';
    this.input.hidden = this.flasher.hidden = this.counter.hidden = this.stepper.hidden = this.board === '';
    for (const part of [this.where, this.values, this.code, this.stack, this.interrupts]) part.replaceChildren();
    return this.ask({ do: 'look', board: this.board, items: this.items });
  }
  draw(look) {
    if (!look || look.board !== this.board || look.values.length !== this.items.length) return;
    const key = `${look.time_s} ${this.items.length} ${look.where.interrupts !== undefined}`;
    if (key === this.drawn) return;
    this.drawn = key;
    const { where } = look;
    if (!where.ok) {
      this.where.textContent = where.error;
      return;
    }
    const place = [where.place, where.line].filter(Boolean).join('  ');
    this.where.textContent = `${look.time_s.toFixed(9)} s  PC ${hex(where.pc, 4)}  ${place}${where.asleep ? '  waits' : ''}`;
    const rows = this.items.map((item, i) => [item, look.values[i].ok ? look.values[i].text : look.values[i].error, item, !look.values[i].ok]);
    for (const one of where.registers) rows.push([one.name, hex(one.value, one.bits / 4), null, false]);
    this.values.replaceChildren(...rows.map(([name, text, item, failed]) => {
      const line = document.createElement('tr');
      for (const cell of [name, text]) line.append(Object.assign(document.createElement('td'), { textContent: cell }));
      if (failed) line.className = 'failed';
      else if (this.before.has(name) && this.before.get(name) !== text) line.className = 'changed';
      this.before.set(name, text);
      if (item) {
        line.title = 'click to take it away';
        line.addEventListener('click', () => { this.items = this.items.filter((one) => one !== item); this.look(); });
      }
      return line;
    }));
    this.counting.checked = where.interrupts !== undefined;
    this.interrupts.replaceChildren(...(where.interrupts || []).map((one) => {
      const line = document.createElement('tr');
      for (const cell of [one.name, one.count, `${one.per_s.toPrecision(4)} /s`])
        line.append(Object.assign(document.createElement('td'), { textContent: cell }));
      return line;
    }));
    this.stack.replaceChildren(...where.stack.map((one) => Object.assign(document.createElement('div'), {
      textContent: `${hex(one.address, 4)}  ${hex(one.value, 4)}${one.place ? `  ${one.place}` : ''}` })));
    this.code.replaceChildren(...where.instructions.map((one) => Object.assign(document.createElement('div'), {
      className: one.pc === where.pc ? 'here' : '', textContent: `${hex(one.pc, 4)}  ${one.text}${one.place ? `   ${one.place}:` : ''}` })));
  }
}
