// Starts processes as a user would, and ends them with the test.
'use strict';

const { execFile, spawn } = require('node:child_process');
const fs = require('node:fs');
const os = require('node:os');
const path = require('node:path');
const readline = require('node:readline');

const kReadyTimeoutMs = 60000;
const kRunTimeoutMs = 60000;
const kUntilTimeoutMs = 30000;
const kBetweenQuestionsMs = 20;
const kLab = ['--insecure-lab'];

// Records and other state of the programs that a test starts.
const stateFolder = fs.mkdtempSync(path.join(os.tmpdir(), 'metier_state_'));
process.env.XDG_STATE_HOME = stateFolder;
const children = new Set();
process.on('exit', () => {
  children.forEach((child) => child.kill('SIGKILL'));
  fs.rmSync(stateFolder, { recursive: true, force: true });
});

function metierProgram() {
  const program = process.env.METIER;
  if (!program) {
    throw new Error('METIER must name the metier program');
  }
  return program;
}

/** @returns {Promise<void>} until the child has ended; with this program it ends in any case */
function awaitExit(child) {
  children.add(child);
  return new Promise((resolve) => child.once('exit', resolve)).then(() => children.delete(child));
}

/** A test that fails before it ends the child fails at once, and not when ctest loses patience. */
function doNotWaitFor(child) {
  [child, child.stdout, child.stderr].forEach((one) => one.unref());
}

function waitFor(child) {
  [child, child.stdout, child.stderr].forEach((one) => one.ref());
}

/**
 * @typedef {{url: string, stop: () => Promise<void>, kill: () => Promise<void>, log: () => string}}
 *     Running stop() lets it end in order, kill() does not; both wait until it has ended. log() is
 *     what it has said on its standard error so far
 */

/**
 * @param {string} program that prints "ready URL"
 * @param {string[]} args
 * @returns {Promise<Running>} once clients may connect
 */
function startProcess(program, args) {
  const child = spawn(program, args, { stdio: ['ignore', 'pipe', 'pipe'] });
  let log = '';
  child.stderr.setEncoding('utf8').on('data', (text) => {
    log += text;
    process.stderr.write(text);
  });
  const ended = awaitExit(child);
  const end = (signal) => async () => {
    waitFor(child);
    child.kill(signal);
    await ended;
  };
  return new Promise((resolve, reject) => {
    const timer = setTimeout(() => {
      child.kill('SIGKILL');
      reject(new Error(`no ready line within ${kReadyTimeoutMs} ms`));
    }, kReadyTimeoutMs);
    readline.createInterface({ input: child.stdout }).once('line', (line) => {
      clearTimeout(timer);
      doNotWaitFor(child);
      const match = /^ready ((?:opc\.tcp|http):\S+)$/.exec(line);
      return match
        ? resolve({ url: match[1], stop: end('SIGTERM'), kill: end('SIGKILL'), log: () => log })
        : reject(new Error(`unexpected: ${line}`));
    });
    child.once('error', reject);
    child.once('exit', (status) => reject(new Error(`ended with status ${status}`)));
  });
}

/**
 * @param {string[]} args of the metier command
 * @param {string[]} security options of metier on security
 * @returns {Promise<Running>}
 */
function startServer(args, security = kLab) {
  return startProcess(metierProgram(), [...security, ...args]);
}

/**
 * Writes a cell file with one server, which has the name of its kind.
 *
 * @param {string} folder
 * @param {string} kind
 * @param {string[]} lines of the server besides its name and kind
 * @returns {string} the file
 */
function writeCell(folder, kind, lines) {
  const file = path.join(folder, `cell${fs.readdirSync(folder).length}.toml`);
  fs.writeFileSync(file, ['name = "cell"', '[[server]]', `name = "${kind}"`, `kind = "${kind}"`, ...lines, ''].join('\n'));
  return file;
}

/** Starts the server of a cell file that it writes, as writeCell(). @returns {Promise<Running>} */
function serve(folder, kind, lines) {
  return startServer(['serve', writeCell(folder, kind, lines), '--server', kind, '--port', '0']);
}

/**
 * @param {string[]} args of a metier command that ends by itself
 * @param {string[]} security options of metier on security
 * @returns {Promise<{status: number, output: string, errors: string}>} its exit status and what it
 *     printed
 */
function runMetier(args, security = kLab) {
  return new Promise((resolve, reject) => {
    const child = execFile(metierProgram(), [...security, ...args], { timeout: kRunTimeoutMs }, (error, output, errors) => {
      if (error && typeof error.code !== 'number') {
        reject(error);
        return;
      }
      resolve({ status: error ? error.code : 0, output, errors });
    });
    awaitExit(child);
  });
}

/**
 * Starts a metier command that goes on for a while.
 *
 * @param {string[]} args
 * @param {RegExp} begun is in the line that it prints, to either output, once it is under way
 * @returns {Promise<{end: Promise<{status: number, output: string}>, interrupt: () => void,
 *     kill: () => void}>} once that line is there; `end` has all that it printed; interrupt() is
 *     Ctrl-C, kill() is kill -9
 */
function startMetier(args, begun) {
  const child = spawn(metierProgram(), [...kLab, ...args], { stdio: ['ignore', 'pipe', 'pipe'] });
  awaitExit(child);
  let output = '';
  let waiting = true;  // for what has begun
  const closed = new Promise((resolve) => child.once('close', (status) => resolve({ status, output })));
  return new Promise((resolve, reject) => {
    const timer = setTimeout(() => {
      child.kill('SIGKILL');
      reject(new Error(`no ${begun} within ${kReadyTimeoutMs} ms: ${output}`));
    }, kReadyTimeoutMs);
    for (const stream of [child.stdout, child.stderr]) {
      stream.setEncoding('utf8').on('data', (text) => {
        output += text;
        if (waiting && begun.test(output)) {
          waiting = false;
          clearTimeout(timer);
          doNotWaitFor(child);
          resolve({
            get end() {
              waitFor(child);
              return closed;
            },
            interrupt: () => child.kill('SIGINT'),
            kill: () => child.kill('SIGKILL'),
          });
        }
      });
    }
    child.once('error', reject);
    closed.then(({ status }) => reject(new Error(`ended with status ${status}: ${output}`)));
  });
}

/**
 * Starts all processes of a cell, with free ports and addresses.
 *
 * @param {string} cell a cell file
 * @returns {Promise<{servers: {name: string, url: string}[], stop: () => Promise<void>}>} once all
 *     are ready
 */
function startCell(cell) {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'cell-'));
  const endpoints = path.join(folder, 'endpoints.json');
  const child = spawn(metierProgram(), [...kLab, 'up', cell, '--free-ports', '--endpoints', endpoints],
    { stdio: ['ignore', 'pipe', 'inherit'] });
  const ended = awaitExit(child);
  const stop = async () => {
    child.kill('SIGINT');
    await ended;
    fs.rmSync(folder, { recursive: true });
  };
  return new Promise((resolve, reject) => {
    const timer = setTimeout(() => {
      child.kill('SIGINT');
      reject(new Error(`the cell was not up within ${kReadyTimeoutMs} ms`));
    }, kReadyTimeoutMs);
    readline.createInterface({ input: child.stdout }).on('line', (line) => {
      if (line.startsWith('the cell is up')) {
        clearTimeout(timer);
        resolve({ servers: JSON.parse(fs.readFileSync(endpoints, 'utf8')).servers, stop });
      }
    });
    child.once('error', reject);
    child.once('exit', (status) => {
      clearTimeout(timer);
      reject(new Error(`the cell ended with status ${status}`));
    });
  });
}

/** Waits until `metier list` shows a skill in a state. */
const awaitState = (url, skill, state) =>
  until(`${skill} is ${state}`, async () => (await runMetier(['list', url])).output,
    (output) => new RegExp(`${skill} +${state}`).test(output));

/** Asks until `wanted` says yes, for 30 s; the answer. */
async function until(what, ask, wanted) {
  const deadline = Date.now() + kUntilTimeoutMs;
  let seen;
  while (Date.now() < deadline) {
    seen = await ask();
    if (wanted(seen)) {
      return seen;
    }
    await new Promise((resolve) => setTimeout(resolve, kBetweenQuestionsMs));
  }
  throw new Error(`not within ${kUntilTimeoutMs} ms: ${what}: ${JSON.stringify(seen)}`);
}

module.exports = {
  awaitState, runMetier, serve, startCell, startMetier, startProcess, startServer, until, writeCell,
};
