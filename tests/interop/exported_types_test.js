// Skill types that `metier types export` writes, in the address space of another maker: node-opcua
// loads them, and makes instances of them with all mandatory children; open62541's compiler takes
// them. A server that declares them itself is found by their properties.
'use strict';

const assert = require('node:assert');
const { execFileSync } = require('node:child_process');
const fs = require('node:fs');
const os = require('node:os');
const path = require('node:path');
const { after, test } = require('node:test');
const { runMetier, serve } = require('./metier_process');

const { AddressSpace, coerceLocalizedText } = require('node-opcua');
const { generateAddressSpace } = require('node-opcua-address-space/nodeJS');
const { nodesets } = require('node-opcua-nodesets');

const kUri = 'urn:example:welding';
const kTypes = path.join(__dirname, 'welding.toml');
const kTools = process.env.OPEN62541_TOOLS;
const kOwn = path.join(__dirname, '..', '..', 'nodesets');
const kDirectory = fs.mkdtempSync(path.join(os.tmpdir(), 'metier-types-'));

after(() => fs.rmSync(kDirectory, { recursive: true, force: true }));

/** The file of the NodeSet of welding.toml. */
async function exportTypes() {
  const { status, output, errors } = await runMetier(['types', 'export', kTypes]);
  assert.strictEqual(status, 0, errors);
  const file = path.join(kDirectory, 'Welding.NodeSet2.xml');
  fs.writeFileSync(file, output);
  return file;
}

/** An address space with that NodeSet. */
async function load() {
  const file = await exportTypes();
  const addressSpace = AddressSpace.create();
  addressSpace.registerNamespace('urn:test:own');
  await generateAddressSpace(addressSpace, [
    nodesets.standard, nodesets.di, nodesets.robotics,
    ...['device', 'robotics', 'metier'].map((name) => path.join(kOwn, name, 'NodeSet2.xml')), file,
  ]);
  return { addressSpace, index: addressSpace.getNamespaceIndex(kUri) };
}

test('exported skill types are loaded by node-opcua', async () => {
  const { addressSpace, index } = await load();
  const type = addressSpace.findObjectType('SpotWeldSkillType', index);
  assert.ok(type, 'the type is there');
  assert.strictEqual(type.nodeId.toString(), `ns=${index};s=SpotWeldSkillType`);
  assert.strictEqual(type.subtypeOfObj.browseName.name, 'SkillType');
  assert.strictEqual(type.description.text, 'Welds one spot.');
  const force = addressSpace.findNode(`ns=${index};s=SpotWeldSkillType/ParameterSet/Force`);
  assert.strictEqual(force.modellingRule, 'Mandatory');
  assert.strictEqual(force.typeDefinitionObj.browseName.name, 'AnalogUnitRangeType');
  const range = force.getPropertyByName('EURange').readValue().value.value;
  assert.strictEqual(range.low, 0);
  assert.strictEqual(range.high, 5000);
  assert.strictEqual(force.getPropertyByName('EngineeringUnits').readValue().value.value.displayName.text, 'N');
  const frequency = addressSpace.findNode(`ns=${index};s=SpotWeldSkillType/ControlFrequency`);
  assert.strictEqual(frequency.readValue().value.value, 125);
  const entries = type.findReferencesAsObject('HasDictionaryEntry', true);
  assert.deepStrictEqual(entries.map((entry) => entry.browseName.name), ['urn:metier:dictionary:weld']);
  const careful = addressSpace.findObjectType('CarefulMoveSkillType', index);
  assert.strictEqual(careful.subtypeOfObj.browseName.name, 'JointPtpMoveSkillType');
  const accuracy = addressSpace.findNode(`ns=${index};s=JointPtpMoveSkillType/Accuracy`);
  assert.strictEqual(accuracy.parent.browseName.name, 'JointPtpMoveSkillType');
  addressSpace.dispose();
});

test('node-opcua makes skills of an exported type with their mandatory children', async () => {
  const { addressSpace } = await load();
  const type = addressSpace.findObjectType('SpotWeldSkillType', addressSpace.getNamespaceIndex(kUri));
  const skill = type.instantiate({
    browseName: 'Weld', displayName: coerceLocalizedText('Weld'),
    organizedBy: addressSpace.rootFolder.objects,
  });
  const parameters = skill.getComponentByName('ParameterSet');
  assert.ok(parameters.getComponentByName('Force'), 'Force is there');
  assert.ok(skill.getComponentByName('FinalResultData').getComponentByName('Duration'), 'Duration is there');
  assert.ok(skill.getComponentByName('ControlFrequency'), 'ControlFrequency is there');
  addressSpace.dispose();
});

test('mistakes of a file of types are named with their lines', async () => {
  const file = path.join(kDirectory, 'wrong.toml');
  fs.writeFileSync(file, 'namespace = "urn:a"\n[[type]]\nname = "T"\nbse = "SkillType"\n');
  const { status, errors } = await runMetier(['types', 'export', file]);
  assert.notStrictEqual(status, 0);
  assert.match(errors, /wrong\.toml:4: .*bse/);
});

test('exported skill types are taken by the compiler of open62541', { skip: !kTools && 'OPEN62541_TOOLS is not set' },
  async () => {
    const code = path.join(kDirectory, 'namespace_welding');
    const needed = [
      path.join(process.env.OPEN62541_SCHEMA, 'Opc.Ua.NodeSet2.xml'), nodesets.di, nodesets.robotics,
      ...['device', 'robotics', 'metier'].map((name) => path.join(kOwn, name, 'NodeSet2.xml')),
    ];
    execFileSync('python3', [
      path.join(kTools, 'nodeset_compiler', 'nodeset_compiler.py'),
      ...needed.map((file) => `--existing=${file}`), `--xml=${await exportTypes()}`,
      ...['', '_DI', '_ROB', '_DEVICE', '_METIER'].map((array) => `--types-array=UA_TYPES${array}`), code,
    ], { stdio: 'inherit' });
    const made = fs.readFileSync(`${code}.c`, 'utf8');
    for (const name of ['SpotWeldSkillType', 'CarefulMoveSkillType', 'Force', 'ControlFrequency']) {
      assert.match(made, new RegExp(`"${name}"`));
    }
  });

test('find asks for the properties that a server declares for a type', async () => {
  const arm = await serve(kDirectory, 'arm', [
    'driver = { type = "simulator" }', `model = "${path.join(__dirname, '..', '..', 'models', 'ur5.toml')}"`,
    'skills = ["JointPtpMoveSkill", "CartesianPtpMoveSkill"]', `types = ["${kTypes}"]`,
  ]);
  try {
    const find = (type, wish) => runMetier(['find', type, '--at', arm.url, '--property', wish]);
    const accurate = await find('JointPtpMoveSkillType', 'Accuracy<=0.001');
    assert.strictEqual(accurate.status, 0, accurate.output);
    assert.match(accurate.output, /JointPtpMoveSkill fits: .*Accuracy/);
    assert.strictEqual((await find('JointPtpMoveSkillType', 'Accuracy<=0.00001')).status, 1);
    assert.strictEqual((await find('CartesianPtpMoveSkillType', 'Accuracy<=0.001')).status, 1);
  } finally {
    await arm.stop();
  }
});
