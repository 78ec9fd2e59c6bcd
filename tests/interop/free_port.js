'use strict';

const net = require('node:net');

// Below the ports that the system hands out: nobody else gets it until its server listens.
const kFirst = 28000;
const kPorts = 4000;

/** Whether nobody listens there. @param {number} port */
function isFree(port) {
  return new Promise((resolve) => {
    const probe = net.createServer().once('error', () => resolve(false));
    probe.listen(port, '127.0.0.1', () => probe.close(() => resolve(true)));
  });
}

/** A TCP port that nobody listens on; node-opcua takes 0 for 4840. */
async function freePort() {
  for (let attempt = 0; attempt < kPorts; attempt += 1) {
    const port = kFirst + (process.pid * 7 + attempt) % kPorts;
    if (await isFree(port)) {
      return port;
    }
  }
  throw new Error(`no free port from ${kFirst} to ${kFirst + kPorts}`);
}

module.exports = { freePort };
