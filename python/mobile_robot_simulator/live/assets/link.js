// Link: the connection to the simulation. It keeps the newest of each part of the frames, and passes inputs on.

const decoded = (text) => Uint8Array.from(atob(text), (char) => char.charCodeAt(0));

export class Link {
  /** @param viewer Identifier of this page. @param heard Called after each message, with the names of the parts in it. */
  constructor(viewer, heard) {
    Object.assign(this, { viewer, heard, parts: {}, trails: {}, scanCount: 0, open: false, number: 0, asked: new Map(), notes: [] });
    this.connect();
  }

  connect() {
    const scheme = location.protocol === "https:" ? "wss" : "ws";
    this.socket = new WebSocket(`${scheme}://${location.host}/live/socket?viewer=${this.viewer}`);
    this.socket.onopen = () => { this.open = true; };
    this.socket.onmessage = (event) => this.take(JSON.parse(event.data));
    this.socket.onclose = (event) => {
      this.open = false;
      for (const { refuse } of this.asked.values()) refuse(new Error("the connection is lost"));
      this.asked.clear();
      this.heard(new Set(["lost"]));
      // The server was started anew and does not know this page.
      if (event.code === 4403) setTimeout(() => location.reload(), 500);
      else if (!this.closed) setTimeout(() => this.connect(), 1000);
    };
  }

  close() { this.closed = true; this.socket.close(); }

  send(data) { if (this.socket.readyState === 1) this.socket.send(JSON.stringify(data)); }

  /** Sends an input. Resolves to its result; rejects with the reason of a refusal. */
  ask(data) {
    if (this.socket.readyState !== 1) return Promise.reject(new Error("the connection is lost"));
    const number = ++this.number;
    this.send({ ...data, id: number });
    return new Promise((accept, refuse) => this.asked.set(number, { accept, refuse }));
  }

  take(message) {
    for (const [name, part] of Object.entries(message)) {
      if (name === "answers") part.forEach((answer) => this.answer(answer));
      else if (name === "notes") this.notes.push(...part);
      else if (name.startsWith("trail:")) (this.trails[name.slice(6)] ||= []).splice(part.first, Infinity, ...part.points);
      else if (part === null) delete this.parts[name];
      else {
        if (name.startsWith("scan:")) {
          part.xy = new Float32Array(decoded(part.points).buffer);
          part.hit = decoded(part.hits);
          this.scanCount++;
        }
        this.parts[name] = part;
      }
    }
    this.heard(new Set(Object.keys(message)));
  }

  answer({ id, error, value }) {
    const asked = this.asked.get(id);
    this.asked.delete(id);
    if (asked) error === undefined ? asked.accept(value) : asked.refuse(new Error(error));
  }

  /** Cells of the map as int8, row 0 first. */
  async cells() {
    const answer = await fetch(`/live/map?viewer=${this.viewer}`);
    return new Int8Array(await answer.arrayBuffer());
  }
}
