// A closed server and the client of another maker, with a certificate and a user: by each
// SecurityPolicy, signed or signed and encrypted, and not otherwise.
'use strict';

const assert = require('node:assert');
const fs = require('node:fs');
const os = require('node:os');
const path = require('node:path');
const { after, before, test } = require('node:test');
const {
  DataType, MessageSecurityMode, OPCUACertificateManager, OPCUAClient, SecurityPolicy, UserTokenType,
} = require('node-opcua');
const { runMetier, startServer } = require('./metier_process');

const kCell = path.join(__dirname, '..', 'system', 'simulated.toml');
const kUser = { type: UserTokenType.UserName, userName: 'anna', password: "anna's own" };
const kPolicies = ['Basic256Sha256', 'Aes128_Sha256_RsaOaep', 'Aes256_Sha256_RsaPss'];
const kApplicationUri = `urn:${os.hostname()}:another-maker`;

let folder;
let security;
let server;
let manager;
let certificateFile;

before(async () => {
  folder = fs.mkdtempSync(path.join(os.tmpdir(), 'closed-server-'));
  security = ['--security', path.join(folder, 'metier')];
  server = await startServer(['serve', kCell, '--server', 'iiwa', '--port', '0'], security);
  process.env.METIER_PASSWORD = kUser.password;
  assert.strictEqual((await runMetier(['user', 'add', kUser.userName], security)).status, 0);
  manager = new OPCUACertificateManager({
    rootFolder: path.join(folder, 'other'),
    automaticallyAcceptUnknownCertificate: true,
  });
  await manager.initialize();
  certificateFile = path.join(folder, 'other', 'certificate.pem');
  await manager.createSelfSignedCertificate({
    applicationUri: kApplicationUri,
    dns: [os.hostname()],
    outputFile: certificateFile,
    startDate: new Date(Date.now() - 3600 * 1000),
    subject: '/CN=AnotherMaker',
    validity: 30,
  });
});

after(async () => {
  await server?.stop();
  await manager?.dispose();
  fs.rmSync(folder, { recursive: true, force: true });
});

/** @returns what `work` makes of a session that was opened so */
async function withSession(policy, mode, user, work) {
  const client = OPCUAClient.create({
    applicationUri: kApplicationUri,
    applicationName: 'another maker',
    certificateFile,
    privateKeyFile: manager.privateKey,
    clientCertificateManager: manager,
    securityPolicy: SecurityPolicy[policy],
    securityMode: MessageSecurityMode[mode],
    endpointMustExist: false,
    connectionStrategy: { maxRetry: 0 },
  });
  try {
    await client.connect(server.url);
    const session = await client.createSession(user);
    const result = await work(session);
    await session.close();
    return result;
  } finally {
    await client.disconnect();
  }
}

async function serverState(session) {
  const value = await session.read({ nodeId: 'ns=0;i=2259' });
  assert.strictEqual(value.value.dataType, DataType.Int32);
  return value.value.value;
}

test('a stranger is refused, and let in once he is trusted', async () => {
  await assert.rejects(withSession('Basic256Sha256', 'SignAndEncrypt', kUser, serverState));
  const accepted = await runMetier(['trust', 'accept', certificateFile], security);
  assert.strictEqual(accepted.status, 0);
  assert.strictEqual(await withSession('Basic256Sha256', 'SignAndEncrypt', kUser, serverState), 0);
});

for (const policy of kPolicies) {
  for (const mode of ['Sign', 'SignAndEncrypt']) {
    test(`${policy}, ${mode}`, async () => {
      assert.strictEqual(await withSession(policy, mode, kUser, serverState), 0);
    });
  }
}

test('nobody comes in without security, a user or the right password', async () => {
  await assert.rejects(withSession('None', 'None', kUser, serverState));
  await assert.rejects(withSession('Basic256Sha256', 'SignAndEncrypt', undefined, serverState));
  const wrong = { ...kUser, password: 'a guess' };
  await assert.rejects(withSession('Basic256Sha256', 'SignAndEncrypt', wrong, serverState));
});
