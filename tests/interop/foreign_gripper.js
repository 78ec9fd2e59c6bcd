// A gripper of another maker: instances of the skill types that were published in 2019, made from their
// NodeSets by node-opcua, with their mandatory children and nothing of metier; its grasp is of a type
// of its own that is derived from the published one. It has no hardware: it takes its time, 0.1 s or
// the seconds that are given as argument. Prints "ready URL" and runs until it is ended.
'use strict';

console.log = console.error;  // what node-opcua says; the standard output is for "ready URL"
const path = require('node:path');
const { DataType, OPCUAServer, StatusCodes, coerceNodeId, nodesets } = require('node-opcua');
const { freePort } = require('./free_port');
const { kMethodsWithoutSuspend: kMethods, kStates } = require('./program_states');
const { announce, run } = require('./server_program');

const kDevice = path.join(__dirname, '..', '..', 'nodesets', 'device', 'NodeSet2.xml');
// ObjectTypes of https://fortiss.org/UA/Device/.
const kTypes = { GraspGripperSkill: 15168, ReleaseGripperSkill: 15473 };
const kTransitionEventType = 15844;
const kMoveMs = 1000 * Number(process.argv[2] ?? 0.1);

/** A skill that is Running for a moment. Suspend and Resume are there and refuse. */
class Skill {
  constructor(space, parent, name, type) {
    const device = space.getNamespaceIndex('https://fortiss.org/UA/Device/');
    this.event = space.findNode(`ns=${device};i=${kTransitionEventType}`);
    this.object = type.instantiate({ browseName: name, componentOf: parent });
    this.object.setEventNotifier(1);
    this.object.getPropertyByName('Name', device).setValueFromSource({ dataType: DataType.String, value: name });
    for (const method of ['Start', 'Suspend', 'Resume', 'Halt', 'Reset']) {
      this.object.getMethodByName(method).bindMethod(
        (_inputs, _context, done) => done(null, { statusCode: this.call(method) }));
    }
    this.show('Ready');
  }

  show(state) {
    const before = this.state;
    this.state = state;
    if (before) {
      this.raise(before, state);
    }
    const current = this.object.getComponentByName('CurrentState');
    current.setValueFromSource({ dataType: DataType.LocalizedText, value: { text: state } });
    current.getPropertyByName('Id').setValueFromSource({
      dataType: DataType.NodeId, value: coerceNodeId(`ns=0;i=${kStates[state].id}`),
    });
    current.getPropertyByName('Number').setValueFromSource({
      dataType: DataType.UInt32, value: kStates[state].number,
    });
  }

  raise(from, to) {
    const text = (value) => ({ dataType: DataType.LocalizedText, value: { text: value } });
    this.object.raiseEvent(this.event, {
      message: text('the fingers have moved'),
      severity: { dataType: DataType.UInt16, value: 100 },
      transition: text(`${from}To${to}`),
      fromState: text(from),
      toState: text(to),
    });
  }

  /** @returns {import('node-opcua').StatusCode} */
  call(method) {
    const change = kMethods[method];
    if (!change?.from.includes(this.state)) {
      return StatusCodes.BadInvalidState;
    }
    clearTimeout(this.timer);
    this.show(change.to);
    if (change.to === 'Running') {
      this.timer = setTimeout(() => this.show('Ready'), kMoveMs);
    }
    return StatusCodes.Good;
  }
}

async function main() {
  const port = await freePort();
  const server = new OPCUAServer({
    port, allowAnonymous: true, nodeset_filename: [nodesets.standard, nodesets.di, kDevice],
  });
  await server.initialize();
  const space = server.engine.addressSpace;
  const namespace = space.getOwnNamespace();
  const gripper = namespace.addObject({ browseName: 'LabGripper', organizedBy: space.rootFolder.objects });
  const skills = namespace.addObject({ browseName: 'Skills', componentOf: gripper });
  const device = space.getNamespaceIndex('https://fortiss.org/UA/Device/');
  const [grasp, release] = Object.values(kTypes).map((id) => space.findNode(`ns=${device};i=${id}`));
  const careful = namespace.addObjectType({ browseName: 'CarefulGraspSkillType', subtypeOf: grasp });
  new Skill(space, skills, 'CarefulGrasp', careful);
  new Skill(space, skills, 'ReleaseGripperSkill', release);
  await server.start();
  announce(server, port);
}

run(main);
