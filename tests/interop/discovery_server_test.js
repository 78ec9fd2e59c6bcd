// Servers of metier at the Local Discovery Server of another maker, node-opcua's, and the other way
// round.
'use strict';

const assert = require('node:assert');
const fs = require('node:fs');
const os = require('node:os');
const path = require('node:path');
const { after, test } = require('node:test');
const { runMetier, startProcess, startServer } = require('./metier_process');

// Before node-opcua is loaded: it keeps the certificates of its clients there.
const kDirectory = fs.mkdtempSync(path.join(os.tmpdir(), 'metier-lds-'));
process.env.XDG_CONFIG_HOME = kDirectory;
const {
  ApplicationType, MessageSecurityMode, OPCUAClient, RegisterServer2Request, RegisterServerRequest,
  RegisteredServer, SecurityPolicy, StatusCodes, findServers,
} = require('node-opcua');

const kCell = path.join(__dirname, '..', 'system', 'discovered.toml');
const kDeadlineMs = 30000;

after(() => fs.rmSync(kDirectory, { recursive: true, force: true }));

/** node-opcua's discovery server. @param {string} port "0": a free one */
function startDiscoveryServer(port = '0') {
  return startProcess(process.execPath, [
    path.join(__dirname, 'local_discovery_server.js'), path.join(kDirectory, 'lds'), port]);
}

function serveArm(discoveryUrl) {
  return startServer(['serve', kCell, '--server', 'iiwa-a', '--port', '0', '--discovery', discoveryUrl]);
}

/** What a discovery server knows of servers of that name. */
async function known(discoveryUrl, name) {
  const { servers } = await findServers(discoveryUrl);
  return servers.filter((server) => server.applicationName.text === name);
}

/** Asks until a discovery server knows so many servers of that name. */
async function awaitKnown(discoveryUrl, name, count) {
  const deadline = Date.now() + kDeadlineMs;
  for (;;) {
    const servers = await known(discoveryUrl, name);
    if (servers.length === count) {
      return servers;
    }
    assert.ok(Date.now() < deadline, `${servers.length} servers ${name} at ${discoveryUrl}, not ${count}`);
  }
}

/** Runs `body` with processes that end with it, the last one first. */
async function withProcesses(body) {
  const running = [];
  const keep = async (starting) => {
    running.push(await starting);
    return running.at(-1);
  };
  try {
    await body(keep);
  } finally {
    for (const child of running.reverse()) {
      await child.kill();
    }
  }
}

test('a server of metier is known from its start to its end', () => withProcesses(async (keep) => {
  const lds = await keep(startDiscoveryServer());
  const arm = await keep(serveArm(lds.url));
  const [server] = await awaitKnown(lds.url, 'iiwa-a', 1);
  assert.strictEqual(server.applicationType, ApplicationType.Server);
  assert.match(server.applicationUri, /^urn:.+:metier:iiwa-a:/);
  assert.strictEqual(server.productUri, 'urn:metier');
  assert.deepStrictEqual(server.discoveryUrls, [arm.url]);
  await arm.stop();
  assert.deepStrictEqual(await known(lds.url, 'iiwa-a'), [], 'it took itself out before it ended');
}));

test('metier find finds an arm through it', () => withProcesses(async (keep) => {
  const lds = await keep(startDiscoveryServer());
  const nothing = await runMetier(['find', 'JointPtpMoveSkillType', '--discovery', lds.url]);
  assert.strictEqual(nothing.status, 1);
  assert.strictEqual(nothing.output, 'nothing fits\n');
  const arm = await keep(serveArm(lds.url));
  await awaitKnown(lds.url, 'iiwa-a', 1);
  const found = await runMetier([
    'find', 'JointPtpMoveSkillType', '--reach', '0.5', '--payload', '5', '--discovery', lds.url, '--json']);
  assert.strictEqual(found.status, 0);
  const { candidates, silent, problems } = JSON.parse(found.output);
  assert.deepStrictEqual([silent, problems], [[], []]);
  assert.deepStrictEqual(
    candidates.map((c) => [c.url, c.server, c.told_by, c.controller, c.skill, c.fits]),
    [[arm.url, 'iiwa-a', lds.url, 'IiwaController', 'JointPtpMoveSkill', true]]);
}));

test('a server registers again where the discovery server was killed and started again', () =>
  withProcesses(async (keep) => {
    const first = await keep(startDiscoveryServer());
    const arm = await keep(serveArm(first.url));
    await awaitKnown(first.url, 'iiwa-a', 1);
    await first.kill();
    const second = await keep(startDiscoveryServer(new URL(first.url).port));
    assert.strictEqual(second.url, first.url);
    const [server] = await awaitKnown(second.url, 'iiwa-a', 1);
    assert.deepStrictEqual(server.discoveryUrls, [arm.url]);
  }));

/** Sends one request of the discovery services over a connection without security. */
async function ask(discoveryUrl, request) {
  const client = OPCUAClient.create({
    endpointMustExist: false,
    securityMode: MessageSecurityMode.None,
    securityPolicy: SecurityPolicy.None,
  });
  await client.connect(discoveryUrl);
  try {
    return await new Promise((resolve, reject) => {
      client.performMessageTransaction(request, (error, response) => (error ? reject(error) : resolve(response)));
    });
  } finally {
    await client.disconnect();
  }
}

function registration(port, isOnline) {
  return new RegisteredServer({
    serverUri: `urn:another-maker:${port}`,
    productUri: 'urn:another-maker',
    serverNames: [{ text: `another-${port}` }],
    serverType: ApplicationType.Server,
    discoveryUrls: [`opc.tcp://127.0.0.1:${port}`],
    isOnline,
  });
}

test('metier discovery takes registrations by the stack of node-opcua', () => withProcesses(async (keep) => {
  const lds = await keep(startServer(['discovery', '--port', '0']));
  const requests = [
    new RegisterServerRequest({ server: registration(1, true) }),
    new RegisterServer2Request({ server: registration(2, true), discoveryConfiguration: [] }),
  ];
  for (const request of requests) {
    const response = await ask(lds.url, request);
    assert.strictEqual(response.responseHeader.serviceResult, StatusCodes.Good);
  }
  const silent = async () => {
    const { output } = await runMetier(['find', 'SkillType', '--discovery', lds.url, '--json']);
    return JSON.parse(output).silent.map((server) => [server.name, server.url]);
  };
  assert.deepStrictEqual(
    await silent(), [['another-1', 'opc.tcp://127.0.0.1:1'], ['another-2', 'opc.tcp://127.0.0.1:2']]);
  await ask(lds.url, new RegisterServerRequest({ server: registration(1, false) }));
  assert.deepStrictEqual(await silent(), [['another-2', 'opc.tcp://127.0.0.1:2']]);
}));
