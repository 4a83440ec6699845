// Where the data come from: the server that sent this page, or the page itself if it was exported.

class ServerSource {
  async get(name) {
    const answer = await fetch(name, { cache: 'no-store' });
    if (!answer.ok) throw new Error(`${name}: ${answer.status} ${await answer.text()}`);
    return answer;
  }
  async json(name) { return (await this.get(name)).json(); }
  async bytes(name) { return (await this.get(name)).arrayBuffer(); }
  head() { return this.json('head'); }
  poses() { return this.bytes('poses'); }
  status() { return this.json('status'); }
  beams() { return this.bytes('beams'); }
  trails() { return this.bytes('trails'); }
  tracked(from) { return this.bytes(`tracked?from=${from}`); }
  events(from) { return this.bytes(`events?from=${from}`); }
  leds(from) { return this.bytes(`leds?from=${from}`); }
  sensors(robot) { return this.bytes(`sensors?robot=${robot}`); }
  cameras() { return this.json('cameras'); }
  picture(camera, frame) { return this.bytes(`picture?of=${camera},${frame}`); }
  serial(from, link) { return this.json(`serial?from=${from},${encodeURIComponent(link)}`); }
  network(time) { return this.json(`network?at=${Math.round(time * 1000)}`); }
  texts(numbers) { return this.json(`texts?numbers=${numbers.join(',')}`); }
  async find(text) { return new Uint32Array(await this.bytes(`find?text=${encodeURIComponent(text)}`)); }
}

class FileSource {
  async bytes(name) {
    const text = document.getElementById(`data-${name}`).textContent;
    const packed = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'));
    return new Response(stream).arrayBuffer();
  }
  async json(name) { return JSON.parse(new TextDecoder().decode(await this.bytes(name))); }
  head() { return this.json('head'); }
  poses() { return this.bytes('poses'); }
  status() { return this.json('status'); }
  beams() { return this.bytes('beams'); }
  trails() { return this.bytes('trails'); }
  async tracked(from) { return (await this.bytes('tracked')).slice(from); }
  events() { return this.bytes('events'); }
  leds() { return this.bytes('leds'); }
  sensors(robot) { return this.bytes(`sensors-${robot}`); }
  cameras() { return this.json('cameras'); }
  picture(camera, frame) { return this.bytes(`picture-${camera}-${frame}`); }
  async all() {
    if (this.list) return this.list;
    const buffer = await this.bytes('texts');
    const view = new DataView(buffer), decoder = new TextDecoder();
    const list = [];
    for (let at = 0; at < buffer.byteLength;) {
      const size = view.getUint32(at, true);
      list.push(decoder.decode(new Uint8Array(buffer, at + 4, size)));
      at += 4 + size;
    }
    this.list = list;
    return list;
  }
  async texts(numbers) {
    const list = await this.all();
    return numbers.map((number) => list[number] || '');
  }
  async find(text) {
    const wanted = text.toLowerCase();
    const numbers = [];
    (await this.all()).forEach((one, i) => { if (one.toLowerCase().includes(wanted)) numbers.push(i); });
    return Uint32Array.from(numbers);
  }
}

export function makeSource() {
  return document.getElementById('data-head') ? new FileSource() : new ServerSource();
}
