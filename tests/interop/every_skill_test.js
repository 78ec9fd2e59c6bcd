// Every skill of the demo cell, run by a client of another maker that knows Programs of OPC 10000-10
// and the published skill types, as the clients of the published skill model do: it subscribes,
// writes parameters, calls Start, waits for the events, reads FinalResultData, and calls Halt and
// Reset.
'use strict';

const assert = require('node:assert');
const path = require('node:path');
const { after, before, test } = require('node:test');
const {
  AttributeIds, ClientMonitoredItem, ClientSubscription, DataType, EventFilter, NodeClass,
  SimpleAttributeOperand, StatusCodes, TimestampsToReturn, Variant, VariantArrayType, coerceQualifiedName,
  ofType, resolveNodeId,
} = require('node-opcua');
const { ThreeDFrame } = require('node-opcua-types');
const { browse, children, connect, everythingBelow, find, isA, read } = require('./address_space');
const { startCell } = require('./metier_process');

const kDemo = path.join(__dirname, '..', '..', 'cells', 'demo.toml');
const kEventDeadlineMs = 60000;
const kReasonError = 3;

let cell;
const servers = [];  // { name, session, close, skills }

before(async () => {
  cell = await startCell(kDemo);
  for (const { name, url } of cell.servers) {
    const connection = await connect(url);
    servers.push({ name, ...connection, skills: await skillsOf(connection.session) });
  }
});

after(async () => {
  for (const server of servers) {
    await server.close();
  }
  await cell?.stop();
});

function deviceSet(session) {
  return find(session, resolveNodeId('ObjectsFolder'), 'DeviceSet');
}

/** Objects whose type is a SkillType, by name. */
async function skillsOf(session) {
  const device = (await session.readNamespaceArray()).indexOf('https://fortiss.org/UA/Device/');
  const skills = new Map();
  for (const { nodeClass, browseName, nodeId, typeDefinition } of
    await everythingBelow(session, await deviceSet(session))) {
    if (nodeClass === NodeClass.Object && await isA(session, typeDefinition, `ns=${device};i=15034`)) {
      skills.set(browseName.name, nodeId);
    }
  }
  return skills;
}

/** Values of fields, by path, of each event of a type at a notifier. */
class Events {
  constructor(fields) {
    this.fields = fields;
    this.arrived = [];
    this.wake = () => {};
  }

  /** All fields are selected by the one type, those that it inherits too (OPC 10000-4, 7.7.4.5). */
  async subscribe(subscription, nodeId, type) {
    const filter = new EventFilter({
      selectClauses: this.fields.map((field) => new SimpleAttributeOperand({
        typeDefinitionId: type, browsePath: field.split('/').map((name) => coerceQualifiedName(name)),
        attributeId: AttributeIds.Value })),
      whereClause: ofType(type),
    });
    const item = ClientMonitoredItem.create(
      subscription, { nodeId, attributeId: AttributeIds.EventNotifier },
      { samplingInterval: 0, discardOldest: true, queueSize: 100, filter }, TimestampsToReturn.Both);
    item.on('changed', (values) => {
      this.arrived.push(new Map(this.fields.map((field, i) => [field.replace(/\d+:/g, ''), values[i].value])));
      this.wake();
    });
    await new Promise((resolve, reject) => {
      item.once('initialized', resolve);
      item.once('err', (why) => reject(new Error(why)));
    });
  }

  async next() {
    if (this.arrived.length === 0) {
      await new Promise((resolve, reject) => {
        const timer = setTimeout(() => reject(new Error('no event')), kEventDeadlineMs);
        this.wake = () => { clearTimeout(timer); resolve(); };
      });
    }
    return this.arrived.shift();
  }
}

const kProgramFields = ['SourceNode', 'SourceName', 'Time', 'Message', 'Severity', 'EventType',  // BaseEventType
  'FromState', 'FromState/Id', 'ToState', 'ToState/Id', 'Transition', 'Transition/Id', 'Transition/Number',  // TransitionEventType
  'IntermediateResult'];
const kSkillFields = (device) => [...kProgramFields, `${device}:ExecutionId`, `${device}:Reason`, `${device}:ReasonText`];

/** One skill, as a client has it. */
class Skill {
  static async open(session, name, nodeId) {
    const skill = new Skill();
    Object.assign(skill, { session, name, nodeId });
    const device = (await session.readNamespaceArray()).indexOf('https://fortiss.org/UA/Device/');
    skill.subscription = ClientSubscription.create(session, {
      requestedPublishingInterval: 50, requestedLifetimeCount: 1000, requestedMaxKeepAliveCount: 10,
      maxNotificationsPerPublish: 0, publishingEnabled: true, priority: 1 });
    skill.programEvents = new Events(kProgramFields);
    await skill.programEvents.subscribe(skill.subscription, nodeId, resolveNodeId('ProgramTransitionEventType'));
    skill.skillEvents = new Events(kSkillFields(device));
    await skill.skillEvents.subscribe(skill.subscription, nodeId, resolveNodeId(`ns=${device};i=15844`));
    return skill;
  }

  find(below) {
    return find(this.session, this.nodeId, below);
  }

  async read(below) {
    return read(this.session, await this.find(below));
  }

  async write(below, value) {
    const statusCode = await this.session.write({
      nodeId: await this.find(below), attributeId: AttributeIds.Value, value: { value: new Variant(value) } });
    assert.strictEqual(statusCode, StatusCodes.Good, `${this.name}: write of ${below}`);
  }

  async call(method) {
    const { statusCode } = await this.session.call({
      objectId: this.nodeId, methodId: await this.find(method), inputArguments: [] });
    assert.strictEqual(statusCode, StatusCodes.Good, `${this.name}: ${method}: ${await this.read('ReasonText')}`);
  }

  /** The next transition in both subscriptions, and what the skill's own Variables say of it. */
  async expect(from, to, number) {
    const transition = `${from}To${to}`;
    const event = await this.programEvents.next();
    const own = await this.skillEvents.next();
    for (const seen of [event, own]) {
      const text = `${this.name}: ${own.get('ReasonText')}`;
      assert.strictEqual(seen.get('Transition').text, transition, text);
      assert.strictEqual(seen.get('Transition/Number'), number, text);
      assert.deepStrictEqual([seen.get('FromState').text, seen.get('ToState').text], [from, to], text);
      assert.strictEqual(seen.get('SourceNode').toString(), this.nodeId.toString());
      assert.strictEqual(seen.get('SourceName'), this.name);
      assert.ok(seen.get('Time') instanceof Date && seen.get('Severity') > 0 && seen.get('Message').text);
    }
    assert.strictEqual(event.get('Transition/Id').toString(), own.get('Transition/Id').toString());
    return own;
  }

  /** The skill rests in a state: CurrentState and LastTransition say so, and how it came there. */
  async expectAtRest(event, state, stateNumber) {
    assert.strictEqual((await this.read('CurrentState')).text, state);
    assert.strictEqual(await this.read('CurrentState/Number'), stateNumber);
    assert.strictEqual((await this.read('CurrentState/Id')).toString(), event.get('ToState/Id').toString());
    assert.strictEqual((await this.read('LastTransition')).text, event.get('Transition').text);
    assert.strictEqual(await this.read('LastTransition/Number'), event.get('Transition/Number'));
    assert.strictEqual((await this.read('LastTransition/Id')).toString(), event.get('Transition/Id').toString());
    assert.ok(Math.abs(await this.read('LastTransition/TransitionTime') - event.get('Time')) < 1000);
  }

  /** Values of FinalResultData by name; null where the last execution has none. */
  async results() {
    const results = {};
    for (const { browseName, nodeId, nodeClass } of
      await children(this.session, await this.find('FinalResultData'))) {
      const value = await this.session.read({ nodeId, attributeId: AttributeIds.Value });
      const there = value.statusCode === StatusCodes.Good;
      assert.ok(nodeClass === NodeClass.Variable && (there || value.statusCode === StatusCodes.BadNoData));
      results[browseName.name] = there ? value.value.value : null;
    }
    return results;
  }

  close() {
    return this.subscription.terminate();
  }
}

const doubles = (value) => ({
  dataType: DataType.Double, arrayType: VariantArrayType.Array, value: Float64Array.from(value) });
const double = (value) => ({ dataType: DataType.Double, value });

/** Measured state of the arm of a server: its Kinematics object. */
async function kinematicsOf(session) {
  const found = (await everythingBelow(session, await deviceSet(session)))
    .find((each) => each.browseName.name === 'Kinematics');
  return found.nodeId;
}

function moved(pose, dx, dz) {
  return new ThreeDFrame({
    cartesianCoordinates: {
      x: pose.cartesianCoordinates.x + dx, y: pose.cartesianCoordinates.y, z: pose.cartesianCoordinates.z + dz },
    orientation: pose.orientation,
  });
}

const near = (left, right, tolerance) => Math.abs(left - right) <= tolerance;

/** A move to joint positions a little aside. */
async function moveJoints(skill) {
  const kinematics = await kinematicsOf(skill.session);
  const target = Array.from(await read(skill.session, await find(skill.session, kinematics, 'ActualJointPosition')));
  target[0] += 0.05;
  await skill.write('ParameterSet/TargetJointPosition', doubles(target));
  return ({ ReachedJointPosition, Duration }) => {
    assert.ok(Duration > 0);
    assert.ok(target.every((position, axis) => near(ReachedJointPosition[axis], position, 1e-2)));
  };
}

async function poseOf(skill) {
  const kinematics = await kinematicsOf(skill.session);
  return read(skill.session, await find(skill.session, kinematics, 'ActualPose'));
}

function reached(pose) {
  return ({ ReachedPose, Duration }) => {
    assert.ok(Duration > 0);
    for (const axis of ['x', 'y', 'z']) {
      assert.ok(near(ReachedPose.cartesianCoordinates[axis], pose.cartesianCoordinates[axis], 2e-3), axis);
    }
  };
}

/** A move to a pose a little higher. */
async function movePose(skill) {
  const pose = moved(await poseOf(skill), 0, 0.02);
  await skill.write('ParameterSet/TargetPosition', { dataType: DataType.ExtensionObject, value: pose });
  return reached(pose);
}

/** A move along two lines, down again. */
async function movePath(skill) {
  const now = await poseOf(skill);
  const poses = [moved(now, 0.01, 0), moved(now, 0, -0.02)];
  await skill.write('ParameterSet/Poses', {
    dataType: DataType.ExtensionObject, arrayType: VariantArrayType.Array, value: poses });
  await skill.write('ParameterSet/BlendRadii', doubles([0.001, 0.001]));
  return reached(poses[1]);
}

/** A stream of the present position, which the client ends once it runs. */
async function stream(skill) {
  const kinematics = await kinematicsOf(skill.session);
  const here = await read(skill.session, await find(skill.session, kinematics, 'ActualJointPosition'));
  await skill.write('ParameterSet/TargetJointPosition', doubles(here));
  skill.whileRunning = () => skill.write('Options/EndOfStream', { dataType: DataType.Boolean, value: true });
  return ({ SetPoints }) => assert.ok(Array.isArray(SetPoints) ? SetPoints[1] >= 0 : SetPoints >= 0);
}

async function moveJaws(skill) {
  await skill.write('ParameterSet/Width', double(0.05));
  return ({ WidthReached }) => assert.ok(near(WidthReached, 0.05, 2e-3), `${WidthReached}`);
}

/** Parameters that a client writes for each skill; each answers how it judges the results. */
const kRecipes = {
  JointPtpMoveSkill: moveJoints,
  JointLinearMoveSkill: moveJoints,
  CartesianPtpMoveSkill: movePose,
  CartesianLinearMoveSkill: movePose,
  CartesianPathMoveSkill: movePath,
  PositionStreamSkill: stream,
  MoveGripperSkill: moveJaws,
  ReleaseGripperSkill: async () => ({ PartHeld }) => assert.strictEqual(PartHeld, false),
  GraspGripperSkill: null,  // there is no part between the jaws
};

/** Runs a skill to its end. */
async function runToTheEnd(skill, recipe) {
  const judge = await recipe(skill);
  await skill.call('Start');
  const started = await skill.expect('Ready', 'Running', 2);
  assert.ok(started.get('ExecutionId').length > 0);
  await skill.whileRunning?.();
  const ended = await skill.expect('Running', 'Ready', 4);
  assert.strictEqual(ended.get('ExecutionId'), started.get('ExecutionId'));
  judge(await skill.results());
  await skill.expectAtRest(ended, 'Ready', 12);
}

async function haltAndReset(skill) {
  await skill.call('Halt');
  await skill.expectAtRest(await skill.expect('Ready', 'Halted', 9), 'Halted', 11);
  await skill.call('Reset');
  await skill.expectAtRest(await skill.expect('Halted', 'Ready', 1), 'Ready', 12);
}

/** A grasp of nothing is an error of the skill, which Reset ends. */
async function graspNothing(skill) {
  await skill.call('Start');
  await skill.expect('Ready', 'Running', 2);
  const halted = await skill.expect('Running', 'Halted', 3);
  assert.strictEqual(halted.get('Reason'), kReasonError);
  assert.match(halted.get('ReasonText'), /no part/);
  await skill.expectAtRest(halted, 'Halted', 11);
  await skill.call('Reset');
  await skill.expectAtRest(await skill.expect('Halted', 'Ready', 1), 'Ready', 12);
}

test('the demo cell has the skills that this test knows', () => {
  const found = Object.fromEntries(servers.map(({ name, skills }) => [name, [...skills.keys()].sort()]));
  const moves = ['CartesianLinearMoveSkill', 'CartesianPathMoveSkill', 'CartesianPtpMoveSkill', 'JointLinearMoveSkill',
    'JointPtpMoveSkill'];
  assert.deepStrictEqual(found, {
    ur5: ['PositionStreamSkill'], 'ur5-move': moves,
    iiwa: moves.filter((name) => name !== 'CartesianPathMoveSkill'),
    edo: ['PositionStreamSkill'], 'edo-move': moves,
    wsg50: ['GraspGripperSkill', 'MoveGripperSkill', 'ReleaseGripperSkill'],
  });
});

test('every skill runs, shows its results, and is halted and reset', async (context) => {
  for (const { name: server, session, skills } of servers) {
    for (const [name, nodeId] of skills) {
      await context.test(`${server}: ${name}`, async () => {
        assert.ok(name in kRecipes, `no recipe for ${name}`);
        const skill = await Skill.open(session, name, nodeId);
        if (kRecipes[name] === null) {
          await graspNothing(skill);
        } else {
          await runToTheEnd(skill, kRecipes[name]);
        }
        await haltAndReset(skill);
        await skill.close();
      });
    }
  }
});

test('a method that nothing implements is not executable, and says so when it is called', async () => {
  for (const { name: server, session } of servers) {
    for (const { nodeClass, browseName, nodeId, above } of
      await everythingBelow(session, await deviceSet(session))) {
      const executable = nodeClass === NodeClass.Method && await read(session, nodeId, AttributeIds.Executable);
      if (nodeClass !== NodeClass.Method || executable) {
        continue;
      }
      assert.strictEqual(await read(session, nodeId, AttributeIds.UserExecutable), false, browseName.name);
      const { statusCode } = await session.call({ objectId: above, methodId: nodeId, inputArguments: [] });
      assert.strictEqual(statusCode, StatusCodes.BadNotExecutable, `${server}: ${browseName.name}`);
    }
  }
  const { session } = servers.find(({ name }) => name === 'ur5');
  const arm = await find(session, await deviceSet(session), 'UrSystem/MotionDevices/Ur');
  assert.strictEqual(await read(session, await find(session, arm, 'FlangeToolSet'), AttributeIds.Executable), false);
  assert.ok((await browse(session, arm, 'HasComponent')).length > 0);
});
