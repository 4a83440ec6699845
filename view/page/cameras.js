// What the cameras of the chosen robot saw: the latest picture before the time that is shown.
import { countUpTo } from './model.js';

/** A binary PPM of 8 bits as what a canvas takes; null: none. */
export function ppmOf(buffer) {
  const bytes = new Uint8Array(buffer);
  const head = /^P6\s+(\d+)\s+(\d+)\s+255\s/.exec(new TextDecoder('latin1').decode(bytes.subarray(0, 64)));
  if (!head) return null;
  const width = Number(head[1]), height = Number(head[2]), begin = head[0].length;
  if (width * height === 0 || bytes.length < begin + 3 * width * height) return null;
  const image = new ImageData(width, height);
  for (let i = 0, from = begin; i < 4 * width * height; i += 4, from += 3) {
    image.data[i] = bytes[from];
    image.data[i + 1] = bytes[from + 1];
    image.data[i + 2] = bytes[from + 2];
    image.data[i + 3] = 255;
  }
  return image;
}

export class Cameras {
  constructor(element, run, source) {
    Object.assign(this, { element, run, source, list: [], views: [], robot: '', pending: null });
  }
  /** Pictures may have come since. */
  async load() {
    if (!this.source.cameras) return;
    this.list = await this.source.cameras();
    this.show(this.robot);
    this.run.redraw();
  }
  show(robot) {
    const mine = this.list.filter((camera) => camera.robot === robot);
    const same = robot === this.robot && mine.length === this.views.length;
    this.robot = robot;
    if (same) {
      this.views.forEach((view, i) => { view.camera = mine[i]; });
      return;
    }
    this.views = mine.map((camera) => {
      const label = Object.assign(document.createElement('div'), { className: 'name' });
      const canvas = Object.assign(document.createElement('canvas'), { className: 'camera', width: 1, height: 1 });
      return { camera, label, canvas, shown: -1, wanted: -1 };
    });
    this.element.replaceChildren(...this.views.flatMap((view) => [view.label, view.canvas]));
    this.element.hidden = mine.length === 0;
  }
  draw(now) {
    for (const view of this.views) {
      const i = countUpTo(view.camera.t, now) - 1;
      view.canvas.hidden = i < 0;
      view.label.textContent = `${view.camera.kind} camera, ${i < 0 ? 'no picture yet' : `${view.camera.t[i].toFixed(3)} s`}`;
      if (i >= 0 && view.camera.frame[i] !== view.wanted) this.pending = this.fetch(view, view.camera.frame[i]).catch(() => {});
    }
  }
  async fetch(view, frame) {
    view.wanted = frame;
    const image = ppmOf(await this.source.picture(view.camera.camera, frame));
    if (view.wanted !== frame || !image) return;
    view.canvas.width = image.width;
    view.canvas.height = image.height;
    view.canvas.getContext('2d').putImageData(image, 0, 0);
    view.shown = frame;
    view.canvas.dataset.frame = frame;
  }
}
