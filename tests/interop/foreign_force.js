// A force sensor of another maker: one Variable with three numbers that any client may write.
// Prints "ready URL" and runs until it is ended.
'use strict';

console.log = console.error;  // what node-opcua says; the standard output is for "ready URL"
const { DataType, OPCUAServer, VariantArrayType, standardUnits } = require('node-opcua');
const { freePort } = require('./free_port');
const { announce, run } = require('./server_program');

const kFastestMs = 5;

async function main() {
  const port = await freePort();
  const server = new OPCUAServer({ port, hostname: '127.0.0.1', allowAnonymous: true });
  await server.initialize();
  const space = server.engine.addressSpace;
  const namespace = space.registerNamespace('urn:lab:force');
  const sensor = namespace.addObject({ browseName: 'Sensor', organizedBy: space.rootFolder.objects });
  const add = (browseName, engineeringUnits) => namespace.addAnalogDataItem({
    browseName,
    nodeId: `s=${browseName}`,
    componentOf: sensor,
    dataType: DataType.Double,
    valueRank: 1,
    arrayDimensions: [3],
    engineeringUnits,
    engineeringUnitsRange: { low: -1000, high: 1000 },
    minimumSamplingInterval: kFastestMs,
    value: { dataType: DataType.Double, arrayType: VariantArrayType.Array, value: new Float64Array(3) },
  });
  add('Force', standardUnits.newton);
  add('Distance', standardUnits.metre);
  await server.start();
  announce(server, port);
}

run(main);
