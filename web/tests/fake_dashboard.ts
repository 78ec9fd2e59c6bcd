// A stand-in for `metier dashboard`: serves the page and the same API over a made-up cell. Test code only.
//
//   node fake_dashboard.mjs PAGE_FOLDER MODELS_FOLDER [--port N] [--square] [--login USER:PASSWORD] [--meshes FOLDER] [--silent-records]
//
// Prints its address. With --square other clients' arms go around squares; with --silent-records
// nobody who asks for records is ever answered.

import { createServer, type IncomingMessage, type ServerResponse } from 'node:http';
import { readdirSync, readFileSync } from 'node:fs';
import { extname, join, normalize } from 'node:path';
import type { AddressInfo } from 'node:net';
import { FakeCell, Refusal } from './fake/fake_cell.js';

const [page = '', models = '', ...options] = process.argv.slice(2);

function option(name: string): string | null {
    const at = options.indexOf(name);
    return at < 0 ? null : (options[at + 1] ?? '');
}

const kTypes: Record<string, string> = {
    '.html': 'text/html; charset=utf-8', '.js': 'text/javascript', '.css': 'text/css', '.svg': 'image/svg+xml', '.txt': 'text/plain', '.urdf': 'application/xml', '.stl': 'model/stl',
};
const kTick = 1 / 30;

const login = option('--login');
const meshes = option('--meshes');
const sessions = new Set<string>();
const streams = new Map<string, ServerResponse>();

function send(stream: ServerResponse, name: string, data: unknown): void {
    stream.write(`event: ${name}\ndata: ${JSON.stringify(data)}\n\n`);
}

const cell = new FakeCell(models, (name, data) => {
    for (const [tab, stream] of streams) {
        if (name !== 'controls') send(stream, name, data);
        else for (const server of cell.description.cell.servers) send(stream, 'control', cell.control(server.key, tab));
    }
});

function answer(response: ServerResponse, status: number, body: unknown): void {
    response.writeHead(status, { 'Content-Type': 'application/json' }).end(JSON.stringify(body));
}

function file(response: ServerResponse, folder: string, path: string): void {
    const inside = normalize(path);
    if (inside.startsWith('..')) throw new Refusal(404, 'not_found', path);
    try {
        const content = readFileSync(join(folder, inside));
        response.writeHead(200, {
            'Content-Type': kTypes[extname(inside)] ?? 'application/octet-stream',
            'Content-Security-Policy': "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; font-src 'self'; connect-src 'self'",
        }).end(content);
    } catch {
        throw new Refusal(404, 'not_found', path);
    }
}

function openStream(response: ServerResponse): void {
    const tab = `tab-${Math.random().toString(36).slice(2)}`;
    response.writeHead(200, { 'Content-Type': 'text/event-stream', 'Cache-Control': 'no-store' });
    streams.set(tab, response);
    send(response, 'hello', { tab });
    send(response, 'snapshot', cell.snapshot(tab));
    response.on('close', () => {
        streams.delete(tab);
        cell.release(tab);
    });
}

function isLoggedIn(request: IncomingMessage): boolean {
    return login === null || [...sessions].some((session) => (request.headers.cookie ?? '').includes(session));
}

function me(request: IncomingMessage): object {
    const user = login === null ? '' : isLoggedIn(request) ? (login.split(':')[0] as string) : '';
    return { user, role: 'operator', lab: login === null, login_required: login !== null };
}

function records(query: URLSearchParams): object {
    const text = (query.get('text') ?? '').toLowerCase();
    const fitting = [...cell.records].reverse().filter((record) =>
        (!query.get('server') || record.server === query.get('server')) && (!query.get('state') || record.state === query.get('state')) &&
        (!query.get('user') || record.user === query.get('user')) && (text === '' || JSON.stringify([record.skill, record.server, record.reason_text]).toLowerCase().includes(text)) &&
        (!query.get('before') || record.number < Number(query.get('before'))));
    const count = Number(query.get('count') ?? 50);
    return { records: fitting.slice(0, count).map(({ path: _path, transitions: _transitions, ...row }) => row), more: fitting.length > count };
}

function get(request: IncomingMessage, response: ServerResponse, url: URL): void {
    const path = url.pathname;
    if (path === '/') return file(response, page, 'index.html');
    if (path.startsWith('/assets/')) return file(response, page, path.slice(1));
    if (path === '/api/me') return answer(response, 200, me(request));
    if (!isLoggedIn(request)) throw new Refusal(401, 'login_required', 'Log in first');
    if (path === '/api/cell') return answer(response, 200, { ...cell.description.cell, meshes: meshes !== null });
    if (path === '/api/stream') return openStream(response);
    if (path.startsWith('/api/records') && options.includes('--silent-records')) return;
    if (path === '/api/records') return answer(response, 200, records(url.searchParams));
    if (path === '/api/meshes' && meshes !== null) {
        return answer(response, 200, { files: readdirSync(meshes, { recursive: true }).map(String).filter((name) => name.endsWith('.urdf')) });
    }
    if (path.startsWith('/meshes/') && meshes !== null) return file(response, meshes, path.slice('/meshes/'.length));
    const record = /^\/api\/records\/(\d+)$/.exec(path);
    const found = record === null ? undefined : cell.records[Number(record[1]) - 1];
    if (found === undefined) throw new Refusal(404, 'not_found', path);
    answer(response, 200, found);
}

interface Body {
    tab?: string;
    key?: string;
    server?: string;
    arm?: string;
    action?: string;
    parameters?: Record<string, unknown>;
    user?: string;
    password?: string;
}

function post(request: IncomingMessage, response: ServerResponse, path: string, body: Body): void {
    if (request.headers['x-metier'] !== '1') throw new Refusal(403, 'forbidden', 'X-Metier is missing');
    const { tab = '', key = '', parameters = {} } = body;
    if (path === '/api/login') {
        if (`${body.user ?? ''}:${body.password ?? ''}` !== login) throw new Refusal(403, 'access_denied', 'Wrong user or password');
        const session = `session=${Math.random().toString(36).slice(2)}`;
        sessions.add(session);
        response.setHeader('Set-Cookie', `${session}; HttpOnly; SameSite=Strict`);
        return answer(response, 200, { user: body.user, role: 'operator', lab: false, login_required: true });
    }
    if (!isLoggedIn(request)) throw new Refusal(401, 'login_required', 'Log in first');
    const command = /^\/api\/skills\/(suspend|resume|reset|halt)$/.exec(path);
    if (path === '/api/control') return answer(response, 200, cell.take(tab, body.server ?? '', body.action ?? ''));
    if (path === '/api/skills/check') return answer(response, 200, cell.check(key, parameters));
    else if (path === '/api/skills/start') return answer(response, 200, { execution: cell.start(tab, key, parameters) });
    else if (path === '/api/halt') return answer(response, 200, { halted: cell.haltWhat(body), failed: [] });
    else if (command !== null) cell.command(tab, key, command[1] as string);
    else throw new Refusal(404, 'not_found', path);
    answer(response, 200, {});
}

function refuse(response: ServerResponse, error: unknown): void {
    const refusal = error instanceof Refusal ? error : new Refusal(500, 'internal', String(error));
    answer(response, refusal.status, { error: { code: refusal.code, message: refusal.message } });
}

const server = createServer((request, response) => {
    const url = new URL(request.url ?? '/', 'http://localhost');
    let text = '';
    request.on('data', (part: Buffer) => (text += part.toString()));
    const act = (): void => {
        try {
            if (request.method === 'POST') post(request, response, url.pathname, JSON.parse(text || '{}') as Body);
            else get(request, response, url);
        } catch (error) {
            refuse(response, error);
        }
    };
    if (request.method === 'POST') request.on('end', act);
    else act();
});

server.listen(Number(option('--port') ?? 0), '127.0.0.1', () => {
    if (options.includes('--square')) cell.drawSquares();
    let last = performance.now();
    setInterval(() => {
        const now = performance.now();
        cell.tick(Math.max(1e-3, (now - last) / 1000));
        last = now;
    }, kTick * 1000);
    setInterval(() => streams.forEach((stream) => send(stream, 'beat', {})), 1000);
    console.log(`http://127.0.0.1:${(server.address() as AddressInfo).port}`);
});
