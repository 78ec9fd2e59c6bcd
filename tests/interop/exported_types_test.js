// Skill types that `metier types export` writes, in the address space of another maker: node-opcua
// loads them, and makes instances of them with all mandatory children.
'use strict';

const assert = require('node:assert');
const fs = require('node:fs');
const os = require('node:os');
const path = require('node:path');
const { after, test } = require('node:test');
const { runMetier } = require('./metier_process');

const { AddressSpace, coerceLocalizedText } = require('node-opcua');
const { generateAddressSpace } = require('node-opcua-address-space/nodeJS');
const { nodesets } = require('node-opcua-nodesets');

const kUri = 'urn:example:welding';
const kOwn = path.join(__dirname, '..', '..', 'nodesets');
const kDirectory = fs.mkdtempSync(path.join(os.tmpdir(), 'metier-types-'));

after(() => fs.rmSync(kDirectory, { recursive: true, force: true }));

/** The NodeSet of welding.toml and an address space with it. */
async function load() {
  const { status, output, errors } = await runMetier(['types', 'export', path.join(__dirname, 'welding.toml')]);
  assert.strictEqual(status, 0, errors);
  const file = path.join(kDirectory, 'Welding.NodeSet2.xml');
  fs.writeFileSync(file, output);
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
