// What the network manager prints of itself: settings, who reaches whom, last messages; in a run that goes on its
// settings can be changed.

const lookSeconds = 0.5;
const settings = [['range', 'm', 'range_m', 'none'], ['hops', '', 'hops', ''], ['delay', 's', 'delay_s', ''], ['loss', '', 'loss', '']];

/** The rows of a table from lists of cells; the first row is the head. */
function table(rows) {
  const made = document.createElement('table');
  rows.forEach((cells, i) => {
    const row = made.insertRow();
    cells.forEach((cell, j) => {
      const one = document.createElement(i === 0 || j === 0 ? 'th' : 'td');
      one.textContent = typeof cell === 'object' ? cell.text : cell;
      if (typeof cell === 'object') Object.assign(one, { title: cell.title, className: cell.className || '' });
      row.append(one);
    });
  });
  return made;
}

/** Hops from row to column, with the rate. */
export function linkRows(status) {
  const numbers = status.robots.map((robot) => robot[0]);
  const known = new Map(status.links.map((link) => [`${link[0]} ${link[1]}`, link]));
  return [['', ...numbers], ...numbers.map((from) => [from, ...numbers.map((to) => {
    const link = known.get(`${from} ${to}`);
    if (!link) return '';
    const [, , hops, passed, failed, rate, loss] = link;
    return { text: hops === 0 ? '-' : `${hops}`, className: loss > 0 || failed > 0 ? 'failed' : '',
      title: `${from} to ${to}: ${hops === 0 ? 'out of reach' : `${hops} hop${hops === 1 ? '' : 's'}`}, ${passed} passed, ${failed} not, ${rate.toFixed(2)} a second, loss ${loss}` };
  })])];
}

export class NetworkPart {
  /** `drive(request)` has the run do something; null: nothing can be done to it. */
  constructor(element, source, drive) {
    Object.assign(this, { element, source, drive, list: [], at: NaN, pending: null, fields: new Map() });
  }
  /** What was printed until `now`. */
  draw(now) {
    if (!this.source.network || this.pending || Math.abs(now - this.at) < lookSeconds) return;
    this.at = now;
    this.pending = this.load(now).catch(() => {}).finally(() => { this.pending = null; });
  }
  async load(now) {
    this.list = await this.source.network(now);
    this.element.hidden = this.list.length === 0;
    if (this.element.contains(document.activeElement)) return;  // somebody types
    this.element.replaceChildren(...this.list.flatMap((one) => this.show(one)));
  }
  show({ computer, status }) {
    const name = Object.assign(document.createElement('div'), { className: 'name', textContent: `${computer}: ${status.robots.length} robots` });
    const form = Object.assign(document.createElement('form'), { className: 'settings' });
    for (const [word, unit, key, nothing] of settings) {
      const value = status[key] === null ? nothing : status[key];
      const input = Object.assign(document.createElement('input'), { value, size: 5, disabled: !this.drive, name: word });
      input.addEventListener('change', () => this.drive({ do: 'act', command: `send ${computer} text "${word} ${input.value.trim()}"` }));
      const label = document.createElement('label');
      label.append(`${word} `, input, ` ${unit}`);
      form.append(label);
    }
    form.addEventListener('submit', (event) => { event.preventDefault(); document.activeElement.blur(); });
    const last = status.last.slice().reverse().map(([time, from, to, hops, octets, fate, data]) =>
      Object.assign(document.createElement('li'), { textContent: `${time.toFixed(3)} ${from} to ${to}: ${fate === 'passed' ? data : `${fate} ${data}`}`,
        className: fate === 'passed' ? '' : 'failed', title: `${octets} octets, ${hops} hops` }));
    const messages = document.createElement('ul');
    messages.append(...last);
    return [name, form, table(linkRows(status)), messages];
  }
}
