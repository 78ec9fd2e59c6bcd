// Commands of metier on Programs of another maker, which have only what OPC 10000-10 makes mandatory,
// and less.
'use strict';

const assert = require('node:assert');
const fs = require('node:fs');
const os = require('node:os');
const path = require('node:path');
const { after, before, test } = require('node:test');
const { kShapes, namesWith, setLasting } = require('./foreign_shapes');
const { awaitState, runMetier, startMetier, startProcess } = require('./metier_process');

const kProgram = path.join(__dirname, 'foreign_skills.js');
const kLostConnection = 3;
let server;
let other;  // whose skills may be left Halted

before(async () => {
  server = await startProcess(process.execPath, [kProgram]);
  other = await startProcess(process.execPath, [kProgram]);
});

after(async () => {
  await server?.stop();
  await other?.stop();
});

const run = (skill, ...more) => runMetier(['run', server.url, skill, ...more]);

test('list shows every Program with its state', async () => {
  const { status, output } = await runMetier(['list', server.url]);
  assert.strictEqual(status, 0);
  for (const { name } of kShapes) {
    assert.match(output, new RegExp(`${name} +Ready +no atomic start, no dead-man`));
  }
});

for (const { name, lasts } of kShapes) {
  test(`run starts, and returns the result of ${name}`, async () => {
    for (const count of lasts ? [undefined] : [1, 2]) {
      const { status, output, errors } = await run(name, ...setLasting(name, 0.3));
      assert.strictEqual(status, 0, errors);
      assert.match(output, count ? new RegExp(`Count +${count}`) : /^done$/m);
    }
  });
}

for (const { name } of kShapes.filter(({ lasts }) => !lasts)) {
  test(`run notices an end of ${name} that comes at once`, async () => {
    const { status, output } = await run(name, '--set', 'Duration=0');
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

for (const skill of namesWith('Suspend')) {
  test(`${skill} is suspended and goes on, as watch shows`, async () => {
    const watching = await startMetier(['watch', server.url, skill, '--count', '4'], /watching/);
    const running = run(skill, ...setLasting(skill, 2));
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
    for (const skill of namesWith('Halt')) {
      const running = await startMetier(['run', lamps.url, skill, ...setLasting(skill, 30)], /Running/);
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

for (const { name, methods } of kShapes) {
  test(`${name} is watched, halted while it runs, and reset`, async () => {
    const watching = await startMetier(['watch', other.url, name, '--count', '2'], /watching/);
    const done = await runMetier(['run', other.url, name, ...setLasting(name, 0.3)]);
    assert.strictEqual(done.status, 0, done.errors);
    assert.match((await watching.end).output, /Ready -> Running.*Running -> Ready/s);
    const running = runMetier(['run', other.url, name, ...setLasting(name, methods.includes('Halt') ? 20 : 2)]);
    await awaitState(other.url, name, 'Running');
    const halted = await runMetier(['halt', other.url, '--skill', name]);
    assert.strictEqual(halted.status === 0, methods.includes('Halt'), halted.errors);
    assert.strictEqual((await running).status === 0, !methods.includes('Halt'));
    if (methods.includes('Reset')) {
      assert.strictEqual((await runMetier(['reset', other.url, name])).status, 0);
      await awaitState(other.url, name, 'Ready');
    }
  });
}

test('arrays are sent and read where any rank is declared', async () => {
  const { status, output, errors } = await run('WrongRanks', '--set', 'Duration=0', '--set', 'Pattern=1,2,3', '--json');
  assert.strictEqual(status, 0, errors);
  assert.deepStrictEqual(JSON.parse(output).Echo, [1, 2, 3]);
});

test('what is not there to suspend or reset is named', async () => {
  for (const [command, method] of [['suspend', 'Suspend'], ['reset', 'Reset']]) {
    const refused = await runMetier([command, server.url, 'StartOnly']);
    assert.notStrictEqual(refused.status, 0);
    assert.match(refused.errors, new RegExp(`StartOnly has no ${method}`));
  }
});

for (const { name: skill } of kShapes.filter(({ methods, lasts }) => methods.length > 2 && !lasts)) {
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
  for (const { name } of kShapes) {
    assert.match(found.output, new RegExp(`${name} fits: .*, no atomic start, no dead-man`));
  }
});

test('a wrong type and an unknown parameter are refused before anything starts', async () => {
  const unknown = await run('Whole', '--set', 'Speed=1');
  assert.notStrictEqual(unknown.status, 0);
  assert.match(unknown.errors, /Speed/);
});

test('the server that dies ends run as unknown', async () => {
  const doomed = await startProcess(process.execPath, [kProgram]);
  const running = runMetier(['run', doomed.url, 'Whole', '--set', 'Duration=20', '--timeout', '15']);
  await awaitState(doomed.url, 'Whole', 'Running');
  await doomed.kill();
  const { status, errors } = await running;
  assert.strictEqual(status, kLostConnection, errors);
});

test('a server without subscriptions is read: run, watch and Ctrl-C', async () => {
  const lamps = await startProcess(process.execPath, [kProgram, '--without-subscriptions']);
  try {
    for (const skill of ['Whole', 'NamesOnly', 'Bare']) {
      const watching = await startMetier(['watch', lamps.url, skill, '--count', '2'], /watching/);
      const done = await runMetier(['run', lamps.url, skill, ...setLasting(skill, 1)]);
      assert.strictEqual(done.status, 0, done.errors);
      assert.match((await watching.end).output, /Ready -> Running.*Running -> Ready/s);
      const running = await startMetier(['run', lamps.url, skill, ...setLasting(skill, 30)], /Running/);
      await awaitState(lamps.url, skill, 'Running');
      running.interrupt();
      assert.notStrictEqual((await running.end).status, 0);
      await awaitState(lamps.url, skill, 'Halted');
    }
  } finally {
    await lamps.stop();
  }
});
