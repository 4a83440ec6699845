// Reads the numbers of an answer one array after another; all little-endian. Arrays are copied: they need not begin
// where their elements' size would have them.

export class Bytes {
  constructor(buffer) {
    this.buffer = buffer;
    this.at = 0;
  }
  array(Type, count) {
    const size = count * Type.BYTES_PER_ELEMENT;
    if (!(count >= 0) || this.at + size > this.buffer.byteLength) throw new Error('an answer ends too early');
    const values = new Type(this.buffer.slice(this.at, this.at + size));
    this.at += size;
    return values;
  }
  number() {
    return this.array(Uint32Array, 1)[0];
  }
}
