// The form for what is done to the world: which action, to what, and the keys that the action has.

const hints = { to: 'x, y: 10 cm, 0 cm', by: 'dx, dy: 10 cm, 0 cm', from: 'x, y: 0 cm, 0 cm', centre: 'x, y: 10 cm, 0 cm', position: '0 to 15',
  size: '10 cm, 10 cm (, 10 cm)', heading: '90 deg', over: '2 s', hold: '500 ms', key: '0 to 63', address: '0 to 31', radius: '5 cm',
  height: '10 cm', thickness: '1 cm', mass: '200 g', grey: '0 to 1', reflectivity: '0 to 10', charge: '0 to 1', ground: '0 to 1', ambient: '0 to 100',
  intensity: '0 to 100', level: '500', parameter: 'proximity.gain3', value: 'with its unit', port: '1 to 65535', robots: 'robot0, robot1' };

export class WorldForm {
  /** `possible`: the run's answer to "actions". `objects()`: names of what is there now. `ask(request)` has the run do
      something. */
  constructor(dialog, possible, objects, ask) {
    Object.assign(this, { dialog, possible, objects });
    const labelled = (text, input) => {
      const line = document.createElement('label');
      line.append(text, input);
      return line;
    };
    const made = (name, values) => Object.assign(document.createElement(name), values);
    this.verb = made('select', { id: 'world-verb' });
    this.verb.append(...(possible.actions || []).map((one) => new Option(one.verb, one.verb)));
    this.object = made('input', { id: 'world-object' });
    this.names = made('datalist', { id: 'world-objects' });
    this.object.setAttribute('list', this.names.id);
    this.help = made('p', { id: 'world-help' });
    this.fields = made('div', { id: 'world-fields' });
    this.text = made('input', { id: 'world-text', size: 60 });
    const parameters = made('datalist', { id: 'world-parameters' });
    parameters.append(...(possible.parameters || []).map((one) => new Option(
      `${one.range[0]} to ${one.range[1]} ${one.unit}, otherwise ${one.fallback}`, one.name)));
    const button = (id, text, act) => {
      const one = made('button', { id, textContent: text });
      one.addEventListener('click', act);
      return one;
    };
    dialog.append(made('h2', { textContent: 'What happens to the world' }), labelled('action ', this.verb),
      labelled(' to ', this.object), this.help, this.fields, this.text, this.names, parameters,
      button('world-do', 'do it', () => { dialog.close(); ask({ do: 'act', command: this.text.value }); }),
      button('world-close', 'close', () => dialog.close()));
    this.verb.addEventListener('change', () => this.keys());
    this.object.addEventListener('input', () => (this.verb.value === 'add' ? this.keys() : this.write()));
  }
  open(robot) {
    this.object.value = robot || '';
    this.keys();
    this.dialog.showModal();
  }
  keys() {
    const action = this.possible.actions.find((one) => one.verb === this.verb.value);
    const adds = action.verb === 'add', kinds = this.possible.things.map((one) => one.kind);
    if (adds && !kinds.includes(this.object.value)) this.object.value = kinds[0];
    if (!adds && kinds.includes(this.object.value)) this.object.value = this.objects()[0] || '';
    this.names.replaceChildren(...(adds ? kinds : this.objects()).map((name) => new Option(name, name)));
    this.help.textContent = `${action.usage}: ${action.help}`;
    const keys = adds ? this.possible.things.find((one) => one.kind === this.object.value).keys : action.keys;
    this.fields.replaceChildren(...keys.map((key) => {
      const line = document.createElement('label'), input = document.createElement('input');
      input.dataset.key = key;
      input.placeholder = hints[key] || '';
      if (key === 'parameter') input.setAttribute('list', 'world-parameters');
      input.addEventListener('input', () => this.write());
      line.append(`${key} `, input);
      return line;
    }));
    this.write();
  }
  write() {
    const words = [this.verb.value, this.object.value.trim()];
    for (const input of this.fields.querySelectorAll('[data-key]'))
      if (input.value.trim()) words.push(input.dataset.key, input.value.trim());
    this.text.value = words.join(' ');
  }
}
