// Starts a metier server as a user would, and ends it with the test.
'use strict';

const { spawn } = require('node:child_process');
const readline = require('node:readline');

const kReadyTimeoutMs = 30000;

/**
 * @param {string[]} args of the metier command
 * @returns {Promise<{url: string, stop: () => Promise<void>}>} once clients may connect
 */
function startServer(args) {
  const program = process.env.METIER;
  if (!program) {
    throw new Error('METIER must name the metier program');
  }
  const child = spawn(program, args, { stdio: ['ignore', 'pipe', 'inherit'] });
  const ended = new Promise((resolve) => child.once('exit', resolve));
  const stop = async () => {
    child.kill('SIGTERM');
    await ended;
  };
  return new Promise((resolve, reject) => {
    const timer = setTimeout(() => {
      child.kill('SIGKILL');
      reject(new Error(`no ready line within ${kReadyTimeoutMs} ms`));
    }, kReadyTimeoutMs);
    readline.createInterface({ input: child.stdout }).once('line', (line) => {
      clearTimeout(timer);
      const match = /^ready (opc\.tcp:\S+)$/.exec(line);
      return match ? resolve({ url: match[1], stop }) : reject(new Error(`unexpected: ${line}`));
    });
    child.once('error', reject);
    child.once('exit', (status) => reject(new Error(`ended with status ${status}`)));
  });
}

module.exports = { startServer };
