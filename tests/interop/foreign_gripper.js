// A gripper of another maker: instances of the skill types that were published in 2019, made from their
// NodeSets by node-opcua, with their mandatory children and nothing of metier. It has no hardware: it
// takes its time. Prints "ready URL" and runs until it is ended.
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
const kMoveMs = 100;

/** A skill that is Running for a moment. Suspend and Resume are there and refuse. */
class Skill {
  constructor(space, parent, name, id) {
    const device = space.getNamespaceIndex('https://fortiss.org/UA/Device/');
    this.object = space.findNode(`ns=${device};i=${id}`).instantiate({ browseName: name, componentOf: parent });
    this.object.getPropertyByName('Name', device).setValueFromSource({ dataType: DataType.String, value: name });
    for (const method of ['Start', 'Suspend', 'Resume', 'Halt', 'Reset']) {
      this.object.getMethodByName(method).bindMethod(
        (_inputs, _context, done) => done(null, { statusCode: this.call(method) }));
    }
    this.show('Ready');
  }

  show(state) {
    this.state = state;
    const current = this.object.getComponentByName('CurrentState');
    current.setValueFromSource({ dataType: DataType.LocalizedText, value: { text: state } });
    current.getPropertyByName('Id').setValueFromSource({
      dataType: DataType.NodeId, value: coerceNodeId(`ns=0;i=${kStates[state].id}`),
    });
    current.getPropertyByName('Number').setValueFromSource({
      dataType: DataType.UInt32, value: kStates[state].number,
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
  for (const [name, id] of Object.entries(kTypes)) {
    new Skill(space, skills, name, id);
  }
  await server.start();
  announce(server, port);
}

run(main);
