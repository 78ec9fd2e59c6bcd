// The page at Programs of another maker, also at a server that has no subscriptions.
'use strict';

const assert = require('node:assert');
const fs = require('node:fs');
const os = require('node:os');
const path = require('node:path');
const { after, before, test } = require('node:test');
const { kShapes, lasting, namesWith } = require('./foreign_shapes');
const { awaitState, runMetier, startProcess, startServer, until } = require('./metier_process');
const { Tab, awaitCell } = require('./page_tab');

const kProgram = path.join(__dirname, 'foreign_skills.js');

for (const without of [[], ['--without-subscriptions']]) {
  const there = without.length > 0 ? ' of a server without subscriptions' : '';
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'foreign_page_'));
  const records = path.join(folder, 'records.db');
  let lamps;
  let page;

  before(async () => {
    lamps = await startProcess(process.execPath, [kProgram, ...without]);
    page = await startServer(['dashboard', '--port', '0', '--records', records, lamps.url]);
  });

  after(async () => {
    await page?.stop();
    await lamps?.stop();
    fs.rmSync(folder, { recursive: true });
  });

  /** Rows of what the page has started of a skill, the newest first. */
  const recorded = async (skill) => {
    const { output, errors } = await runMetier(['history', '--records', records, '--skill', skill, '--json']);
    assert.notStrictEqual(output.trim(), '', errors);
    return output.trim().split('\n').map((line) => JSON.parse(line));
  };

  test(`the page shows every skill${there}, and says what it cannot halt`, async () => {
    const { skills } = await awaitCell(page.url);
    assert.deepStrictEqual(skills.map((skill) => skill.name), kShapes.map((shape) => shape.name));
    const suspendable = skills.filter((skill) => skill.can.suspend).map((skill) => skill.name);
    assert.deepStrictEqual(suspendable, namesWith('Suspend'));
    const answer = await fetch(`${page.url}/api/halt`, {
      method: 'POST', headers: { 'Content-Type': 'application/json', 'X-Metier': '1' }, body: '{}' });
    const { halted, failed } = await answer.json();
    assert.strictEqual(halted.length, kShapes.length - 1);
    assert.match(failed[0].message, /StartOnly has no Halt/);
    for (const skill of namesWith('Reset')) {
      assert.strictEqual((await runMetier(['reset', lamps.url, skill])).status, 0);
    }
  });

  test(`the page starts them${there} for the tab that has control, and halts what that leaves running`, async () => {
    const { key: server, skills } = await awaitCell(page.url);
    const keyOf = (name) => skills.find((skill) => skill.name === name).key;
    assert.match(skills[0].lacks, /no atomic start .*, no dead-man/);
    const mine = await new Tab(page.url).open();
    const other = await new Tab(page.url).open();
    try {
      const refused = await mine.command('skills/start', { key: keyOf('Whole') });
      assert.match(refused.error.message, /take control/);
      assert.deepStrictEqual((await mine.command('control', { action: 'take' })).taken, [server]);
      assert.match((await other.command('control', { action: 'take', server })).error.message, /has control/);

      for (const name of [...namesWith('Reset'), 'StartOnly']) {
        const started = await mine.command('skills/start', { key: keyOf(name), parameters: lasting(name, 1) });
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
      const stopped = { key: keyOf('NamesOnly') };
      await mine.command('skills/start', { ...stopped, parameters: { Duration: 60 } });
      await mine.shows(stopped.key, 'Running');
      assert.strictEqual((await mine.command('skills/halt', stopped)).status, 200);
      await mine.shows(stopped.key, 'Halted');
      assert.strictEqual((await mine.command('skills/reset', stopped)).status, 200);
      await mine.shows(stopped.key, 'Ready');
      for (const twice of [0, 0]) {
        const quick = await mine.command('skills/start', { ...stopped, parameters: { Duration: twice } });
        assert.strictEqual(quick.status, 200, JSON.stringify(quick));
      }
      const started_here = runMetier(['run', lamps.url, 'NamesOnly', '--set', 'Duration=3']);
      await awaitState(lamps.url, 'NamesOnly', 'Running');
      mine.close();
      await other.shows(whole.key, 'Halted');
      await awaitState(lamps.url, 'WithoutEvents', 'Halted');
      assert.strictEqual((await started_here).status, 0, 'what another client has started goes on');
      await until('control is free', () => other.command('control', { action: 'take' }), ({ taken }) => taken);
    } finally {
      mine.close();
      other.close();
    }
  });

  test(`the page records what it has started${there}: the server keeps no records`, async () => {
    await page.stop();
    const ends = async (skill) => (await recorded(skill)).map(({ state, reason }) => `${state} ${reason}`);
    assert.deepStrictEqual(await ends('Whole'), ['Halted ByClient', 'Ready Finished']);
    assert.deepStrictEqual(await ends('Bare'), ['Ready Finished']);
    assert.deepStrictEqual(await ends('NamesOnly'),
      ['Ready Finished', 'Ready Finished', 'Halted ByClient', 'Ready Finished'],
      'also of runs that were over before the next start');
    const [halted, finished] = await recorded('Whole');
    assert.strictEqual(halted.server_name, lamps.url);
    assert.strictEqual(finished.parameters.Duration, 1);
    assert.strictEqual(finished.result.Count, 1);
    const shown = await runMetier(['history', 'show', String(halted.number), '--records', records, '--json']);
    assert.deepStrictEqual(
      JSON.parse(shown.output).transitions.map(({ from, to }) => `${from} to ${to}`),
      ['Ready to Running', 'Running to Suspended', 'Suspended to Running']);
  });
}
