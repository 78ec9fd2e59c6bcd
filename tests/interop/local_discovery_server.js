// node-opcua's Local Discovery Server, as a process of its own: prints "ready URL" and runs until it
// is killed or told to end.
//
//   node local_discovery_server.js DIRECTORY [PORT]
//
// DIRECTORY is where it keeps its certificates; PORT 0, the default, is a free one. It takes
// registrations without security, and also tells of servers by mDNS: node-opcua has no switch for
// that, and nothing here needs it.
'use strict';

const path = require('node:path');
const { MessageSecurityMode, OPCUACertificateManager, OPCUADiscoveryServer, SecurityPolicy } = require('node-opcua');
const { freePort } = require('./free_port');
const { announce, run } = require('./server_program');

async function main() {
  const [directory, given = '0'] = process.argv.slice(2);
  const port = given === '0' ? await freePort() : Number(given);
  const lds = new OPCUADiscoveryServer({
    port,
    hostname: '127.0.0.1',
    serverCertificateManager: new OPCUACertificateManager({
      rootFolder: path.join(directory, 'pki'), automaticallyAcceptUnknownCertificate: true }),
    securityPolicies: [SecurityPolicy.None],
    securityModes: [MessageSecurityMode.None],
  });
  await lds.start();
  announce(lds, port);
}

run(main);
