// An arm of another maker: a motion device of OPC 40010-1 and a position stream of the skill types
// that were published in 2019, with nothing of metier. It has no hardware and follows its set-points.
// Prints "ready URL" and runs until it is ended.
'use strict';

console.log = console.error;  // what node-opcua says; the standard output is for "ready URL"
const {
  DataType, OPCUAServer, StatusCodes, Variant, VariantArrayType, coerceNodeId, coerceQualifiedName,
  nodesets, standardUnits,
} = require('node-opcua');
const { freePort } = require('./free_port');
const { kMethodsWithoutSuspend: kMethods, kStates } = require('./program_states');
const { announce, run } = require('./server_program');

// As the server lists them, and as its arrays have them: not in the order of the arm.
const kStart = { wrist_3: 0, elbow: 1.75, base: 0, wrist_1: -2.02, shoulder: -1.3, wrist_2: -1.57 };
const kAxes = Object.keys(kStart);
const kLargestSpeed = 3.2;  // rad/s
const kTickMs = 4;


const text = (value) => ({ dataType: DataType.LocalizedText, value: { text: value } });
const number = (value) => new Variant({ dataType: DataType.Double, value });
const numbers = (values) => new Variant({
  dataType: DataType.Double, arrayType: VariantArrayType.Array, value: Float64Array.from(values),
});

/** Goes to its set-point as fast as it may. */
class Arm {
  constructor() {
    this.position = Object.values(kStart);
    this.target = [...this.position];
    this.follows = false;
    this.steps = [];  // largest step of an axis from each set-point to the next
    setInterval(() => this.tick(), kTickMs);
  }

  take(target) {
    if (this.follows) {
      this.steps.push(Math.max(...target.map((value, axis) => Math.abs(value - this.target[axis]))));
    }
    this.target = target;
  }

  tick() {
    const most = (kLargestSpeed * kTickMs) / 1000;
    if (this.follows) {
      this.position = this.position.map((value, axis) =>
        value + Math.max(-most, Math.min(most, this.target[axis] - value)));
    }
  }
}

/** The types of the published model that the arm needs, and one below: the stream's is abstract. */
function addTypes(space) {
  const device = space.registerNamespace('https://fortiss.org/UA/Device/');
  const robotics = space.registerNamespace('https://fortiss.org/UA/Robotics/');
  const skill = device.addObjectType({
    browseName: 'SkillType', subtypeOf: space.findObjectType('ProgramStateMachineType'), isAbstract: true,
  });
  const stream = robotics.addObjectType({
    browseName: 'PositionStreamSkillType', subtypeOf: skill, isAbstract: true,
  });
  return space.getOwnNamespace().addObjectType({ browseName: 'LabStreamSkillType', subtypeOf: stream });
}

/** Motion device, axes and safety state, below their system. */
function addRobot(space, arm) {
  const namespace = space.getOwnNamespace();
  const robotics = space.getNamespaceIndex('http://opcfoundation.org/UA/Robotics/');
  const di = space.getNamespaceIndex('http://opcfoundation.org/UA/DI/');
  const add = (parent, browseName, type) => namespace.addObject({
    browseName: coerceQualifiedName(/:/.test(browseName) ? browseName : `${namespace.index}:${browseName}`),
    componentOf: parent,
    typeDefinition: type ? space.findObjectType(`${robotics}:${type}`) : undefined,
  });
  const deviceSet = space.rootFolder.objects.getFolderElementByName('DeviceSet', di);
  const system = add(deviceSet, 'LabRobot', 'MotionDeviceSystemType');
  const device = add(add(system, `${robotics}:MotionDevices`), 'LabArm', 'MotionDeviceType');
  const axes = add(device, `${robotics}:Axes`);
  kAxes.forEach((name, index) => {
    const parameters = add(add(axes, name, 'AxisType'), `${di}:ParameterSet`);
    namespace.addAnalogDataItem({
      browseName: coerceQualifiedName(`${robotics}:ActualPosition`), componentOf: parameters, dataType: 'Double',
      engineeringUnits: standardUnits.degree, engineeringUnitsRange: { low: -360, high: 360 },
      minimumSamplingInterval: kTickMs,
      value: { get: () => number((arm.position[index] * 180) / Math.PI) },
    });
  });
  const safety = add(add(system, `${robotics}:SafetyStates`), 'Safety', 'SafetyStateType');
  const stops = add(safety, `${di}:ParameterSet`);
  for (const name of ['EmergencyStop', 'ProtectiveStop']) {
    namespace.addVariable({
      browseName: coerceQualifiedName(`${robotics}:${name}`), componentOf: stops, dataType: 'Boolean',
      value: { dataType: DataType.Boolean, value: false },
    });
  }
  const controller = add(add(system, `${robotics}:Controllers`), 'LabController', 'ControllerType');
  return add(controller, 'Skills');
}

/** The stream skill: a Program that ends by Halt alone. */
class StreamSkill {
  constructor(space, skills, type, arm) {
    this.space = space;
    this.arm = arm;
    this.state = 'Ready';
    const namespace = space.getOwnNamespace();
    this.object = namespace.addObject({
      browseName: 'PositionStreamSkill', componentOf: skills, typeDefinition: type, eventNotifier: 1,
      eventSourceOf: space.rootFolder.objects.server,
    });
    this.current = namespace.addVariable({
      browseName: coerceQualifiedName('0:CurrentState'), componentOf: this.object,
      dataType: 'LocalizedText', typeDefinition: 'FiniteStateVariableType',
    });
    this.id = namespace.addVariable({
      browseName: coerceQualifiedName('0:Id'), propertyOf: this.current, dataType: 'NodeId',
    });
    for (const method of Object.keys(kMethods)) {
      namespace
        .addMethod(this.object, { browseName: coerceQualifiedName(`0:${method}`), inputArguments: [] })
        .bindMethod((_inputs, _context, done) => done(null, { statusCode: this.call(method) }));
    }
    this.addTarget(namespace, namespace.addObject({ browseName: 'ParameterSet', componentOf: this.object }));
    this.show();
  }

  addTarget(namespace, parameters) {
    namespace.addVariable({
      browseName: 'TargetJointPosition', componentOf: parameters, dataType: 'Double',
      valueRank: 1, arrayDimensions: [kAxes.length], minimumSamplingInterval: kTickMs,
      value: {
        get: () => numbers(this.arm.target),
        set: (variant) => {
          if (variant.value.length !== kAxes.length) {
            return StatusCodes.BadOutOfRange;
          }
          this.arm.take(Array.from(variant.value));
          return StatusCodes.Good;
        },
      },
    });
    namespace.addVariable({
      browseName: 'Steps', componentOf: this.object, dataType: 'Double', valueRank: 1,
      minimumSamplingInterval: kTickMs, value: { get: () => numbers(this.arm.steps) },
    });
  }

  show() {
    this.current.setValueFromSource(text(this.state));
    this.id.setValueFromSource({
      dataType: DataType.NodeId, value: coerceNodeId(`ns=0;i=${kStates[this.state].id}`),
    });
  }

  /** @returns {import('node-opcua').StatusCode} */
  call(method) {
    const { from, to } = kMethods[method];
    if (!from.includes(this.state)) {
      return StatusCodes.BadInvalidState;
    }
    const before = this.state;
    this.state = to;
    this.arm.follows = to === 'Running';
    this.arm.steps = to === 'Running' ? [] : this.arm.steps;
    this.show();
    this.object.raiseEvent('TransitionEventType', {
      message: text(`${method} was called`), severity: { dataType: DataType.UInt16, value: 100 },
      transition: text(`${before}To${to}`), fromState: text(before), toState: text(to),
    });
    return StatusCodes.Good;
  }
}

async function main() {
  const port = await freePort();
  const server = new OPCUAServer({
    port, allowAnonymous: true,
    nodeset_filename: [nodesets.standard, nodesets.di, nodesets.robotics],
  });
  await server.initialize();
  const space = server.engine.addressSpace;
  const arm = new Arm();
  const type = addTypes(space);
  const skill = new StreamSkill(space, addRobot(space, arm), type, arm);
  await server.start();
  announce(server, port);
}

run(main);
