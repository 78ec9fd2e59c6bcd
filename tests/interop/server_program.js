// Beginning and end of a program that is a server of another maker (node-opcua).
'use strict';

/**
 * Prints "ready URL", and lets SIGTERM end the server in order.
 * @param server of node-opcua, started
 * @param {number} port on which it serves
 */
function announce(server, port) {
  process.once('SIGTERM', () => server.shutdown(() => process.exit(0)));
  process.stdout.write(`ready opc.tcp://127.0.0.1:${port}\n`);
}

/**
 * Runs the program; an error ends it with status 1 and is printed.
 * @param {() => Promise<void>} main
 */
function run(main) {
  main().catch((error) => {
    process.stderr.write(`${error.stack}\n`);
    process.exit(1);
  });
}

module.exports = { announce, run };
