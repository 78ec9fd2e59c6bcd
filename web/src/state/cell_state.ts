// What the page knows of the cell, and how each event of the stream changes it. Pure: no clock, no document.

import type {
    AlarmEvent, Cell, ControlEvent, Me, ServerEvent, Skill, SkillEvent, Snapshot, StateName,
} from '../api/types.js';

export type Link = 'connecting' | 'live' | 'lost';

export interface CellState {
    readonly me: Me | null;
    readonly cell: Cell | null;
    readonly link: Link;
    /** Names this tab to the server; "" while there is no stream. */
    readonly tab: string;
    /** Server's clock less this computer's [s]. */
    readonly clock_offset: number;
    readonly servers: Readonly<Record<string, ServerEvent>>;
    readonly skills: Readonly<Record<string, SkillEvent>>;
    /** By "server/controller". */
    readonly controls: Readonly<Record<string, ControlEvent>>;
    /** Newest first. */
    readonly alarms: readonly AlarmEvent[];
    /** Grows with each changed record. */
    readonly records_changed: number;
}

export const kNothing: CellState = {
    me: null, cell: null, link: 'connecting', tab: '', clock_offset: 0,
    servers: {}, skills: {}, controls: {}, alarms: [], records_changed: 0,
};

const kMostAlarms = 200;

function byKey<T>(list: readonly T[], key: (item: T) => string): Record<string, T> {
    return Object.fromEntries(list.map((item) => [key(item), item]));
}

export function controlKey(control: { server: string; controller: string }): string {
    return `${control.server}/${control.controller}`;
}

function withSnapshot(state: CellState, snapshot: Snapshot, now: number): CellState {
    return {
        ...state,
        link: 'live',
        clock_offset: snapshot.t > 0 ? snapshot.t - now : state.clock_offset,
        servers: byKey(snapshot.servers ?? [], (server) => server.key),
        skills: byKey(snapshot.skills ?? [], (skill) => skill.key),
        controls: byKey(snapshot.controls ?? [], controlKey),
    };
}

function withSkill(state: CellState, event: SkillEvent): CellState {
    const merged = { ...state.skills[event.key], ...event };
    return { ...state, skills: { ...state.skills, [event.key]: merged } };
}

/** The state after an event of the stream; events that are not the state's business leave it as it is. `now` [s]. */
export function afterEvent(state: CellState, name: string, data: unknown, now: number): CellState {
    switch (name) {
        case 'hello':
            return { ...state, tab: (data as { tab: string }).tab, link: 'live' };
        case 'snapshot':
            return withSnapshot(state, data as Snapshot, now);
        case 'skill':
            return withSkill(state, data as SkillEvent);
        case 'control': {
            const control = data as ControlEvent;
            return { ...state, controls: { ...state.controls, [controlKey(control)]: control } };
        }
        case 'server': {
            const server = data as ServerEvent;
            return { ...state, servers: { ...state.servers, [server.key]: server } };
        }
        case 'alarm':
            return { ...state, alarms: [data as AlarmEvent, ...state.alarms].slice(0, kMostAlarms) };
        case 'execution':
            return { ...state, records_changed: state.records_changed + 1 };
        default:
            return state;
    }
}

/** Without a stream nothing is known for sure: nobody here has control, and states are shown as old. */
export function afterLoss(state: CellState): CellState {
    const controls = Object.fromEntries(
        Object.entries(state.controls).map(([key, control]) => [key, { ...control, mine: false }]),
    );
    return { ...state, link: 'lost', tab: '', controls };
}

export function isConnected(state: CellState, server_key: string): boolean {
    const live = state.servers[server_key];
    if (live !== undefined) return live.connected;
    return state.cell?.servers.find((server) => server.key === server_key)?.connected ?? false;
}

export function serverError(state: CellState, server_key: string): string {
    return state.servers[server_key]?.error ?? state.cell?.servers.find((server) => server.key === server_key)?.error ?? '';
}

export function controlOf(state: CellState, skill: Skill): ControlEvent | null {
    return state.controls[controlKey(skill)] ?? null;
}

export function stateOf(state: CellState, skill_key: string): StateName {
    return state.skills[skill_key]?.state ?? '';
}

/** Keys of the servers whose skills that one's are used by; taking control of all leaves it to them. */
export function usersOf(state: CellState, server_key: string): string[] {
    return (state.cell?.servers ?? []).filter((server) => server.uses?.includes(server_key)).map((server) => server.key);
}

/** Whether this tab may command anything, or all that is not left to other servers. */
export function controlSummary(state: CellState): 'none' | 'some' | 'all' {
    const controls = Object.values(state.controls);
    if (!controls.some((control) => control.mine)) return 'none';
    return controls.every((control) => control.mine || usersOf(state, control.server).length > 0) ? 'all' : 'some';
}

/** Seconds until a lease runs out, by the server's clock; null where there is none. */
export function leaseLeft(control: ControlEvent, clock_offset: number, now: number): number | null {
    if (control.until === undefined || control.until === null || control.owner === '') return null;
    return Math.max(0, control.until - (now + clock_offset));
}

export interface Commands {
    start: boolean;
    suspend: boolean;
    resume: boolean;
    reset: boolean;
    halt: boolean;
    /** Why Start is not possible; "" where it is. */
    why_not: string;
}

function whyNoStart(state: CellState, skill: Skill, name: StateName): string {
    if (state.link !== 'live') return 'No connection to the dashboard';
    if (!isConnected(state, skill.server)) return 'Its server does not answer';
    const control = controlOf(state, skill);
    if (control?.mine !== true) {
        return control !== null && control.owner !== '' ? `${control.owner} has control` : 'Take control first';
    }
    if (name === 'Ready') return '';
    return name === 'Halted' ? 'Halted: Reset first' : `It is ${name.toLowerCase() || 'in an unknown state'}`;
}

/** Which commands make sense now: the state machine of OPC 10000-10. Halt needs no control. */
export function commandsOf(state: CellState, skill: Skill): Commands {
    const name = stateOf(state, skill.key);
    const reachable = state.link === 'live' && isConnected(state, skill.server);
    const mine = reachable && controlOf(state, skill)?.mine === true;
    const why_not = whyNoStart(state, skill, name);
    return {
        start: why_not === '',
        suspend: mine && name === 'Running' && skill.can.suspend !== false,
        resume: mine && name === 'Suspended',
        reset: mine && (name === 'Halted' || name === 'Suspended'),
        halt: reachable && name !== 'Halted',
        why_not,
    };
}
