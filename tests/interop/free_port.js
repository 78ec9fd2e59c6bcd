'use strict';

const net = require('node:net');

/** A TCP port that nobody listens on at this moment; node-opcua takes 0 for 4840. */
function freePort() {
  return new Promise((resolve, reject) => {
    const probe = net.createServer().once('error', reject);
    probe.listen(0, '127.0.0.1', () => {
      const { port } = probe.address();
      probe.close(() => resolve(port));
    });
  });
}

module.exports = { freePort };
