// A line that ends at a force: the arm is one of metier, the force another maker's.
'use strict';

const assert = require('node:assert');
const fs = require('node:fs');
const os = require('node:os');
const path = require('node:path');
const { after, afterEach, before, test } = require('node:test');
const { DataType, OPCUAClient, VariantArrayType } = require('node-opcua');
const { awaitState, runMetier, startProcess, startServer } = require('./metier_process');

const kRoot = path.join(__dirname, '..', '..');
const kSensor = path.join(__dirname, 'foreign_force.js');
const kNamespace = 'urn:lab:force';
const kForce = `variable = "nsu=${kNamespace};s=Force"`;
const kSkill = 'CartesianLinearForceMoveSkill';
const kLine = 'CartesianLinearMoveSkill';
const kStart = '0,0.5,0,-1.5,0,1.1,0';  // rad; the flange looks down
const kNear = '0.5607,0,0.3887,3.14159,0.04159,3.14159';  // 1 cm below
const kFar = '0.5607,0,0.1987,3.14159,0.04159,3.14159';  // 20 cm below
const kSlow = 'MaxVelocity=0.02,0.02,0.02,0.5,0.5,0.5';  // 10 s for the far one

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'foreign_force_'));
let arm;
let sensor;
let component;

function write(name, text) {
  const file = path.join(folder, name);
  fs.writeFileSync(file, text);
  return file;
}

const serveArgs = (cell, server) => ['serve', cell, '--server', server, '--port', '0'];

/** @param {string} force lines of the [[server.force]] */
const componentCell = (force) => write('component.toml', `
name = "press"
[[server]]
name = "press"
kind = "composition"
compositions = ["${path.join(kRoot, 'compositions', 'force_move.toml')}"]
servers = ["${arm.url}", "${sensor.url}"]
[[server.force]]
name = "contact"
server = "${sensor.url}"
${force}
`);

before(async () => {
  arm = await startServer(serveArgs(write('arm.toml', `
name = "arm"
[[server]]
name = "iiwa"
kind = "arm"
driver = { type = "simulator" }
model = "${path.join(kRoot, 'models', 'iiwa7.toml')}"
nodeset = "iiwa"
skills = ["CartesianPtpMoveSkill", "${kLine}", "JointPtpMoveSkill", "JointLinearMoveSkill"]
`), 'iiwa'));
  sensor = await startProcess(process.execPath, [kSensor]);
});

after(async () => {
  await sensor.stop();
  await arm.stop();
  fs.rmSync(folder, { recursive: true });
});

/** Begins a test of a move: the arm stands at its start, and the sensor measures nothing. */
async function begin(force = kForce) {
  await measure([0, 0, 0]);
  const { status, errors } = await runMetier(
    ['run', arm.url, 'JointPtpMoveSkill', '--set', `TargetJointPosition=${kStart}`]);
  assert.strictEqual(status, 0, errors);
  component = await startServer(serveArgs(componentCell(force), 'press'));
}

afterEach(async () => {
  await component?.stop();
  component = undefined;
});

/** The sensor measures it from now on. @param {number[]} newtons */
async function measure(newtons) {
  const client = OPCUAClient.create({ endpointMustExist: false });
  await client.connect(sensor.url);
  const session = await client.createSession();
  const index = (await session.readNamespaceArray()).indexOf(kNamespace);
  const status = await session.writeSingleNode(`ns=${index};s=Force`, {
    dataType: DataType.Double, arrayType: VariantArrayType.Array, value: Float64Array.from(newtons),
  });
  await session.close();
  await client.disconnect();
  assert.ok(status.isGood(), status.toString());
}

const forceMove = (target, ...more) => runMetier(['run', component.url, kSkill, '--json',
  '--set', `TargetPosition=${target}`, '--set', 'MaxForce=0,0,20', ...more]);

/** Starts the slow, far line, and does something once it runs; the end of the line. */
async function meanwhile(act, ...more) {
  const ending = forceMove(kFar, '--set', kSlow, ...more);
  await awaitState(arm.url, kLine, 'Running');
  await act();
  return ending;
}

const resultOf = ({ status, output, errors }) => {
  assert.strictEqual(status, 0, errors);
  return JSON.parse(output.slice(output.indexOf('{')));
};

test('a line that meets no force reaches its target', async () => {
  await begin();
  await measure([500, 0, 19]);
  const result = resultOf(await forceMove(kNear));
  assert.deepStrictEqual(result.ForcesExceeded, { x: 0, y: 0, z: 0 });
  assert.strictEqual(result.ForcesMax.z, 19);
  assert.ok(Math.abs(result.ReachedPose.z - 0.3887) < 1e-4);
});

test('a force ends the line, which is Ready again', async () => {
  await begin();
  const result = resultOf(await meanwhile(() => measure([0, 0, -30])));
  assert.deepStrictEqual(result.ForcesExceeded, { x: 0, y: 0, z: -30 });
  assert.strictEqual(result.ReachedPose, null);
  assert.ok(result.ReactionTime > 0 && result.ReactionTime <= result.StoppingTime);
  await awaitState(arm.url, kLine, 'Ready');
});

test('a force that is measured at the flange is turned into the base frame', async () => {
  await begin(`${kForce}\narm = "${arm.url}"`);
  const { x, z } = resultOf(await meanwhile(() => measure([0, 0, 30]))).ForcesExceeded;
  assert.ok(Math.abs(z + 30) < 0.1, `${z} N along z of the base frame`);
  assert.ok(Math.abs(x) < 2, `${x} N along x: the flange looks down, but for 0.04 rad`);
});

test('with HaltOnForce a force is an error', async () => {
  await begin();
  const { status, errors } = await meanwhile(() => measure([0, 0, 30]), '--set', 'HaltOnForce=true');
  assert.notStrictEqual(status, 0);
  assert.match(errors, /the contact force \[0\.0, 0\.0, 30\.0\] N in the base frame is over its limit/);
  await measure([0, 0, 0]);
  assert.strictEqual((await runMetier(['reset', component.url, kSkill])).status, 0);
  resultOf(await forceMove(kNear));
});

for (const [force, reason] of [
  [`variable = "nsu=${kNamespace};s=Distance"`, /force "contact": \S+s=Distance is in m, not in N/],
  ['variable = "nsu=urn:nobody;s=Force"', /force "contact": .*urn:nobody/],
  ['variable = "Force"', /force "contact": .*Force/],
  ['', /force "contact": no arm with Kinematics/],
  [`${kForce}\narm = "nobody"`, /"nobody" is none of "servers"/],
]) {
  test(`is refused: ${reason}`, async () => {
    const refused = await runMetier(serveArgs(componentCell(force), 'press'));
    assert.notStrictEqual(refused.status, 0);
    assert.match(refused.errors, reason);
  });
}

// The last one: the sensor is gone afterwards.
test('a sensor that dies halts the line, and nothing begins without it', async () => {
  await begin();
  const { status, errors } = await meanwhile(() => sensor.kill());
  assert.notStrictEqual(status, 0);
  assert.match(errors, /the force is not known any more/);
  await awaitState(arm.url, kLine, 'Halted');
  const reset = await runMetier(['reset', component.url, kSkill]);
  assert.strictEqual(reset.status, 0, reset.errors);
  const again = await forceMove(kNear);
  assert.notStrictEqual(again.status, 0);
  assert.match(again.errors, /s=Force/);
  const line = await runMetier(['reset', arm.url, kLine]);
  assert.strictEqual(line.status, 0, line.errors);
});
