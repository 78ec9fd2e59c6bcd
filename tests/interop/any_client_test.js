// The steps of a person with UaExpert, done by node-opcua, which knows nothing of metier: browse from
// Objects to a skill, write its parameter, call Start, watch the events.
'use strict';

const assert = require('node:assert');
const { once } = require('node:events');
const fs = require('node:fs');
const os = require('node:os');
const path = require('node:path');
const { after, before, test } = require('node:test');
const {
  AttributeIds, BrowseDirection, ClientMonitoredItem, ClientSubscription, DataType, EventFilter,
  MessageSecurityMode, NodeClass, OPCUAClient, SecurityPolicy, SimpleAttributeOperand, StatusCodes,
  TimestampsToReturn, UserTokenType, VariantArrayType, constructEventFilter, ofType, resolveNodeId,
} = require('node-opcua');
const { runMetier, startServer } = require('./metier_process');

const kCell = path.join(__dirname, '..', 'system', 'simulated.toml');
const kProgramStateMachineType = 'ns=0;i=2391';
const kEventDeadlineMs = 20000;
const kFolder = fs.mkdtempSync(path.join(os.tmpdir(), 'any_client_'));
const kRecords = path.join(kFolder, 'records.db');

let server;
let client;
let session;

before(async () => {
  server = await startServer(['serve', kCell, '--server', 'iiwa', '--port', '0',
    '--records', kRecords]);
  client = OPCUAClient.create({
    endpointMustExist: false,
    securityMode: MessageSecurityMode.None,
    securityPolicy: SecurityPolicy.None,
  });
  await client.connect(server.url);
  session = await client.createSession();
});

after(async () => {
  await session?.close();
  await client?.disconnect();
  await server?.stop();
  fs.rmSync(kFolder, { recursive: true });
});

/** Children of a node by hierarchical references. */
async function children(nodeId) {
  const result = await session.browse({
    nodeId,
    referenceTypeId: 'HierarchicalReferences',
    browseDirection: BrowseDirection.Forward,
    includeSubtypes: true,
    nodeClassMask: 0,
    resultMask: 63,
  });
  assert.strictEqual(result.statusCode, StatusCodes.Good);
  return result.references;
}

async function child(nodeId, name) {
  const found = (await children(nodeId)).find((r) => r.browseName.name === name);
  assert.ok(found, `no ${name} below ${nodeId}`);
  return found.nodeId;
}

async function isProgram(typeId) {
  for (let type = typeId; type; ) {
    if (type.toString() === kProgramStateMachineType) {
      return true;
    }
    const above = await session.browse({
      nodeId: type,
      referenceTypeId: 'HasSubtype',
      browseDirection: BrowseDirection.Inverse,
      includeSubtypes: true,
      nodeClassMask: 0,
      resultMask: 63,
    });
    type = above.references[0]?.nodeId;
  }
  return false;
}

/** Every Program below a node, by name; each with the chain of objects that leads there. */
async function findPrograms(nodeId, trail = [], seen = new Set()) {
  const found = new Map();
  for (const reference of await children(nodeId)) {
    const id = reference.nodeId.toString();
    if (reference.nodeClass !== NodeClass.Object || seen.has(id)) {
      continue;
    }
    seen.add(id);
    if (await isProgram(reference.typeDefinition)) {
      found.set(reference.browseName.name, { nodeId: reference.nodeId, trail });
      continue;
    }
    const below = await findPrograms(reference.nodeId, [...trail, reference.nodeId], seen);
    below.forEach((program, name) => found.set(name, program));
  }
  return found;
}

async function deviceSet() {
  return child(resolveNodeId('ObjectsFolder'), 'DeviceSet');
}

async function callMethod(objectId, name) {
  const result = await session.call({ objectId, methodId: await child(objectId, name), inputArguments: [] });
  return result.statusCode;
}

async function read(nodeId) {
  const value = await session.read({ nodeId, attributeId: AttributeIds.Value });
  assert.strictEqual(value.statusCode, StatusCodes.Good);
  return value.value.value;
}

/** Collects transition events at a notifier; `until(n)` waits for the n-th with a deadline. */
async function collectEvents(subscription, nodeId) {
  const events = [];
  const waiting = [];
  const filter = constructEventFilter(
    ['SourceNode', 'Message', 'Severity', 'Time', 'FromState', 'ToState', 'Transition', 'Transition.Number'],
    resolveNodeId('ProgramTransitionEventType'));
  const item = ClientMonitoredItem.create(
    subscription, { nodeId, attributeId: AttributeIds.EventNotifier },
    { samplingInterval: 0, discardOldest: true, queueSize: 100, filter }, TimestampsToReturn.Both);
  await new Promise((resolve, reject) => {
    item.once('initialized', resolve);
    item.once('err', reject);
  });
  item.on('changed', (fields) => {
    if (fields[5].value === null) {
      return;  // no transition: an audit event of the Server
    }
    events.push({
      source: fields[0].value.toString(),
      message: fields[1].value.text,
      severity: fields[2].value,
      time: fields[3].value,
      from: fields[4].value.text,
      to: fields[5].value.text,
      transition: fields[6].value.text,
      number: fields[7].value,
    });
    waiting.filter((w) => events.length >= w.count).forEach((w) => w.resolve());
  });
  const until = (count) => new Promise((resolve, reject) => {
    if (events.length >= count) {
      resolve(events);
      return;
    }
    const timer = setTimeout(
      () => reject(new Error(`${events.length} of ${count} events at ${nodeId}`)), kEventDeadlineMs);
    waiting.push({ count, resolve: () => { clearTimeout(timer); resolve(events); } });
  });
  return { events, until };
}

/** Names on the way from a type to each of its fields, those of the types above included. */
async function fieldsOf(type, path = []) {
  const fields = [];
  for (const reference of await children(type)) {
    if (reference.nodeClass === NodeClass.Variable) {
      const names = [...path, reference.browseName];
      fields.push(names, ...await fieldsOf(reference.nodeId, names));
    }
  }
  if (path.length > 0) {
    return fields;
  }
  const above = await session.browse({
    nodeId: type, referenceTypeId: 'HasSubtype', browseDirection: BrowseDirection.Inverse, resultMask: 63 });
  return above.references.length === 0 || type.toString() === resolveNodeId('BaseEventType').toString()
    ? fields : [...fields, ...await fieldsOf(above.references[0].nodeId)];
}

/** What arrives at a notifier, a Map of field to value each; `first()` waits for it with a deadline. */
async function selectAll(subscription, nodeId, type, fields) {
  const filter = new EventFilter({
    selectClauses: fields.map((browsePath) => new SimpleAttributeOperand({
      typeDefinitionId: type, browsePath, attributeId: AttributeIds.Value })),
    whereClause: ofType(type),
  });
  const item = ClientMonitoredItem.create(
    subscription, { nodeId, attributeId: AttributeIds.EventNotifier },
    { samplingInterval: 0, discardOldest: true, queueSize: 100, filter }, TimestampsToReturn.Both);
  const arrived = once(item, 'changed');
  await Promise.race([once(item, 'initialized'), once(item, 'err').then(([why]) => { throw new Error(why); })]);
  return {
    first: async () => {
      const [values] = await Promise.race([arrived, once(AbortSignal.timeout(kEventDeadlineMs), 'abort')
        .then(() => { throw new Error(`no event of ${type}`); })]);
      return new Map(fields.map((path, i) => [path.map((name) => name.name).join('/'), values[i].value]));
    },
  };
}

test('a skill is found by browsing from Objects alone', async () => {
  const programs = await findPrograms(await deviceSet());
  assert.deepStrictEqual([...programs.keys()].sort(), [
    'CartesianLinearMoveSkill', 'CartesianPtpMoveSkill', 'JointLinearMoveSkill', 'JointPtpMoveSkill']);
  for (const [name, { nodeId }] of programs) {
    assert.strictEqual(await read(await child(nodeId, 'Name')), name);
  }
});

test('write, Start, and the events arrive at the skill, the device and the Server', async () => {
  const programs = await findPrograms(await deviceSet());
  const skill = programs.get('JointPtpMoveSkill');
  const subscription = ClientSubscription.create(session, {
    requestedPublishingInterval: 100, requestedLifetimeCount: 1000, requestedMaxKeepAliveCount: 10,
    maxNotificationsPerPublish: 0, publishingEnabled: true, priority: 1,
  });
  const notifiers = [skill.nodeId, skill.trail[0], resolveNodeId('Server')];
  const collected = [];
  for (const notifier of notifiers) {
    collected.push(await collectEvents(subscription, notifier));
  }
  const target = await child(await child(skill.nodeId, 'ParameterSet'), 'TargetJointPosition');
  const statusCode = await session.write({
    nodeId: target,
    attributeId: AttributeIds.Value,
    value: {
      value: { dataType: DataType.Double, arrayType: VariantArrayType.Array,
        value: new Float64Array([0.1, 0.5, 0.1, -1.4, 0.1, 0.9, 0.1]) },
    },
  });
  assert.strictEqual(statusCode, StatusCodes.Good);
  const slowly = await session.write({  // so that it still runs at the second Start
    nodeId: await child(await child(skill.nodeId, 'Options'), 'SpeedOverride'),
    attributeId: AttributeIds.Value,
    value: { value: { dataType: DataType.Double, value: 0.05 } },
  });
  assert.strictEqual(slowly, StatusCodes.Good);
  assert.strictEqual(await callMethod(skill.nodeId, 'Start'), StatusCodes.Good);
  assert.strictEqual(await callMethod(skill.nodeId, 'Start'), StatusCodes.BadInvalidState);
  for (const { until } of collected) {
    const events = await until(2);
    assert.deepStrictEqual(events.map((e) => [e.from, e.to]), [['Ready', 'Running'], ['Running', 'Ready']]);
    assert.deepStrictEqual(events.map((e) => e.transition), ['ReadyToRunning', 'RunningToReady']);
    assert.deepStrictEqual(events.map((e) => e.number), [2, 4]);
    assert.ok(events.every((e) => e.source === skill.nodeId.toString()));
    assert.ok(events[0].time <= events[1].time);
  }
  await subscription.terminate();
  const state = await child(skill.nodeId, 'CurrentState');
  assert.strictEqual((await read(state)).text, 'Ready');
  assert.strictEqual(await read(await child(state, 'Number')), 12);
});

test('the server has recorded what this client did', async () => {
  const programs = await findPrograms(await deviceSet());
  const skill = programs.get('JointPtpMoveSkill');
  const latest = await child(await child(skill.nodeId, 'ExecutionRecords'), 'Latest');
  const id = await read(await child(latest, 'ExecutionId'));
  assert.strictEqual(await read(await child(latest, 'EndState')), 12);
  assert.ok(JSON.parse(await read(await child(latest, 'Result'))).Duration > 0);
  const deadline = Date.now() + kEventDeadlineMs;
  let record;
  while (record?.state !== 'Ready' && Date.now() < deadline) {
    const { output } = await runMetier(['history', '--json', '--records', kRecords]);
    record = output.trim() === '' ? undefined : JSON.parse(output.trim().split('\n')[0]);
  }
  assert.strictEqual(record.id, id);
  assert.strictEqual(record.skill, 'JointPtpMoveSkill');
  assert.strictEqual(record.reason, 'Finished');
  assert.strictEqual(record.session.toLowerCase(), session.sessionId.toString().toLowerCase());  // a Guid
  assert.deepStrictEqual(record.parameters.TargetJointPosition, [0.1, 0.5, 0.1, -1.4, 0.1, 0.9, 0.1]);
  assert.ok(record.client_name.length > 0);
  const shown = JSON.parse(
    (await runMetier(['history', 'show', String(record.number), '--json', '--records', kRecords])).output);
  assert.ok(shown.path.length >= 3);
  assert.ok(Math.abs(shown.path.at(-1).actual[1] - 0.5) < 1e-2);
});

test('UserExecutable and ProgramDiagnostic tell what may be called and what was called', async () => {
  const programs = await findPrograms(await deviceSet());
  const skill = programs.get('CartesianPtpMoveSkill');
  const executable = async (method) => {
    const value = await session.read({
      nodeId: await child(skill.nodeId, method), attributeId: AttributeIds.UserExecutable });
    return value.value.value;
  };
  const allowed = async () => {
    const methods = ['Start', 'Suspend', 'Resume', 'Halt', 'Reset'];
    const answers = await Promise.all(methods.map(executable));
    return methods.filter((_, index) => answers[index]);
  };
  assert.deepStrictEqual(await allowed(), ['Start', 'Halt']);
  assert.strictEqual(await callMethod(skill.nodeId, 'Resume'), StatusCodes.BadInvalidState);
  const diagnostic = await child(skill.nodeId, 'ProgramDiagnostic');
  const whole = await read(diagnostic);
  assert.strictEqual(whole.lastMethodCall, 'Resume');
  assert.strictEqual(whole.lastMethodReturnStatus, StatusCodes.BadInvalidState);
  assert.strictEqual(whole.lastMethodSessionId.toString(), session.sessionId.toString());
  assert.strictEqual(await read(await child(diagnostic, 'LastMethodCall')), 'Resume');
  assert.strictEqual(await callMethod(skill.nodeId, 'Halt'), StatusCodes.Good);
  assert.deepStrictEqual(await allowed(), ['Reset']);
  assert.strictEqual(await callMethod(skill.nodeId, 'Reset'), StatusCodes.Good);
});

test('a bad parameter is refused in the write, and the skill stays usable', async () => {
  const programs = await findPrograms(await deviceSet());
  const skill = programs.get('JointPtpMoveSkill');
  const target = await child(await child(skill.nodeId, 'ParameterSet'), 'TargetJointPosition');
  const write = (value) => session.write({ nodeId: target, attributeId: AttributeIds.Value, value: { value } });
  const doubles = (values) => ({
    dataType: DataType.Double, arrayType: VariantArrayType.Array, value: new Float64Array(values) });
  assert.strictEqual(await write(doubles([0, 0, NaN, 0, 0, 0, 0])), StatusCodes.BadOutOfRange);
  assert.strictEqual(await write(doubles([0, 0, 0])), StatusCodes.BadOutOfRange);
  assert.strictEqual(await write({ dataType: DataType.String, value: 'home' }), StatusCodes.BadTypeMismatch);
  assert.strictEqual(await callMethod(skill.nodeId, 'Halt'), StatusCodes.Good);
  assert.strictEqual(await callMethod(skill.nodeId, 'Reset'), StatusCodes.Good);
});

test('every field of an event is selected by the type of the event, those of the types above too', async () => {
  const skill = (await findPrograms(await deviceSet())).get('JointPtpMoveSkill');
  const namespaces = await session.readNamespaceArray();
  const type = `ns=${namespaces.indexOf('https://fortiss.org/UA/Device/')};i=15844`;
  const fields = await fieldsOf(resolveNodeId(type));
  const subscription = ClientSubscription.create(session, {
    requestedPublishingInterval: 100, requestedLifetimeCount: 1000, requestedMaxKeepAliveCount: 10,
    maxNotificationsPerPublish: 0, publishingEnabled: true, priority: 1,
  });
  const selected = await selectAll(subscription, skill.nodeId, resolveNodeId(type), fields);
  assert.strictEqual(await callMethod(skill.nodeId, 'Halt'), StatusCodes.Good);
  const event = await selected.first();
  await subscription.terminate();
  assert.strictEqual(await callMethod(skill.nodeId, 'Reset'), StatusCodes.Good);
  assert.strictEqual(event.get('EventType').toString(), type);
  assert.strictEqual(event.get('SourceNode').toString(), skill.nodeId.toString());
  assert.strictEqual(event.get('SourceName'), 'JointPtpMoveSkill');
  assert.strictEqual(event.get('FromState').text, 'Ready');
  assert.strictEqual(event.get('FromState/Number'), 12);
  assert.strictEqual(event.get('ToState').text, 'Halted');
  assert.strictEqual(event.get('Transition').text, 'ReadyToHalted');
  assert.strictEqual(event.get('Transition/Number'), 9);
  for (const name of ['EventId', 'Time', 'ReceiveTime', 'Message', 'Severity', 'Transition/Id',
    'Transition/TransitionTime', 'FromState/Id', 'ToState/Id', 'ExecutionId', 'Reason', 'ReasonText']) {
    assert.ok(event.has(name) && event.get(name) !== null, name);
  }
  assert.strictEqual(event.get('LocalTime'), null);  // optional, and not there
});

test('a lab lets a client in that always sends a user name', async () => {
  const named = await client.createSession({
    type: UserTokenType.UserName, userName: 'line 4', password: 'whatever' });
  const state = await named.read({ nodeId: 'ns=0;i=2259', attributeId: AttributeIds.Value });
  assert.strictEqual(state.statusCode, StatusCodes.Good);
  await named.close();
});
