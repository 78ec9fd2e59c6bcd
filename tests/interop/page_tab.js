// A browser's tab at the page of `metier dashboard`.
'use strict';

const { until } = require('./metier_process');

const kShowsTimeoutMs = 60000;

/** Waits until the page is connected to its server; the server as the page knows it. */
const awaitCell = (url) =>
  until('the page is connected',
    async () => (await (await fetch(`${url}/api/cell`)).json()).servers[0], ({ connected }) => connected);

/** A browser's tab: the stream of what the page shows, and commands in its name. */
class Tab {
  constructor(url) {
    this.url = url;
    this.ending = new AbortController();
  }

  async open() {
    const stream = await fetch(`${this.url}/api/stream`, { signal: this.ending.signal });
    this.events = this.read(stream.body.getReader());
    const { value } = await this.events.next();
    this.id = value.data.tab;
    return this;
  }

  async* read(reader) {
    const decoder = new TextDecoder();
    let text = '';
    for (;;) {
      const { value, done } = await reader.read();
      if (done) {
        throw new Error('the stream of the page has ended');
      }
      text += decoder.decode(value, { stream: true });
      for (let end = text.indexOf('\n\n'); end >= 0; end = text.indexOf('\n\n')) {
        const [name, data] = text.slice(0, end).split('\n');
        text = text.slice(end + 2);
        yield { name: name.slice('event: '.length), data: JSON.parse(data.slice('data: '.length)) };
      }
    }
  }

  async command(what, body) {
    const answer = await fetch(`${this.url}/api/${what}`, {
      method: 'POST',
      headers: { 'Content-Type': 'application/json', 'X-Metier': '1' },
      body: JSON.stringify({ tab: this.id, ...body }) });
    return { status: answer.status, ...await answer.json() };
  }

  /** Waits until a skill is shown in a state, for 60 s. */
  async shows(key, state) {
    const late = setTimeout(() => this.ending.abort(new Error(`${key} is not shown ${state}`)), kShowsTimeoutMs);
    let event;
    do {
      event = (await this.events.next()).value;
    } while (event.name !== 'skill' || event.data.key !== key || event.data.state !== state);
    clearTimeout(late);
  }

  close() {
    this.ending.abort();
  }
}

module.exports = { Tab, awaitCell };
