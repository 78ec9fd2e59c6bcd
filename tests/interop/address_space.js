// Views of a client of another maker on the address space of a server.
'use strict';

const assert = require('node:assert');
const {
  AttributeIds, BrowseDirection, MessageSecurityMode, NodeClass, OPCUAClient, SecurityPolicy, StatusCodes,
} = require('node-opcua');

/** A session that needs no certificate; `close()` ends it and its connection. */
async function connect(url) {
  const client = OPCUAClient.create({
    endpointMustExist: false, securityMode: MessageSecurityMode.None, securityPolicy: SecurityPolicy.None });
  await client.connect(url);
  const session = await client.createSession();
  return { session, close: async () => { await session.close(); await client.disconnect(); } };
}

async function browse(session, nodeId, referenceTypeId, browseDirection = BrowseDirection.Forward) {
  const result = await session.browse({
    nodeId, referenceTypeId, browseDirection, includeSubtypes: true, nodeClassMask: 0, resultMask: 63 });
  assert.strictEqual(result.statusCode, StatusCodes.Good);
  return result.references;
}

function children(session, nodeId) {
  return browse(session, nodeId, 'HierarchicalReferences');
}

/** The node at the end of a path of BrowseNames, whatever their namespaces: "Options/Width". */
async function find(session, nodeId, path) {
  let found = nodeId;
  for (const name of path.split('/')) {
    const child = (await children(session, found)).find((each) => each.browseName.name === name);
    assert.ok(child, `no ${name} of ${path} below ${nodeId}`);
    found = child.nodeId;
  }
  return found;
}

async function read(session, nodeId, attributeId = AttributeIds.Value) {
  const value = await session.read({ nodeId, attributeId });
  assert.strictEqual(value.statusCode, StatusCodes.Good, `${nodeId}, attribute ${attributeId}`);
  return value.value.value;
}

/** Whether a type is another one or below it; ids as text. */
async function isA(session, type, base) {
  for (let each = type; each; ) {
    if (each.toString() === base) {
      return true;
    }
    each = (await browse(session, each, 'HasSubtype', BrowseDirection.Inverse))[0]?.nodeId;
  }
  return false;
}

/** Every reference to an Object or a Method below a node, once, with the node above it. */
async function everythingBelow(session, nodeId) {
  const found = [];
  const seen = new Set();
  for (const open = [nodeId]; open.length > 0; ) {
    const above = open.pop();
    for (const child of await children(session, above)) {
      const isNew = !seen.has(child.nodeId.toString());
      if (child.nodeClass === NodeClass.Method || (child.nodeClass === NodeClass.Object && isNew)) {
        found.push({ ...child, above });
      }
      if (child.nodeClass === NodeClass.Object && isNew) {
        seen.add(child.nodeId.toString());
        open.push(child.nodeId);
      }
    }
  }
  return found;
}

module.exports = { browse, children, connect, everythingBelow, find, isA, read };
