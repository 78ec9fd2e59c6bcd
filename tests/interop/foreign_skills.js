// A server of another maker with Programs (OPC 10000-10) that know nothing of metier: no StartWith,
// no Check, no lease, no ExecutionId. Prints "ready URL" and runs until it is ended.
// With --without-subscriptions it refuses each of them.
'use strict';

console.log = console.error;  // what node-opcua says; the standard output is for "ready URL"
const {
  DataType, OPCUAServer, StatusCodes, VariantArrayType, coerceNodeId, coerceQualifiedName,
} = require('node-opcua');
const { kShapes } = require('./foreign_shapes');
const { freePort } = require('./free_port');
const { kStates } = require('./program_states');
const { announce, run } = require('./server_program');

const kTransitions = {
  HaltedToReady: { id: 2408, number: 1 },
  ReadyToRunning: { id: 2410, number: 2 },
  RunningToHalted: { id: 2412, number: 3 },
  RunningToReady: { id: 2414, number: 4 },
  RunningToSuspended: { id: 2416, number: 5 },
  SuspendedToRunning: { id: 2418, number: 6 },
  SuspendedToHalted: { id: 2420, number: 7 },
  SuspendedToReady: { id: 2422, number: 8 },
  ReadyToHalted: { id: 2424, number: 9 },
};

const kPattern = new Float64Array([0.5, 0.25]);

const nodeId = (id) => ({ dataType: DataType.NodeId, value: coerceNodeId(`ns=0;i=${id}`) });
const number = (value) => ({ dataType: DataType.UInt32, value });
const text = (value) => ({ dataType: DataType.LocalizedText, value: { text: value } });

/** One Program of a shape. */
class ForeignProgram {
  /** @param {import('./foreign_shapes').Shape} shape */
  constructor(space, parent, shape) {
    this.space = space;
    this.shape = shape;
    this.state = 'Ready';
    this.count = 0;
    const namespace = space.getOwnNamespace();
    this.object = namespace.addObject({
      browseName: shape.name,
      componentOf: parent,
      typeDefinition: space.findObjectType('ProgramStateMachineType'),
      eventSourceOf: shape.event ? space.rootFolder.objects.server : undefined,
      eventNotifier: shape.event ? 1 : 0,
    });
    this.current = this.addStateVariable('CurrentState', 'FiniteStateVariableType');
    this.last = shape.lasts ? null : this.addStateVariable('LastTransition', 'FiniteTransitionVariableType');
    for (const method of shape.methods) {
      namespace
        .addMethod(this.object, { browseName: coerceQualifiedName(`${shape.namespace ?? 0}:${method}`), inputArguments: [] })
        .bindMethod((_inputs, _context, done) => done(null, { statusCode: this.call(method) }));
    }
    if (!shape.lasts) {
      this.addFields();
    }
    this.show();
  }

  addFields() {
    this.duration = this.addField('ParameterSet', 'Duration', DataType.Double, 0.05);
    this.fails = this.addField('ParameterSet', 'Fails', DataType.Boolean, false);
    this.level = this.addField('ParameterSet', 'Level', DataType.Float, 0.5);
    this.result = this.addField('FinalResultData', 'Count', DataType.UInt32, 0);
    this.note = this.addField('FinalResultData', 'Note', DataType.LocalizedText, { text: '' });
    if (this.shape.rank) {
      this.pattern = this.addField('ParameterSet', 'Pattern', DataType.Double, kPattern, VariantArrayType.Array);
      this.echo = this.addField('FinalResultData', 'Echo', DataType.Double, kPattern, VariantArrayType.Array);
    }
  }

  addStateVariable(name, type) {
    const namespace = this.space.getOwnNamespace();
    const variable = namespace.addVariable({
      browseName: coerceQualifiedName(`0:${name}`),
      componentOf: this.object,
      dataType: 'LocalizedText',
      typeDefinition: type,
    });
    const property = (propertyName, dataType) =>
      namespace.addVariable({
        browseName: coerceQualifiedName(`0:${propertyName}`),
        propertyOf: variable,
        dataType,
      });
    return {
      variable,
      id: this.shape.ids ? property('Id', 'NodeId') : null,
      number: this.shape.numbers ? property('Number', 'UInt32') : null,
    };
  }

  addField(folder, name, dataType, value, arrayType = VariantArrayType.Scalar) {
    const namespace = this.space.getOwnNamespace();
    const parent =
      this.object.getComponentByName(folder) ??
      namespace.addObject({ browseName: folder, componentOf: this.object });
    return namespace.addVariable({
      browseName: name,
      componentOf: parent,
      dataType,
      valueRank: this.shape.rank ?? -1,
      minimumSamplingInterval: 10,
      value: { dataType, arrayType, value },
    });
  }

  setStateVariable({ variable, id, number: property }, name, known) {
    variable.setValueFromSource(text(name));
    id?.setValueFromSource(nodeId(known.id));
    property?.setValueFromSource(number(known.number));
  }

  show() {
    this.setStateVariable(this.current, this.state, kStates[this.state]);
  }

  /** @returns {import('node-opcua').StatusCode} */
  call(method) {
    const possible = {
      Start: ['Ready', 'Running'],
      Suspend: ['Running', 'Suspended'],
      Resume: ['Suspended', 'Running'],
      Halt: [this.state === 'Halted' ? 'none' : this.state, 'Halted'],
      Reset: ['Halted', 'Ready'],
    }[method];
    if (this.state !== possible[0]) {
      return StatusCodes.BadInvalidState;
    }
    clearTimeout(this.timer);
    this.go(possible[1], method);
    if (this.state === 'Running') {
      const seconds = this.shape.lasts ?? this.duration.readValue().value.value;
      this.timer = setTimeout(() => this.end(), 1000 * seconds);
    }
    return StatusCodes.Good;
  }

  end() {
    if (this.fails?.readValue().value.value) {
      this.go('Halted', 'the lamp is broken');
      return;
    }
    this.count += 1;
    this.result?.setValueFromSource({ dataType: DataType.UInt32, value: this.count });
    this.echo?.setValueFromSource(this.pattern.readValue().value);
    this.note?.setValueFromSource(text(`level ${this.level.readValue().value.value}`));
    this.go('Ready', 'done');
  }

  go(to, message) {
    const from = this.state;
    const transition = `${from}To${to}`;
    this.state = to;
    this.show();
    if (this.last) {
      this.setStateVariable(this.last, transition, kTransitions[transition]);
    }
    if (this.shape.event) {
      this.object.raiseEvent(this.shape.event, this.fieldsOf(transition, from, to, message));
    }
  }

  fieldsOf(transition, from, to, message) {
    const fields = {
      message: text(message),
      severity: { dataType: DataType.UInt16, value: 100 },
      transition: text(transition),
      fromState: text(from),
      toState: text(to),
    };
    if (this.shape.ids) {
      fields['transition.id'] = nodeId(kTransitions[transition].id);
      fields['fromState.id'] = nodeId(kStates[from].id);
      fields['toState.id'] = nodeId(kStates[to].id);
    }
    return fields;
  }
}

async function main() {
  const port = await freePort();
  const server = new OPCUAServer({ port, allowAnonymous: true });
  await server.initialize();
  if (process.argv.includes('--without-subscriptions')) {
    server.engine.serverCapabilities.maxSubscriptions = 0;
  }
  const space = server.engine.addressSpace;
  const namespace = space.getOwnNamespace();
  const lamp = namespace.addObject({ browseName: 'Lamp', organizedBy: space.rootFolder.objects });
  const skills = namespace.addObject({ browseName: 'Skills', componentOf: lamp });
  kShapes.forEach((shape) => new ForeignProgram(space, skills, shape));
  await server.start();
  announce(server, port);
}

run(main);
