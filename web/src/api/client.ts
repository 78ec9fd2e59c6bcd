// Requests to the dashboard's server. Each has a deadline; what fails throws ApiError with words for a person.

import type { Cell, CheckResult, Me, RecordDetail, RecordRow } from './types.js';

/** A request that was refused or not answered. `code` is the server's word, or "unreachable_server", "timeout". */
export class ApiError extends Error {
    constructor(
        readonly code: string,
        message: string,
        readonly status: number,
    ) {
        super(message);
    }
}

/** Longest wait for an answer [ms]. A Check of a long path takes a while; a Halt waits for standstill. */
const kDeadline = 20_000;

interface ErrorBody {
    error?: { code?: string; message?: string };
}

async function answerOf(response: Response): Promise<unknown> {
    const text = await response.text();
    let body: unknown = {};
    try {
        body = text === '' ? {} : JSON.parse(text);
    } catch {
        throw new ApiError('bad_answer', `The server answered with something else than JSON (${response.status})`, response.status);
    }
    if (!response.ok) {
        const error = (body as ErrorBody).error;
        throw new ApiError(error?.code ?? 'error', error?.message ?? response.statusText, response.status);
    }
    return body;
}

async function request(path: string, init: RequestInit): Promise<unknown> {
    const signal = AbortSignal.timeout(kDeadline);
    try {
        return await answerOf(await fetch(path, { ...init, signal, credentials: 'same-origin', cache: 'no-store' }));
    } catch (error) {
        if (error instanceof ApiError) throw error;
        if (signal.aborted) throw new ApiError('timeout', `No answer for ${kDeadline / 1000} s`, 0);
        throw new ApiError('unreachable_server', 'The dashboard does not answer', 0);
    }
}

/** One request after the other, each with its own deadline from its own beginning. */
class Lane {
    private last: Promise<unknown> = Promise.resolve();

    run<T>(ask: () => Promise<T>): Promise<T> {
        const answer = this.last.then(ask);
        this.last = answer.catch(() => undefined);
        return answer;
    }
}

/** A browser has six connections to a server. Where records come slowly or not at all, they hold up one of them: a Halt finds another. */
const records_lane = new Lane();

function get<T>(path: string): Promise<T> {
    return request(path, { method: 'GET' }) as Promise<T>;
}

/** State changes only ever go through here: POST, JSON, and the header that no other site can send. */
function post<T>(path: string, body: object): Promise<T> {
    const headers = { 'Content-Type': 'application/json', 'X-Metier': '1' };
    return request(path, { method: 'POST', headers, body: JSON.stringify(body) }) as Promise<T>;
}

export interface RecordFilter {
    server?: string;
    skill?: string;
    state?: string;
    reason?: string;
    user?: string;
    text?: string;
    from?: number;
    to?: number;
    before?: number;
    count?: number;
}

export type SkillCommand = 'suspend' | 'resume' | 'reset' | 'halt';

export interface ControlAnswer {
    failed?: { server: string; message: string }[];
    /** Of all: servers that others use. */
    left_out?: { server: string; used_by: string }[];
}

export interface HaltAnswer {
    halted: string[];
    failed: { server: string; message: string }[];
}

export function recordsQuery(filter: RecordFilter): string {
    const query = new URLSearchParams();
    for (const [key, value] of Object.entries(filter)) {
        if (value !== undefined && value !== '') query.set(key, String(value));
    }
    return query.toString();
}

export const api = {
    me: () => get<Me>('/api/me'),
    login: (user: string, password: string) => post<Me>('/api/login', { user, password }),
    logout: () => post<object>('/api/logout', {}),
    cell: () => get<Cell>('/api/cell'),
    meshes: () => get<{ files: string[] }>('/api/meshes'),
    /** \param server key, or "all" */
    control: (tab: string, action: 'take' | 'release', server: string) => post<ControlAnswer>('/api/control', { tab, server, action }),
    check: (tab: string, key: string, parameters: object) => post<CheckResult>('/api/skills/check', { tab, key, parameters }),
    start: (tab: string, key: string, parameters: object) => post<{ execution: string }>('/api/skills/start', { tab, key, parameters }),
    skill: (tab: string, key: string, command: SkillCommand) => post<object>(`/api/skills/${command}`, { tab, key }),
    halt: (what: { server?: string; arm?: string }) => post<HaltAnswer>('/api/halt', what),
    records: (filter: RecordFilter) => records_lane.run(() => get<{ records: RecordRow[]; more: boolean }>(`/api/records?${recordsQuery(filter)}`)),
    record: (number: number) => records_lane.run(() => get<RecordDetail>(`/api/records/${number}`)),
};

export type Api = typeof api;
