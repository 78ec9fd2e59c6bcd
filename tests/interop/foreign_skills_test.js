// Commands of metier on Programs of another maker, which have only what OPC 10000-10 makes mandatory,
// and less.
'use strict';

const assert = require('node:assert');
const fs = require('node:fs');
const os = require('node:os');
const path = require('node:path');
const { after, before, test } = require('node:test');
const { runMetier, startMetier, startProcess, startServer } = require('./metier_process');

const kProgram = path.join(__dirname, 'foreign_skills.js');
const kLostConnection = 3;
const kSkills = [
  'Whole', 'WithoutNumbers', 'PlainEvents', 'WithoutEvents', 'NamesOnly', 'OwnMethods',
  'StartAndHalt', 'StartOnly',
];

let server;

before(async () => {
  server = await startProcess(process.execPath, [kProgram]);
});

after(() => server?.stop());

const run = (skill, ...more) => runMetier(['run', server.url, skill, ...more]);

test('list shows every Program with its state', async () => {
  const { status, output } = await runMetier(['list', server.url]);
  assert.strictEqual(status, 0);
  for (const name of kSkills) {
    assert.match(output, new RegExp(`${name} +Ready +no atomic start, no dead-man`));
  }
});

for (const skill of kSkills) {
  test(`run writes, starts, and returns the result of ${skill}`, async () => {
    for (const count of [1, 2]) {
      const { status, output } = await run(skill, '--set', 'Duration=0.3');
      assert.strictEqual(status, 0, output);
      assert.match(output, new RegExp(`Count +${count}`));
    }
  });

  test(`run notices an end of ${skill} that comes at once`, async () => {
    const { status, output } = await run(skill, '--set', 'Duration=0');
    assert.strictEqual(status, 0, output);
    assert.match(output, /Count +3/);
  });
}

test('values of types that skills of metier do not have are sent and read', async () => {
  const { status, output, errors } = await run('Whole', '--set', 'Duration=0', '--set', 'Level=0.25');
  assert.strictEqual(status, 0, errors);
  assert.match(output, /Note +"level 0.25"/);
  const beyond = await run('Whole', '--set', 'Level=1e39');
  assert.notStrictEqual(beyond.status, 0);
  assert.match(beyond.errors, /Level: 1e\+39 is outside/);
});

for (const skill of ['Whole', 'WithoutEvents', 'NamesOnly', 'OwnMethods']) {
  test(`${skill} is suspended and goes on, as watch shows`, async () => {
    const watching = await startMetier(['watch', server.url, skill, '--count', '4'], /watching/);
    const running = run(skill, '--set', 'Duration=4');
    await awaitState(server.url, skill, 'Running');
    assert.strictEqual((await runMetier(['suspend', server.url, skill])).status, 0);
    await awaitState(server.url, skill, 'Suspended');
    assert.strictEqual((await runMetier(['resume', server.url, skill])).status, 0);
    const { status, errors } = await running;
    assert.strictEqual(status, 0, errors);
    const { output } = await watching.end;
    for (const step of [/Running -> Suspended/, /Suspended -> Running/, /Running -> Ready/]) {
      assert.match(output, step);
    }
  });
}

test('run records what the server does not: parameters, Suspend, result, refusal and Halt', async () => {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'foreign_run_'));
  try {
    const records = path.join(folder, 'records.db');
    const recorded = (...more) => run('Whole', '--records', records, ...more);
    const going = recorded('--set', 'Duration=3');
    await awaitState(server.url, 'Whole', 'Running');
    const refused = await recorded('--set', 'Duration=0');
    assert.notStrictEqual(refused.status, 0);
    assert.strictEqual((await runMetier(['suspend', server.url, 'Whole'])).status, 0);
    await awaitState(server.url, 'Whole', 'Suspended');
    assert.strictEqual((await runMetier(['resume', server.url, 'Whole'])).status, 0);
    assert.strictEqual((await going).status, 0);
    const late = await recorded('--set', 'Duration=30', '--timeout', '0.5');
    assert.notStrictEqual(late.status, 0);
    assert.strictEqual((await runMetier(['reset', server.url, 'Whole'])).status, 0);

    const { output } = await runMetier(['history', '--records', records, '--json']);
    const rows = output.trim().split('\n').map((line) => JSON.parse(line));
    assert.deepStrictEqual(rows.map(({ state, reason }) => [state, reason]),
      [['Halted', 'ByClient'], ['Halted', 'Error'], ['Ready', 'Finished']]);
    assert.match(rows[1].reason_text, /the start was refused/);
    assert.strictEqual(rows[2].server_name, server.url);
    assert.strictEqual(rows[2].parameters.Duration, 3);
    assert.ok(rows[2].result.Count > 0);
    const shown = await runMetier(['history', 'show', '1', '--records', records, '--json']);
    const { transitions } = JSON.parse(shown.output);
    assert.deepStrictEqual(transitions.map(({ from, to }) => `${from} to ${to}`),
      ['Ready to Running', 'Running to Suspended', 'Suspended to Running']);
    assert.match(transitions[0].reason_text, /no atomic start, no dead-man/);
  } finally {
    fs.rmSync(folder, { recursive: true });
  }
});

test('Ctrl-C of run halts a skill, and halt finds it Halted', async () => {
  const lamps = await startProcess(process.execPath, [kProgram]);
  try {
    for (const skill of ['WithoutEvents', 'OwnMethods', 'StartAndHalt']) {
      const running = await startMetier(['run', lamps.url, skill, '--set', 'Duration=30'], /Running/);
      await awaitState(lamps.url, skill, 'Running');
      running.interrupt();
      assert.notStrictEqual((await running.end).status, 0);
      await awaitState(lamps.url, skill, 'Halted');
      const again = await runMetier(['halt', lamps.url, '--skill', skill]);
      assert.strictEqual(again.status, 0, again.errors);
    }
  } finally {
    await lamps.stop();
  }
});

test('what is not there to suspend or reset is named', async () => {
  for (const [command, method] of [['suspend', 'Suspend'], ['reset', 'Reset']]) {
    const refused = await runMetier([command, server.url, 'StartOnly']);
    assert.notStrictEqual(refused.status, 0);
    assert.match(refused.errors, new RegExp(`StartOnly has no ${method}`));
  }
});

/** What the page knows of its server once it is connected. */
async function awaitCell(url) {
  const deadline = Date.now() + 30000;
  let seen;
  while (Date.now() < deadline) {
    [seen] = (await (await fetch(`${url}/api/cell`)).json()).servers;
    if (seen.connected) {
      return seen;
    }
  }
  throw new Error(`not connected: ${seen?.error}`);
}

test('the page shows every skill, and says what it cannot halt', async () => {
  const page = await startServer(['dashboard', '--port', '0', server.url]);
  try {
    const { skills } = await awaitCell(page.url);
    assert.deepStrictEqual(skills.map((skill) => skill.name), kSkills);
    const suspendable = skills.filter((skill) => skill.can.suspend).map((skill) => skill.name);
    assert.deepStrictEqual(suspendable, kSkills.filter((name) => !name.startsWith('Start')));
    const answer = await fetch(`${page.url}/api/halt`, {
      method: 'POST', headers: { 'Content-Type': 'application/json', 'X-Metier': '1' }, body: '{}' });
    const { halted, failed } = await answer.json();
    assert.strictEqual(halted.length, kSkills.length - 1);
    assert.match(failed[0].message, /StartOnly has no Halt/);
  } finally {
    await page.stop();
  }
  for (const skill of kSkills.filter((name) => !name.startsWith('Start'))) {
    assert.strictEqual((await runMetier(['reset', server.url, skill])).status, 0);
  }
});

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
      const { value } = await reader.read();
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

  /** Waits until a skill is shown in a state. */
  async shows(key, state) {
    let event;
    do {
      event = (await this.events.next()).value;
    } while (event.name !== 'skill' || event.data.key !== key || event.data.state !== state);
  }

  close() {
    this.ending.abort();
  }
}

test('the page starts them for the tab that has control, and halts what that leaves running', async () => {
  const lamps = await startProcess(process.execPath, [kProgram]);
  const page = await startServer(['dashboard', '--port', '0', lamps.url]);
  const tabs = [];
  try {
    const { key: server, skills } = await awaitCell(page.url);
    assert.match(skills[0].lacks, /no atomic start .*, no dead-man/);
    const keyOf = (name) => skills.find((skill) => skill.name === name).key;
    const mine = await new Tab(page.url).open();
    const other = await new Tab(page.url).open();
    tabs.push(mine, other);
    const refused = await mine.command('skills/start', { key: keyOf('Whole') });
    assert.match(refused.error.message, /take control/);
    assert.deepStrictEqual((await mine.command('control', { action: 'take' })).taken, [server]);
    assert.match((await other.command('control', { action: 'take', server })).error.message, /has control/);

    for (const name of kSkills) {
      const started = await mine.command('skills/start', { key: keyOf(name), parameters: { Duration: 1 } });
      assert.strictEqual(started.status, 200, JSON.stringify(started));
      await mine.shows(keyOf(name), 'Running');
      await mine.shows(keyOf(name), 'Ready');
    }
    const whole = { key: keyOf('Whole') };
    await mine.command('skills/start', { ...whole, parameters: { Duration: 60 } });
    assert.strictEqual((await mine.command('skills/suspend', whole)).status, 200);
    await mine.shows(whole.key, 'Suspended');
    assert.strictEqual((await mine.command('skills/resume', whole)).status, 200);
    await mine.shows(whole.key, 'Running');
    await mine.command('skills/start', { key: keyOf('WithoutEvents'), parameters: { Duration: 60 } });
    const started_here = runMetier(['run', lamps.url, 'NamesOnly', '--set', 'Duration=3']);
    await awaitState(lamps.url, 'NamesOnly', 'Running');
    mine.close();
    await other.shows(whole.key, 'Halted');
    await awaitState(lamps.url, 'WithoutEvents', 'Halted');
    assert.strictEqual((await started_here).status, 0, 'what another client has started goes on');
    await until(async () => (await other.command('control', { action: 'take' })).taken);
  } finally {
    tabs.forEach((tab) => tab.close());
    await page.stop();
    await lamps.stop();
  }
});

for (const skill of ['Whole', 'PlainEvents', 'WithoutEvents', 'NamesOnly']) {
  test(`a failure of ${skill} ends run, and reset makes it Ready`, async () => {
    const failed = await run(skill, '--set', 'Duration=0.1', '--set', 'Fails=true');
    assert.notStrictEqual(failed.status, 0);
    assert.match(failed.errors, new RegExp(`${skill} was halted`));
    if (skill !== 'WithoutEvents') {
      assert.match(failed.errors, /the lamp is broken/);
    }
    const refused = await run(skill);
    assert.notStrictEqual(refused.status, 0);
    assert.match(refused.errors, /Halted/);
    const reset = await runMetier(['reset', server.url, skill]);
    assert.strictEqual(reset.status, 0, reset.errors);
    const again = await run(skill, '--set', 'Duration=0.05', '--set', 'Fails=false');
    assert.strictEqual(again.status, 0, again.errors);
  });
}

test('a run that takes too long is halted', async () => {
  const late = await run('StartAndHalt', '--set', 'Duration=20', '--timeout', '0.5');
  assert.notStrictEqual(late.status, 0);
  assert.match((await runMetier(['list', server.url])).output, /StartAndHalt +Halted/);
});

test('what has no Halt says so', async () => {
  const late = await run('StartOnly', '--set', 'Duration=20', '--timeout', '0.5');
  assert.notStrictEqual(late.status, 0);
  assert.match(late.errors, /StartOnly has no Halt/);
  const halted = await runMetier(['halt', server.url, 'StartOnly']);
  assert.notStrictEqual(halted.status, 0);
  assert.match(halted.errors, /StartOnly has no Halt/);
});

test('a lease is refused where nobody would keep it', async () => {
  const leased = await run('Whole', '--on-loss', 'halt');
  assert.notStrictEqual(leased.status, 0);
  assert.match(leased.errors, /Whole has no StartWith/);
});

test('run and find say what another maker\'s skill cannot have', async () => {
  assert.strictEqual((await runMetier(['reset', server.url, 'Whole'])).status, 0);
  const { status, errors } = await run('Whole', '--set', 'Duration=0.05', '--set', 'Fails=false');
  assert.strictEqual(status, 0, errors);
  assert.match(errors, /Whole has no atomic start \(another client may write .*\), no dead-man/);
  const found = await runMetier(['find', 'ProgramStateMachineType', '--at', server.url]);
  assert.match(found.output, /Whole fits: .*, no atomic start, no dead-man/);
});

test('a wrong type and an unknown parameter are refused before anything starts', async () => {
  const unknown = await run('Whole', '--set', 'Speed=1');
  assert.notStrictEqual(unknown.status, 0);
  assert.match(unknown.errors, /Speed/);
});

/** A component that runs Programs of the server at `url`. */
async function startComposition(url) {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'foreign_skills_'));
  const skills = ['Whole', 'WithoutEvents', 'NamesOnly', 'OwnMethods'];
  for (const skill of skills) {
    fs.writeFileSync(path.join(folder, `${skill}.toml`), `
name = "Use${skill}"
[parameters.Duration]
type = "number"
unit = "s"
[parameters.Fails]
type = "boolean"
default = false
[results.Count]
type = "uint32"
from = "flash.Count"
[uses.lamp]
type = "${skill}Type"
reset = true
[[step]]
name = "flash"
run = "lamp"
with.Duration = { from = "Duration" }
with.Fails = { from = "Fails" }
`);
  }
  const cell = path.join(folder, 'cell.toml');
  fs.writeFileSync(cell, `
name = "foreign"
[[server]]
name = "component"
kind = "composition"
compositions = [${skills.map((skill) => `"${skill}.toml"`).join(', ')}]
servers = ["${url}"]
stall_limit = 2.0
`);
  const records = path.join(folder, 'records.db');
  const component = await startServer(
    ['serve', cell, '--server', 'component', '--port', '0', '--records', records]);
  return { url: component.url, records, end: component.stop, stop: async () => {
    await component.stop();
    fs.rmSync(folder, { recursive: true });
  } };
}

test('a composition runs, halts and loses skills of another maker', async () => {
  const lamps = await startProcess(process.execPath, [kProgram]);
  const component = await startComposition(lamps.url);
  try {
    for (const skill of ['Whole', 'WithoutEvents', 'NamesOnly', 'OwnMethods']) {
      const use = (...more) => runMetier(['run', component.url, `Use${skill}`, ...more]);
      for (const [count, duration] of [[1, 0.3], [2, 0], [3, 0.05]]) {
        const done = await use('--set', `Duration=${duration}`);
        assert.strictEqual(done.status, 0, done.errors);
        assert.match(done.output, new RegExp(`Count +${count}`));
      }
      const failed = await use('--set', 'Duration=0.1', '--set', 'Fails=true');
      assert.notStrictEqual(failed.status, 0);
      assert.match(failed.errors, skill === 'WithoutEvents' ? /WithoutEvents/ : /the lamp is broken/);
      assert.strictEqual((await runMetier(['reset', component.url, `Use${skill}`])).status, 0);

      const halted = use('--set', 'Duration=30');
      await awaitState(lamps.url, skill, 'Running');
      assert.strictEqual((await runMetier(['halt', component.url, '--skill', `Use${skill}`])).status, 0);
      assert.notStrictEqual((await halted).status, 0);
      await awaitState(lamps.url, skill, 'Halted');
      assert.strictEqual((await runMetier(['reset', component.url, `Use${skill}`])).status, 0);
    }
    const lost = runMetier(['run', component.url, 'UseWhole', '--set', 'Duration=30']);
    await awaitState(lamps.url, 'Whole', 'Running');
    await lamps.kill();
    const { status, errors } = await lost;
    assert.notStrictEqual(status, 0);
    assert.match(errors, /Whole/);
    await assertRecorded(component);
  } finally {
    await component.stop();
  }
});

/** Asserts that the component has recorded what it ran: the other server keeps no records. */
async function assertRecorded(component) {
  await component.end();
  const { output, errors } = await runMetier(
    ['history', '--records', component.records, '--skill', 'Whole', '--json']);
  const rows = output.trim().split('\n').map((line) => JSON.parse(line));
  assert.deepStrictEqual(
    rows.map(({ state, reason }) => `${state} ${reason}`),
    ['Lost ServerLost', 'Halted Error', 'Halted Error', 'Ready Finished', 'Ready Finished', 'Ready Finished'],
    errors);
  assert.deepStrictEqual(rows.map(({ result }) => result && result.Count).slice(3), [3, 2, 1]);
  for (const row of rows) {
    assert.notStrictEqual(row.parent, '');
    assert.strictEqual(typeof row.parameters.Duration, 'number');
  }
}

test('the server that dies ends run as unknown', async () => {
  const doomed = await startProcess(process.execPath, [kProgram]);
  const running = runMetier(['run', doomed.url, 'Whole', '--set', 'Duration=20', '--timeout', '15']);
  await awaitState(doomed.url, 'Whole', 'Running');
  await doomed.kill();
  const { status, errors } = await running;
  assert.strictEqual(status, kLostConnection, errors);
});

async function awaitState(url, skill, state) {
  await until(async () => new RegExp(`${skill} +${state}`).test((await runMetier(['list', url])).output));
}

/** Asks until the answer is yes. */
async function until(asked) {
  const deadline = Date.now() + 30000;
  while (!(await asked())) {
    assert.ok(Date.now() < deadline, `for too long it was not so: ${asked}`);
  }
}
