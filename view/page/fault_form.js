// The form for a fault: what it sits on, which kind, when, and the parameters that the kind has.

const timing = { each: ['begin', 'for', 'at', 'count', 'probability'], hold: ['begin', 'for'], times: ['at', 'begin', 'period'] };
const units = { time: 'such as 5 ms', ratio: 'such as 10 %', voltage: 'such as 1.5 V', frequency: 'such as 100 kHz', degrees: 'such as 30 deg',
  integer: 'a whole number', number: 'a number', flag: 'true or false', byte: 'such as 0x4e', text: '' };

function hint(parameter) {
  const parts = [units[parameter.unit] || ''];
  if (parameter.range) parts.push(`${parameter.range[0]} to ${parameter.range[1]}${parameter.unit === 'time' ? ' s' : ''}`);
  if (parameter.fallback !== undefined) parts.push(`otherwise ${parameter.fallback}`);
  return parts.filter(Boolean).join(', ');
}

export class FaultForm {
  /** `possible`: the run's answer to "faults". `ask(request)` has the run do something. */
  constructor(dialog, possible, ask) {
    Object.assign(this, { dialog, possible, ask });
    const make = (label, id) => {
      const line = document.createElement('label'), chooser = Object.assign(document.createElement('select'), { id });
      line.append(label, chooser);
      return [line, chooser];
    };
    let place, kind;
    [place, this.place] = make('on ', 'fault-place');
    [kind, this.kind] = make('kind ', 'fault-kind');
    this.fields = document.createElement('div');
    this.fields.id = 'fault-fields';
    this.text = Object.assign(document.createElement('input'), { id: 'fault-text', size: 60 });
    const button = (id, text, act) => {
      const made = Object.assign(document.createElement('button'), { id, textContent: text });
      made.addEventListener('click', act);
      return made;
    };
    dialog.append(Object.assign(document.createElement('h2'), { textContent: 'A fault from now on' }), place, kind, this.fields, this.text,
      button('fault-do', 'inject', () => { this.dialog.close(); this.ask({ do: 'fault', fault: this.text.value }); }),
      button('fault-close', 'close', () => this.dialog.close()));
    (possible.places || []).forEach((one, i) => this.place.append(new Option(one.name, i)));
    this.place.addEventListener('change', () => this.kinds());
    this.kind.addEventListener('change', () => this.parameters());
    this.kinds();
  }
  open(time) {
    this.time = time;
    this.parameters();
    this.dialog.showModal();
  }
  kinds() {
    const place = this.possible.places?.[Number(this.place.value)];
    this.kind.replaceChildren(...(this.possible.kinds || []).filter((one) => place && one.on === place.on).map((one) => new Option(one.name, one.name)));
    this.parameters();
  }
  parameters() {
    const place = this.possible.places?.[Number(this.place.value)];
    const kind = place && this.possible.kinds.find((one) => one.on === place.on && one.name === this.kind.value);
    if (!kind) return;
    const rows = [];
    const row = (key, title, choices, value = '') => {
      const line = document.createElement('label');
      const input = choices ? document.createElement('select') : Object.assign(document.createElement('input'), { value, placeholder: title });
      if (choices) input.append(new Option('', ''), ...choices.map((one) => new Option(one, one)));
      input.dataset.key = key;
      input.addEventListener('input', () => this.write(place, kind));
      line.append(`${key} `, input);
      rows.push(line);
    };
    if (place.ends.length) row('from', 'the end whose messages suffer', place.ends);
    // Not in the very instant: what has begun on a line cannot be changed any more.
    const now = `${((this.time || 0) + 0.001).toFixed(3)} s`;
    for (const key of timing[kind.style]) row(key, key === 'count' ? 'at most so often' : key === 'probability' ? '0 to 1' : 'such as 2 s', null, key === timing[kind.style][0] ? now : '');
    for (const one of kind.parameters) row(one.key, hint(one), one.choices ? one.choices.split('|') : one.unit === 'flag' ? ['true', 'false'] : null);
    this.fields.replaceChildren(...rows);
    this.write(place, kind);
  }
  write(place, kind) {
    const words = [kind.name, `${place.key}=${place.name}`];
    for (const input of this.fields.querySelectorAll('[data-key]')) {
      const value = input.value.trim();
      if (value) words.push(`${input.dataset.key}=${/\s/.test(value) ? `"${value}"` : value}`);
    }
    this.text.value = words.join(' ');
  }
}
