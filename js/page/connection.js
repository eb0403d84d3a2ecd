// The connection of the page to the program that serves it. `eurdf/viewing/messages.py` states the messages: each is a
// JSON object whose `type` is the name of its class in lower case.

const AGAIN = 1500; // time after which a connection that ended is tried again, ms

/** Says what the server says by events of its type, whose `detail` is the message; "open" and "end" are the connection's. */
export class Connection extends EventTarget {
  constructor(url) {
    super();
    this.url = url;
    this.connect();
  }

  connect() {
    this.socket = new WebSocket(this.url);
    this.socket.addEventListener("open", () => this.dispatchEvent(new Event("open")));
    this.socket.addEventListener("message", ({ data }) => {
      const message = JSON.parse(data);
      this.dispatchEvent(new CustomEvent(message.type, { detail: message }));
    });
    this.socket.addEventListener("close", () => {
      this.dispatchEvent(new Event("end"));
      setTimeout(() => this.connect(), AGAIN);
    });
  }

  /** Call a function with each message of a type. */
  on(type, done) {
    this.addEventListener(type, ({ detail }) => done(detail));
  }

  send(type, fields = {}) {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify({ type, ...fields }));
  }
}
