// A move component over the position stream of another maker: an arm that publishes no Kinematics and
// has its axes in another order. It moves alone, and together with an arm of metier.
'use strict';

const assert = require('node:assert');
const fs = require('node:fs');
const os = require('node:os');
const path = require('node:path');
const { after, afterEach, beforeEach, test } = require('node:test');
const { AttributeIds, OPCUAClient } = require('node-opcua');
const { awaitState, runMetier, serve, startProcess, until, writeCell } = require('./metier_process');

const kProgram = path.join(__dirname, 'foreign_arm.js');
const kModel = path.join(__dirname, '..', '..', 'models', 'ur5.toml');
const kJoints = ['base', 'shoulder', 'elbow', 'wrist_1', 'wrist_2', 'wrist_3'];
const kHome = [0, -1.3, 1.75, -2.02, -1.57, 0];
const kAway = [1.2, -1.0, 1.4, -1.8, -1.2, 0.9];
// A pose of the flange that both arms can reach, in their base frames.
const kPlace = '0.4,-0.3,0.5,3.14,0,1';
const kMoveSeconds = 4;
// Longest one of the two [s]: the first set-point is one cycle into the move.
const kCycle = 0.01;
// One arm of the two has a network, and the machine may be busy.
const kLargestSkew = 0.5;
const kObjectsFolder = 'ns=0;i=85';
const kHierarchicalReferences = 'ns=0;i=33';
// A killed server is noticed at once, one that is silent after 2 s; the machine may be busy.
const kNoticedMs = 2500;
// A machine that is busy may begin a command only after the move.
const kMostRounds = 5;

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'foreign_arm_'));
let arm;
let component;

after(() => fs.rmSync(folder, { recursive: true }));

/** @param {string[]} lines of a move component besides its robot */
const linesOf = (lines) => [`robot = "${arm.url}"`, 'stall_limit = 2.0', ...lines];
const startComponent = (lines) => serve(folder, 'move', linesOf(lines));

async function startBoth() {
  arm = await startProcess(process.execPath, [kProgram]);
  component = await startComponent([`model = "${kModel}"`]);
}

async function stopBoth() {
  await component.stop();
  await arm.stop();
}

beforeEach(startBoth);
afterEach(stopBoth);

const move = (joints, ...more) =>
  runMetier(['run', component.url, 'JointPtpMoveSkill', '--set', `TargetJointPosition=${joints}`, ...more]);

/** Reads values of the arm's own server, as any client would. */
async function withArm(work) {
  const client = OPCUAClient.create({ endpointMustExist: false });
  await client.connect(arm.url);
  const session = await client.createSession();
  try {
    return await work(await readerOf(session));
  } finally {
    await session.close();
    await client.disconnect();
  }
}

async function readerOf(session) {
  const namespaces = await session.readNamespaceArray();
  const robotics = namespaces.indexOf('http://opcfoundation.org/UA/Robotics/');
  const di = namespaces.indexOf('http://opcfoundation.org/UA/DI/');
  const find = async (names) => {
    const found = await session.translateBrowsePath({
      startingNode: kObjectsFolder,
      relativePath: { elements: names.map((name) => ({
        referenceTypeId: kHierarchicalReferences, isInverse: false, includeSubtypes: true,
        targetName: name,
      })) },
    });
    return found.targets[0].targetId;
  };
  const at = (index, name) => ({ namespaceIndex: index, name });
  const system = [at(di, 'DeviceSet'), at(1, 'LabRobot')];
  const axes = await Promise.all(kJoints.map((joint) => find([
    ...system, at(robotics, 'MotionDevices'), at(1, 'LabArm'), at(robotics, 'Axes'), at(1, joint),
    at(di, 'ParameterSet'), at(robotics, 'ActualPosition'),
  ])));
  const steps = await find([...system, at(robotics, 'Controllers'), at(1, 'LabController'),
    at(1, 'Skills'), at(1, 'PositionStreamSkill'), at(1, 'Steps')]);
  const read = async (nodeIds) => (await session.read(
    nodeIds.map((nodeId) => ({ nodeId, attributeId: AttributeIds.Value })))).map((each) => each.value.value);
  return {
    /** [rad], in the order of the model */
    joints: async () => (await read(axes)).map((degrees) => (degrees * Math.PI) / 180),
    /** Largest step of an axis from each set-point of the last stream to the next [rad] */
    steps: async () => Array.from((await read([steps]))[0]),
  };
}

/** Share of the way from kHome to kAway at which the arm is, and the distance from that way [rad]. */
function placeOnTheWay(joints) {
  const way = kAway.map((value, axis) => value - kHome[axis]);
  const gone = joints.map((value, axis) => value - kHome[axis]);
  const dot = (a, b) => a.reduce((sum, value, axis) => sum + value * b[axis], 0);
  const share = dot(gone, way) / dot(way, way);
  return { share, off: Math.max(...gone.map((value, axis) => Math.abs(value - share * way[axis]))) };
}

const awaitOnTheWay = (reader) =>
  until('the arm moves', reader.joints, (joints) => placeOnTheWay(joints).share > 0.1);

/**
 * Calls `stop` while the arm moves; on a fresh arm again if the move was over before.
 * @param {() => Promise<void>} stop
 * @returns what the move ended with
 */
async function stopOnTheWay(stop) {
  for (let round = 1; ; ++round) {
    const moving = move(kAway);
    const stopped = withArm(async (reader) => {
      await awaitOnTheWay(reader);
      await stop();
    });
    const [ended] = await Promise.all([moving, stopped]);
    if (ended.status !== 0 || round === kMostRounds) {
      return ended;
    }
    await stopBoth();
    await startBoth();
  }
}

async function halt(url) {
  assert.strictEqual((await runMetier(['halt', url])).status, 0);
}

test('says at its start what cannot be had, as list does', async () => {
  assert.match(component.log(), /LabArm has no atomic start .*no dead-man .*no measured state/);
  assert.match((await runMetier(['list', arm.url])).output,
    /PositionStreamSkill +Ready +no atomic start, no dead-man/);
});

test('moves the arm to where the model says, each axis by its name', async () => {
  const { status, errors } = await move(kAway);
  assert.strictEqual(status, 0, errors);
  const joints = await withArm((reader) => reader.joints());
  joints.forEach((value, axis) => assert.ok(Math.abs(value - kAway[axis]) < 1e-3, `${joints}`));
  await awaitState(arm.url, 'PositionStreamSkill', 'Ready');
});

test('moves the arm along the square', async () => {
  const { status, output, errors } = await runMetier(
    ['square', component.url, '--json', '--svg', path.join(folder, 'square.svg')]);
  assert.strictEqual(status, 0, errors);
  const [square] = JSON.parse(output);
  assert.ok(square.deviation_mm < 1, output);
  assert.ok(square.closure_mm < 1, output);
});

test('a Halt in the middle stops on the path, braked by set-points', async () => {
  assert.notStrictEqual((await stopOnTheWay(() => halt(component.url))).status, 0);
  await withArm(async (reader) => {
    const { share, off } = placeOnTheWay(await reader.joints());
    assert.ok(share < 0.9, `it stopped at ${share} of the way`);
    assert.ok(off < 2e-3, `it stopped ${off} rad beside the way`);
    const steps = await reader.steps();
    const largest = Math.max(...steps);
    assert.ok(steps.at(-1) < largest / 20, `the last steps were ${steps.slice(-5)} of ${largest} rad`);
  });
  await awaitState(arm.url, 'PositionStreamSkill', 'Ready');
});

test('a Halt of the stream halts the move, which goes again after its Reset', async () => {
  const halted = await stopOnTheWay(() => halt(arm.url));
  assert.notStrictEqual(halted.status, 0);
  assert.match(halted.errors, /LabArm: the position stream ended \(Halted\): Halt was called/);
  const reset = await runMetier(['reset', component.url, 'JointPtpMoveSkill']);
  assert.strictEqual(reset.status, 0, reset.errors);
  const { status, errors } = await move(kHome);
  assert.strictEqual(status, 0, errors);
});

test('the death of the server halts the move within the told time', async () => {
  let died;
  const moving = move(kAway);
  await withArm(async (reader) => {
    await awaitOnTheWay(reader);
    died = Date.now();
    await arm.kill();
  }).catch((error) => assert.ok(died, error));
  const { status, errors } = await moving;
  const noticed = Date.now() - died;
  assert.notStrictEqual(status, 0);
  assert.match(errors, /LabArm: the connection to \S+ is lost/);
  assert.ok(noticed < kNoticedMs, `after ${noticed} ms`);
  assert.match((await runMetier(['list', component.url])).output, /JointPtpMoveSkill +Halted/);
});

/** Two arms that move together: ours, and the one of the other maker over its move component. */
async function withBoth(work) {
  const ours = await serve(folder, 'arm', [
    'driver = { type = "simulator" }', `model = "${kModel}"`,
    'skills = ["CartesianPtpMoveSkill", "JointPtpMoveSkill"]',
  ]);
  try {
    const both = await serve(folder, 'synchronized', [`servers = ["${ours.url}", "${component.url}"]`]);
    try {
      await work(both, ours);
    } finally {
      await both.stop();
    }
  } finally {
    await ours.stop();
  }
}

const moveBoth = (url) => runMetier(['run', url, 'SynchronizedMoveSkill', '--json', '--set',
  `TargetPoses=${kPlace};${kPlace}`, '--set', `Duration=${kMoveSeconds}`]);

test('moves together with an arm of metier: they begin and arrive as one', async () => {
  await withBoth(async (both) => {
    const { status, output, errors } = await moveBoth(both.url);
    assert.strictEqual(status, 0, errors);
    const results = JSON.parse(output);
    assert.ok(results.Duration > kMoveSeconds - kCycle, output);
    assert.ok(results.SkewAtStart < kLargestSkew && results.SkewAtEnd < kLargestSkew, output);
  });
});

test('a Halt of the stream halts the arm of metier that moves with it', async () => {
  await withBoth(async (both, ours) => {
    const moving = moveBoth(both.url);
    await awaitState(arm.url, 'PositionStreamSkill', 'Running');
    await halt(arm.url);
    const { status, errors } = await moving;
    assert.notStrictEqual(status, 0);
    assert.match(errors, /the position stream ended \(Halted\)/);
    await awaitState(ours.url, 'JointPtpMoveSkill', 'Halted');
  });
});

for (const [lines, reason] of [
  [[], /belongs to no arm that publishes Kinematics, and no model is given/],
  [[`model = "${kModel.replace('ur5', 'iiwa7')}"`], /the numbers of axes differ/],
  [[`model = "${kModel}"`, `axes = ["base", "shoulder"]`], /is no order of the joints/],
]) {
  test(`is refused: ${reason}`, async () => {
    const refused = await runMetier(['serve', writeCell(folder, 'move', linesOf(lines)), '--server', 'move', '--port', '0']);
    assert.notStrictEqual(refused.status, 0);
    assert.match(refused.errors, reason);
  });
}
