// Pick and place with an arm of metier and a gripper of another maker, which offers no more than the
// skill types that were published in 2019: no Hold, no results, no Check.
'use strict';

const assert = require('node:assert');
const fs = require('node:fs');
const os = require('node:os');
const path = require('node:path');
const { after, before, test } = require('node:test');
const { awaitState, runMetier, serve, startMetier, startProcess, startServer, until } = require('./metier_process');
const { Tab, awaitCell } = require('./page_tab');

const kRoot = path.join(__dirname, '..', '..');
const kGripper = path.join(__dirname, 'foreign_gripper.js');
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'foreign_pick_place_'));
let arm;
let gripper;
let component;

before(async () => {
  arm = await serve(folder, 'arm', [
    'driver = { type = "simulator" }', `model = "${path.join(kRoot, 'models', 'iiwa7.toml')}"`,
    'skills = ["CartesianPtpMoveSkill", "CartesianLinearMoveSkill"]',
    'tool = [{ name = "jaws", frame = [0, 0, 0.25, 0, 0, 0] }]',
  ]);
  gripper = await startProcess(process.execPath, [kGripper]);
  component = await serve(folder, 'composition', [
    `compositions = ["${path.join(kRoot, 'compositions', 'pick_and_place.toml')}"]`,
    `servers = ["${arm.url}", "${gripper.url}"]`,
  ]);
});

after(async () => {
  for (const process of [component, gripper, arm]) {
    await process?.stop();
  }
  fs.rmSync(folder, { recursive: true });
});

test('list and find know the types of the gripper', async () => {
  const listed = await runMetier(['list', gripper.url]);
  assert.match(listed.output, /CarefulGrasp +Ready +no atomic start, no dead-man/);
  const found = await runMetier(['find', path.join(kRoot, 'compositions', 'pick_and_place.toml'),
    '--at', arm.url, '--at', gripper.url, '--json']);
  const { possible, roles } = JSON.parse(found.output);
  assert.strictEqual(possible, true, found.output);
  const hold = roles.find(({ role }) => role === 'hold');
  assert.deepStrictEqual([hold.optional, hold.candidates], [true, []]);
});

test('run, watch, halt, reset and the page know them', async () => {
  const slow = await startProcess(process.execPath, [kGripper, '3']);
  const page = await startServer(['dashboard', '--port', '0', '--records', 'off', slow.url]);
  try {
    const { skills } = await awaitCell(page.url);
    assert.deepStrictEqual(skills.map(({ name, type }) => `${name} ${type}`),
      ['CarefulGrasp CarefulGraspSkillType', 'ReleaseGripperSkill ReleaseGripperSkill']);
    for (const skill of ['CarefulGrasp', 'ReleaseGripperSkill']) {
      const watching = await startMetier(['watch', slow.url, skill, '--count', '4'], /watching/);
      const done = await runMetier(['run', slow.url, skill]);
      assert.strictEqual(done.status, 0, done.errors);
      const halted = runMetier(['run', slow.url, skill]);
      await awaitState(slow.url, skill, 'Running');
      assert.strictEqual((await runMetier(['halt', slow.url, '--skill', skill])).status, 0);
      assert.notStrictEqual((await halted).status, 0);
      const { output } = await watching.end;
      assert.match(output, /Running -> Ready .*the fingers have moved.*Running -> Halted/s);
      assert.strictEqual((await runMetier(['reset', slow.url, skill])).status, 0);
      const { key } = skills.find(({ name }) => name === skill);
      const tab = await new Tab(page.url).open();
      const taken = await until('control is free', () => tab.command('control', { action: 'take' }),
        ({ status }) => status === 200);
      assert.strictEqual(taken.status, 200);
      assert.strictEqual((await tab.command('skills/start', { key })).status, 200);
      await tab.shows(key, 'Running');
      await tab.shows(key, 'Ready');
      tab.close();
    }
  } finally {
    await page.stop();
    await slow.stop();
  }
});

test('parts are picked and placed without a Hold', async () => {
  const { status, output, errors } = await runMetier(['pick-place', component.url, '--parts', '2', '--json']);
  assert.strictEqual(status, 0, errors);
  const [tally] = JSON.parse(output);
  assert.strictEqual(tally.placed, 2, output);
});

test('the component goes on after its gripper was halted by somebody', async () => {
  assert.strictEqual((await runMetier(['halt', gripper.url])).status, 0);
  const { status, errors } = await runMetier(['pick-place', component.url, '--parts', '1']);
  assert.strictEqual(status, 0, errors);
});
