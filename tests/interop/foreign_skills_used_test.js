// Compositions of Programs of another maker, also at a server that has no subscriptions.
'use strict';

const assert = require('node:assert');
const fs = require('node:fs');
const os = require('node:os');
const path = require('node:path');
const { after, before, test } = require('node:test');
const { kShapes, namesWith, setLasting } = require('./foreign_shapes');
const { awaitState, runMetier, startMetier, startProcess, startServer } = require('./metier_process');

const kProgram = path.join(__dirname, 'foreign_skills.js');

/** A composition of one step, which runs the Program of a shape and passes its fields on. */
function compositionOf({ name, lasts }) {
  const fields = `
[parameters.Duration]
type = "number"
unit = "s"
[parameters.Fails]
type = "boolean"
default = false
[results.Count]
type = "uint32"
from = "flash.Count"
`;
  return `
name = "Use${name}"
${lasts ? '' : fields}
[uses.lamp]
type = "${name}Type"
reset = true
[[step]]
name = "flash"
run = "lamp"
${lasts ? '' : 'with.Duration = { from = "Duration" }\nwith.Fails = { from = "Fails" }'}
`;
}

/** A component that runs Programs of the server at `url`. */
async function startComposition(url) {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'foreign_skills_'));
  kShapes.forEach((shape) => fs.writeFileSync(path.join(folder, `${shape.name}.toml`), compositionOf(shape)));
  const cell = path.join(folder, 'cell.toml');
  fs.writeFileSync(cell, `
name = "foreign"
[[server]]
name = "component"
kind = "composition"
compositions = [${kShapes.map(({ name }) => `"${name}.toml"`).join(', ')}]
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

for (const without of [[], ['--without-subscriptions']]) {
  const there = without.length > 0 ? ' of a server without subscriptions' : '';
  let lamps;
  let component;

  before(async () => {
    lamps = await startProcess(process.execPath, [kProgram, ...without]);
    component = await startComposition(lamps.url);
  });

  after(async () => {
    await component?.stop();
    await lamps?.kill();
  });

  const use = (skill, ...more) => runMetier(['run', component.url, `Use${skill}`, ...more]);
  const reset = async (skill) => {
    const done = await runMetier(['reset', component.url, `Use${skill}`]);
    assert.strictEqual(done.status, 0, done.errors);
  };

  for (const { name, lasts, event } of kShapes) {
    test(`a composition runs ${name}${there}`, async () => {
      for (const [count, duration] of lasts ? [[undefined, lasts]] : [[1, 0.3], [2, 0], [3, 0.05]]) {
        const done = await use(name, ...setLasting(name, duration));
        assert.strictEqual(done.status, 0, done.errors);
        assert.match(done.output, count ? new RegExp(`Count +${count}`) : /^done$/m);
      }
    });

    if (namesWith('Reset').includes(name) && !lasts) {
      test(`a composition says why ${name}${there} failed`, async () => {
        const failed = await use(name, '--set', 'Duration=0.1', '--set', 'Fails=true');
        assert.notStrictEqual(failed.status, 0);
        const said = event && !there;
        assert.match(failed.errors, said ? /the lamp is broken/ : new RegExp(`${name} of .* was Halted`));
        await reset(name);
      });
    }
  }

  for (const name of namesWith('Halt')) {
    test(`a composition halts ${name}${there}`, async () => {
      const halted = use(name, ...setLasting(name, 30));
      await awaitState(lamps.url, name, 'Running');
      assert.strictEqual((await runMetier(['halt', component.url, '--skill', `Use${name}`])).status, 0);
      assert.notStrictEqual((await halted).status, 0);
      await awaitState(lamps.url, name, 'Halted');
      if (namesWith('Reset').includes(name)) {
        await reset(name);
      }
    });
  }

  for (const name of namesWith('Suspend')) {
    test(`a composition suspends ${name}${there}, and goes on`, async () => {
      const going = use(name, ...setLasting(name, 2));
      await awaitState(lamps.url, name, 'Running');
      assert.strictEqual((await runMetier(['suspend', component.url, `Use${name}`])).status, 0);
      await awaitState(lamps.url, name, 'Suspended');
      await awaitState(component.url, `Use${name}`, 'Suspended');
      assert.strictEqual((await runMetier(['resume', component.url, `Use${name}`])).status, 0);
      const { status, errors } = await going;
      assert.strictEqual(status, 0, errors);
    });
  }

  test(`a client of the composition that dies halts a skill${there}`, async () => {
    const running = await startMetier(['run', component.url, 'UseNamesOnly', '--on-loss', 'halt', '--lease', '500ms',
      '--set', 'Duration=30'], /Running/);
    await awaitState(lamps.url, 'NamesOnly', 'Running');
    running.kill();
    await awaitState(lamps.url, 'NamesOnly', 'Halted');
    await reset('NamesOnly');
  });

  test(`a composition loses and records a skill${there}`, async () => {
    const lost = use('Whole', '--set', 'Duration=30');
    await awaitState(lamps.url, 'Whole', 'Running');
    await lamps.kill();
    const { status, errors } = await lost;
    assert.notStrictEqual(status, 0);
    assert.match(errors, /Whole/);
    await component.end();
    await assertRecorded(component.records);
  });
}

/** Asserts that the component has recorded what it ran: the other server keeps no records. */
async function assertRecorded(records) {
  const { output, errors } = await runMetier(
    ['history', '--records', records, '--skill', 'Whole', '--json']);
  const rows = output.trim().split('\n').map((line) => JSON.parse(line));
  assert.deepStrictEqual(
    rows.map(({ state, reason }) => `${state} ${reason}`),
    ['Lost ServerLost', 'Ready Finished', 'Halted Error', 'Halted Error', 'Ready Finished', 'Ready Finished',
      'Ready Finished'],
    errors);
  assert.deepStrictEqual(rows.map(({ result }) => result && result.Count).slice(4), [3, 2, 1]);
  const shown = await runMetier(['history', 'show', String(rows[1].number), '--records', records, '--json']);
  assert.deepStrictEqual(
    JSON.parse(shown.output).transitions.map(({ from, to }) => `${from} to ${to}`),
    ['Ready to Running', 'Running to Suspended', 'Suspended to Running']);
  for (const row of rows) {
    assert.notStrictEqual(row.parent, '');
    assert.strictEqual(typeof row.parameters.Duration, 'number');
  }
}
