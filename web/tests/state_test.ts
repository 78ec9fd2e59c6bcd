// How events change what the page knows, and what a person may do then.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { Cell, Server, Skill, SkillEvent, Snapshot } from '../src/api/types.js';
import { recordsQuery } from '../src/api/client.js';
import { afterEvent, afterLoss, commandsOf, controlSummary, kNothing, leaseLeft, usersOf, type CellState } from '../src/state/cell_state.js';
import { ArmBuffer, LiveBuffer } from '../src/state/live_buffer.js';
import { Store } from '../src/state/store.js';

const kSkill = { key: 'iiwa/Controller/Move', server: 'iiwa', controller: 'Controller', name: 'Move', can: { suspend: true }, parameters: [] } as unknown as Skill;
const kCell = { name: 'demo', lab: true, arms: [], servers: [{ key: 'iiwa', connected: true, skills: [kSkill] } as unknown as Server] } as Cell;

function snapshot(state: string, owner: string, mine: boolean): Snapshot {
    return {
        t: 100, servers: [{ key: 'iiwa', connected: true, error: '' }], skills: [{ key: kSkill.key, state } as SkillEvent],
        controls: [{ server: 'iiwa', controller: 'Controller', owner, mine, until: 101 }],
    };
}

function live(state: string, owner = 'operator', mine = true): CellState {
    const begun = afterEvent({ ...kNothing, cell: kCell }, 'hello', { tab: 't1' }, 90);
    return afterEvent(begun, 'snapshot', snapshot(state, owner, mine), 90);
}

test('a snapshot tells all states and the server\u2019s clock', () => {
    const state = live('Ready');
    assert.equal(state.link, 'live');
    assert.equal(state.tab, 't1');
    assert.equal(state.clock_offset, 10);
    assert.equal(state.skills[kSkill.key]?.state, 'Ready');
});

test('a skill event changes that skill, and keeps what it does not name', () => {
    const first = afterEvent(live('Ready'), 'skill', { key: kSkill.key, state: 'Running', execution: 'x' }, 0);
    const second = afterEvent(first, 'skill', { key: kSkill.key, state: 'Running', progress: 0.5 }, 0);
    assert.deepEqual(second.skills[kSkill.key], { key: kSkill.key, state: 'Running', execution: 'x', progress: 0.5 });
    assert.equal(first.skills[kSkill.key]?.progress, undefined, 'states are not changed in place');
});

test('an event of an unknown kind changes nothing', () => {
    const state = live('Ready');
    assert.equal(afterEvent(state, 'weather', {}, 0), state);
});

test('alarms are kept newest first, and not without end', () => {
    let state = live('Ready');
    for (let i = 0; i < 300; ++i) state = afterEvent(state, 'alarm', { server: 'iiwa', severity: 1, message: `${i}`, time: i }, 0);
    assert.equal(state.alarms.length, 200);
    assert.equal(state.alarms[0]?.message, '299');
});

test('Start needs Ready and control; Halt needs neither', () => {
    assert.equal(commandsOf(live('Ready'), kSkill).start, true);
    const reader = commandsOf(live('Ready', '', false), kSkill);
    assert.deepEqual([reader.start, reader.halt, reader.why_not], [false, true, 'Take control first']);
    assert.equal(commandsOf(live('Ready', 'maria', false), kSkill).why_not, 'maria has control');
    const halted = commandsOf(live('Halted'), kSkill);
    assert.deepEqual([halted.start, halted.reset, halted.why_not], [false, true, 'Halted: Reset first']);
});

test('each state offers what its machine allows', () => {
    const table: [string, string[]][] = [['Ready', ['start', 'halt']], ['Running', ['suspend', 'halt']], ['Suspended', ['resume', 'reset', 'halt']], ['Halted', ['reset']]];
    for (const [name, allowed] of table) {
        const commands = commandsOf(live(name), kSkill);
        const given = (['start', 'suspend', 'resume', 'reset', 'halt'] as const).filter((command) => commands[command]);
        assert.deepEqual(given, allowed, name);
    }
});

test('after a loss nobody here has control, and nothing can be commanded', () => {
    const state = afterLoss(live('Ready'));
    assert.equal(state.link, 'lost');
    assert.equal(state.tab, '');
    assert.equal(controlSummary(state), 'none');
    assert.deepEqual(commandsOf(state, kSkill), { start: false, suspend: false, resume: false, reset: false, halt: false, why_not: 'No connection to the dashboard' });
});

test('all is controlled when what is left belongs to those that use it', () => {
    const component = { key: 'move', connected: true, skills: [], uses: ['iiwa'] } as unknown as Server;
    const controls = (mine: boolean) => ({ server: 'move', controller: 'Controller', owner: 'operator', mine });
    const both = afterEvent({ ...live('Ready', '', false), cell: { ...kCell, servers: [...kCell.servers, component] } }, 'control', controls(true), 0);
    assert.deepEqual(usersOf(both, 'iiwa'), ['move']);
    assert.deepEqual(usersOf(both, 'move'), []);
    assert.equal(controlSummary(both), 'all');
    assert.equal(controlSummary({ ...both, cell: kCell }), 'some', 'nobody uses it');
    assert.equal(controlSummary(afterEvent(both, 'control', controls(false), 0)), 'none');
});

test('a server that is away takes no command', () => {
    const state = afterEvent(live('Running'), 'server', { key: 'iiwa', connected: false, error: 'gone' }, 0);
    assert.equal(commandsOf(state, kSkill).halt, false);
    assert.equal(commandsOf(state, kSkill).why_not, 'Its server does not answer');
});

test('a lease counts down by the server\u2019s clock', () => {
    const control = { server: 'iiwa', controller: 'C', owner: 'a', mine: false, until: 101 };
    assert.equal(leaseLeft(control, 10, 90.25), 0.75);
    assert.equal(leaseLeft(control, 10, 99), 0);
    assert.equal(leaseLeft({ ...control, until: null }, 10, 90), null);
});

test('an arm is on a line between two samples, and keeps what an event leaves out', () => {
    const buffer = new ArmBuffer();
    buffer.add(1, { q: [0, 0], jitter: 0.001 });
    buffer.add(1.1, { q: [1, -1] });
    assert.deepEqual(buffer.at(1.05, 'q')?.map((value) => Math.round(value * 1e9) / 1e9), [0.5, -0.5]);
    assert.deepEqual(buffer.at(9, 'q'), [1, -1]);
    assert.deepEqual(buffer.at(0, 'q'), [0, 0]);
    assert.equal(buffer.latest?.jitter, 0.001);
    buffer.add(1.05, { q: [9, 9] });
    assert.deepEqual(buffer.at(2, 'q'), [1, -1], 'late samples do not move it back');
});

test('after rest an arm does not creep', () => {
    const buffer = new ArmBuffer();
    buffer.add(1, { q: [0] });
    buffer.add(11, { q: [1] });
    assert.deepEqual(buffer.at(6, 'q'), [0]);
    assert.deepEqual(buffer.at(11, 'q'), [1]);
});

test('only half a minute is kept', () => {
    const buffer = new ArmBuffer();
    for (let i = 0; i < 3000; ++i) buffer.add(i / 30, { q: [i] });
    assert.ok(buffer.samples.length < 1000, `${buffer.samples.length}`);
    assert.ok((buffer.samples[0]?.t ?? 0) > 100 - 33);
});

test('drawing follows the quickest sample, a little behind', () => {
    const buffer = new LiveBuffer();
    buffer.add({ t: 1000, arms: { a: { q: [0] } }, parts: { cube: [1, 2, 3, 0, 0, 0], ball: [0, 0, 0, 0, 0, 0] } }, 5.2);
    buffer.add({ t: 1000.1, arms: { a: { q: [1] }, }, grippers: { g: { width: 0.02, held: true } }, parts: { ball: null } }, 5.15);
    assert.ok(Math.abs(buffer.drawTime(5.15) - (1000.1 - 0.08)) < 1e-6);
    assert.equal(buffer.widths.get('g'), 0.02);
    assert.equal(buffer.parts.get('cube')?.[2], 3);
    assert.equal(buffer.parts.get('ball'), null, 'a part that is gone is not drawn');
});

test('a store tells its listeners once for many changes', () => {
    const waiting: (() => void)[] = [];
    const store = new Store(0, (tell) => waiting.push(tell));
    const seen: number[] = [];
    store.subscribe((value) => seen.push(value));
    store.update((value) => value + 1);
    store.update((value) => value + 1);
    store.update((value) => value);
    waiting.forEach((tell) => tell());
    assert.deepEqual(seen, [0, 2]);
});

test('a filter becomes a query without what is empty', () => {
    assert.equal(recordsQuery({ server: 'iiwa', text: '', count: 50, before: 7 }), 'server=iiwa&count=50&before=7');
});
