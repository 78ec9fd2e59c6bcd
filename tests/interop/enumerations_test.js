// Enumerations of a server in the eyes of another maker's client, which knows their names by the
// attribute DataTypeDefinition (OPC UA 1.04) and not by dictionaries.
'use strict';

const assert = require('node:assert');
const fs = require('node:fs');
const os = require('node:os');
const path = require('node:path');
const { after, before, test } = require('node:test');
const { AttributeIds, BrowseDirection, resolveNodeId } = require('node-opcua');
const { getExtraDataTypeManager, promoteOpaqueStructure } = require('node-opcua-client-dynamic-extension-object');
const { EnumDefinition } = require('node-opcua-types');
const { browse, children, connect, find, read } = require('./address_space');
const { startServer } = require('./metier_process');

const kOwn = ['https://fortiss.org/UA/Device/', 'https://fortiss.org/UA/Robotics/', 'urn:metier:skills'];
const kParts = 'urn:example:parts';

// A structure with an enumeration in it, which a client takes apart only if it knows both.
const kNodeset = `<?xml version="1.0" encoding="utf-8"?>
<UANodeSet xmlns="http://opcfoundation.org/UA/2011/03/UANodeSet.xsd">
<NamespaceUris><Uri>${kParts}</Uri></NamespaceUris>
<Models><Model ModelUri="${kParts}" Version="1.0.0" PublicationDate="2026-01-01T00:00:00Z"/></Models>
<UADataType NodeId="ns=1;i=1" BrowseName="1:PartKind"><DisplayName>PartKind</DisplayName><References>
  <Reference ReferenceType="i=45" IsForward="false">i=29</Reference></References>
  <Definition Name="1:PartKind"><Field Name="Bolt" Value="0"/><Field Name="Plate" Value="3"/></Definition></UADataType>
<UADataType NodeId="ns=1;i=2" BrowseName="1:Part"><DisplayName>Part</DisplayName><References>
  <Reference ReferenceType="i=45" IsForward="false">i=22</Reference>
  <Reference ReferenceType="i=38">ns=1;i=3</Reference><Reference ReferenceType="i=38">ns=1;i=4</Reference></References>
  <Definition Name="1:Part"><Field Name="Kind" DataType="ns=1;i=1"/><Field Name="Mass" DataType="i=11"/></Definition></UADataType>
<UAObject NodeId="ns=1;i=3" BrowseName="Default Binary" SymbolicName="DefaultBinary"><References>
  <Reference ReferenceType="i=40">i=76</Reference></References></UAObject>
<UAObject NodeId="ns=1;i=4" BrowseName="Default XML" SymbolicName="DefaultXml"><References>
  <Reference ReferenceType="i=40">i=76</Reference></References></UAObject>
<UAVariable NodeId="ns=1;i=5" BrowseName="1:NextPart" DataType="ns=1;i=2"><DisplayName>NextPart</DisplayName><References>
  <Reference ReferenceType="i=35" IsForward="false">i=85</Reference><Reference ReferenceType="i=40">i=63</Reference></References>
  <Value><ExtensionObject xmlns="http://opcfoundation.org/UA/2008/02/Types.xsd"><TypeId><Identifier>ns=1;i=4</Identifier></TypeId>
  <Body><Part xmlns="${kParts}"><Kind>Plate_3</Kind><Mass>1.5</Mass></Part></Body></ExtensionObject></Value></UAVariable>
</UANodeSet>
`;

let folder;
let server;
let session;
let close;

before(async () => {
  folder = fs.mkdtempSync(path.join(os.tmpdir(), 'enumerations-'));
  fs.writeFileSync(path.join(folder, 'parts.xml'), kNodeset);
  const model = path.join(__dirname, '..', '..', 'models', 'iiwa7.toml');
  fs.writeFileSync(path.join(folder, 'cell.toml'), `name = "enumerations"
[[server]]
name = "arm"
kind = "arm"
driver = { type = "simulator" }
model = ${JSON.stringify(model)}
nodeset = "iiwa"
nodesets = ["parts.xml"]
stall_limit = 2.0
skills = ["CartesianPtpMoveSkill", "CartesianLinearMoveSkill", "JointPtpMoveSkill", "JointLinearMoveSkill"]
`);
  server = await startServer(['serve', path.join(folder, 'cell.toml'), '--server', 'arm', '--port', '0']);
  ({ session, close } = await connect(server.url));
});

after(async () => {
  await close?.();
  await server?.stop();
  fs.rmSync(folder, { recursive: true, force: true });
});

/** All enumerations of the server below a type, by their names. */
async function enumerations(type = resolveNodeId('Enumeration')) {
  const found = [];
  for (const below of await browse(session, type, 'HasSubtype')) {
    found.push(below, ...await enumerations(below.nodeId));
  }
  return found;
}

/** Names and numbers of an EnumDefinition; an Int64 is two words. */
function namesOf(definition) {
  assert.ok(definition instanceof EnumDefinition);
  return definition.fields.map((field) => [field.name, field.value[1]]);
}

test('every enumeration of metier has a definition, with the names of its EnumStrings', async () => {
  const namespaces = await session.readNamespaceArray();
  const own = (await enumerations()).filter((each) => kOwn.includes(namespaces[each.nodeId.namespace]));
  const names = own.map((each) => each.browseName.name);
  for (const name of ['SkillTransitionReason', 'GripTypeEnumeration', 'SafetyStateKind', 'RelativeMode']) {
    assert.ok(names.includes(name), name);
  }
  for (const { nodeId, browseName } of own) {
    const definition = await read(session, nodeId, AttributeIds.DataTypeDefinition);
    const strings = (await children(session, nodeId)).find((each) => each.browseName.name === 'EnumStrings');
    const texts = await read(session, strings.nodeId);
    assert.deepStrictEqual(namesOf(definition), texts.map(({ text }, i) => [text, i]), browseName.name);
  }
});

test('so have those of OPC Robotics and of OPC UA itself', async () => {
  const all = await enumerations();
  const named = (name) => all.find((each) => each.browseName.name === name).nodeId;
  const mode = await read(session, named('OperationalModeEnumeration'), AttributeIds.DataTypeDefinition);
  assert.deepStrictEqual(namesOf(mode).slice(0, 2), [['OTHER', 0], ['MANUAL_REDUCED_SPEED', 1]]);
  const state = await read(session, named('ServerState'), AttributeIds.DataTypeDefinition);
  assert.deepStrictEqual(namesOf(state)[0], ['Running', 0]);
});

test('a structure with an enumeration in it is taken apart by its definitions', async () => {
  const index = (await session.readNamespaceArray()).indexOf(kParts);
  const nodeId = `ns=${index};i=5`;
  const value = await session.read({ nodeId, attributeId: AttributeIds.Value });
  await promoteOpaqueStructure(session, [value]);
  assert.strictEqual(value.value.value.mass, 1.5);
  assert.strictEqual(value.value.value.kind, 3);
  const types = (await getExtraDataTypeManager(session)).getDataTypeFactory(index);
  const kind = types.getEnumeration('PartKind');
  assert.deepStrictEqual({ ...kind.enumValues }, { Bolt: 0, Plate: 3 });
});

test('a value of an enumeration is named by the definition of its data type', async () => {
  const device = await find(session, resolveNodeId('ObjectsFolder'), 'DeviceSet/IiwaSystem/MotionDevices/Iiwa');
  const category = await find(session, device, 'MotionDeviceCategory');
  const dataType = await read(session, category, AttributeIds.DataType);
  const fields = namesOf(await read(session, dataType, AttributeIds.DataTypeDefinition));
  const value = await read(session, category);
  assert.strictEqual(fields.find(([, number]) => number === value)[0], 'ARTICULATED_ROBOT');
  const above = await browse(session, dataType, 'HasSubtype', BrowseDirection.Inverse);
  assert.strictEqual(above[0].browseName.name, 'Enumeration');
});
