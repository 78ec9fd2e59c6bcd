// A cell that moves: the state machines of its skills, who has control, and records; told by events as the stream has them.

import type {
    ArmSample, CheckResult, ControlEvent, Frame, LiveEvent, RecordDetail, Skill, SkillEvent, Snapshot, StateName,
} from '../../src/api/types.js';
import { Chain } from '../../src/kinematics/chain.js';
import { frameOf } from '../../src/kinematics/pose.js';
import { describeCell, type FakeDescription } from './cell_description.js';
import type { ModelArm } from './model_file.js';
import { durationOf, inverseKinematics, positionOf, throughPoints, type Motion } from './motion.js';

export class Refusal extends Error {
    constructor(readonly status: number, readonly code: string, message: string) {
        super(message);
    }
}

interface Moving {
    skill: string;
    motion: Motion;
    /** Time on the motion [s]. */
    at: number;
    endless: boolean;
}

interface FakeArm {
    model: ModelArm;
    q: number[];
    v: number[];
    moving: Moving | null;
}

export type Tell = (name: string, data: unknown) => void;

const kOther = 'demo client';

export class FakeCell {
    readonly description: FakeDescription;
    readonly records: RecordDetail[] = [];
    private readonly arms = new Map<string, FakeArm>();
    private readonly states = new Map<string, SkillEvent>();
    private readonly owners = new Map<string, string>();
    private width = 0.05;
    private now = Date.now() / 1000;
    private resting = false;

    constructor(models: string, private readonly tell: Tell) {
        this.description = describeCell(models);
        for (const model of this.description.arms.values()) {
            this.arms.set(model.key, { model, q: [...model.home], v: model.home.map(() => 0), moving: null });
        }
        for (const skill of this.skills()) this.states.set(skill.key, { key: skill.key, state: 'Ready', sub_state: '', reason: '', reason_text: '', since: this.now });
    }

    private skills(): Skill[] {
        return this.description.cell.servers.flatMap((server) => server.skills);
    }

    private skill(key: string): Skill {
        const skill = this.skills().find((candidate) => candidate.key === key);
        if (skill === undefined) throw new Refusal(404, 'not_found', `no skill ${key}`);
        return skill;
    }

    snapshot(tab: string): Snapshot {
        return {
            t: this.now, servers: this.description.cell.servers.map(({ key }) => ({ key, connected: true, error: '' })),
            skills: [...this.states.values()], controls: this.description.cell.servers.map(({ key }) => this.control(key, tab)), live: this.live(true),
        };
    }

    control(server: string, tab: string): ControlEvent {
        const owner = this.owners.get(server) ?? '';
        const until = owner === '' || owner === kOther ? null : this.now + 1;
        return { server, controller: 'Controller', owner: owner === '' ? '' : owner === tab ? 'operator' : kOther, mine: owner === tab && tab !== '', until, lease_ms: 1000 };
    }

    take(tab: string, server: string, action: string): object {
        const left_out: object[] = [];
        for (const { key } of this.description.cell.servers) {
            if (server !== 'all' && key !== server) continue;
            const user = this.description.cell.servers.find((one) => one.uses?.includes(key));
            if (server === 'all' && action === 'take' && user !== undefined) {
                left_out.push({ server: key, used_by: user.key });
                continue;
            }
            const owner = this.owners.get(key) ?? '';
            if (owner !== '' && owner !== tab) {
                if (server !== 'all') throw new Refusal(409, 'locked', `${kOther} has control of ${key}`);
                continue;
            }
            this.owners.set(key, action === 'take' ? tab : '');
        }
        this.tell('controls', null);
        return { failed: [], left_out };
    }

    /** A tab is gone: what it owned is free, and its moves halt. */
    release(tab: string): void {
        for (const [server, owner] of this.owners) {
            if (owner !== tab) continue;
            this.owners.set(server, '');
            for (const skill of this.skills().filter((one) => one.server === server)) {
                if (this.states.get(skill.key)?.state === 'Running') this.halt([skill], 'OwnerLost', 'The session of its owner ended');
            }
        }
        this.tell('controls', null);
    }

    /** Somebody else's clients move these arms around a square, again and again. */
    drawSquares(): void {
        for (const [server, key] of [['iiwa', 'iiwa'], ['ur5-move', 'ur5'], ['edo', 'edo']] as const) {
            const arm = this.arms.get(key) as FakeArm;
            const corner = frameOf(new Chain(arm.model).flange(arm.model.home));
            const points = [arm.model.home];
            for (const [x, z] of [[0, 0.1], [0.1, 0.1], [0.1, 0], [0, 0]] as const) {
                const frame = [corner[0], corner[1] + x, corner[2] + z, corner[3], corner[4], corner[5]] as const;
                points.push(inverseKinematics(arm.model, frame, points.at(-1) as number[]) ?? arm.model.home);
            }
            this.owners.set(server, kOther);
            this.begin(this.skill(`${server}/Controller/CartesianLinearMoveSkill`), arm, throughPoints(arm.model, points), {}, kOther, true);
        }
    }

    check(key: string, parameters: Record<string, unknown>): CheckResult {
        const skill = this.skill(key);
        const arm = skill.arm === null ? undefined : this.arms.get(skill.arm);
        if (arm === undefined) return { possible: true, duration: 0.5 };
        const target = this.targetOf(arm, parameters);
        if (typeof target === 'string') return { possible: false, code: 'unreachable', message: target };
        const motion = throughPoints(arm.model, [arm.q, target]);
        const duration = durationOf(motion);
        const preview = Array.from({ length: 41 }, (_, i) => ({ time: (i / 40) * duration, q: positionOf(motion, (i / 40) * duration) }));
        return { possible: true, duration, preview };
    }

    private targetOf(arm: FakeArm, parameters: Record<string, unknown>): number[] | string {
        const joints = parameters['TargetJointPosition'] as number[] | undefined;
        if (joints !== undefined) return joints;
        const frame = parameters['TargetPosition'] as Frame | undefined;
        if (frame === undefined) return 'TargetPosition: a value is needed';
        const text = `TargetPosition: [${frame.slice(0, 3).join(', ')}] m is out of reach of ${arm.model.product}`;
        return inverseKinematics(arm.model, frame, arm.q) ?? text;
    }

    start(tab: string, key: string, parameters: Record<string, unknown>): string {
        const skill = this.skill(key);
        if (this.owners.get(skill.server) !== tab) throw new Refusal(409, 'locked', 'Take control first');
        if (this.states.get(key)?.state !== 'Ready') throw new Refusal(409, 'invalid_state', `${skill.name} is ${this.states.get(key)?.state ?? ''}`);
        const arm = skill.arm === null ? null : (this.arms.get(skill.arm) as FakeArm);
        if (arm === null) {
            if (typeof parameters['Width'] === 'number') this.width = parameters['Width'];
            this.begin(skill, null, { points: [], times: [0.3] }, parameters, 'operator', false);
        } else {
            const target = this.targetOf(arm, parameters);
            if (typeof target === 'string') throw new Refusal(422, 'unreachable', target);
            this.begin(skill, arm, throughPoints(arm.model, [arm.q, target]), parameters, 'operator', false);
        }
        return this.states.get(key)?.execution ?? '';
    }

    private begin(skill: Skill, arm: FakeArm | null, motion: Motion, parameters: object, user: string, endless: boolean): void {
        const number = this.records.length + 1;
        if (arm !== null) arm.moving = { skill: skill.key, motion, at: 0, endless };
        this.records.push({
            number, id: `fake-${number}`, server: skill.server, server_name: skill.server, skill: skill.name, arm: skill.arm, user, client_name: 'page', started: this.now,
            ended: null, state: 'Running', reason: '', reason_text: '', parameters, result: {}, check: {}, missed_cycles: 0, transitions: [], children: [], path: [],
        });
        this.change(skill.key, 'Running', { execution: `fake-${number}`, step: '', progress: 0, reason: '', reason_text: '' });
        if (arm === null) this.change(skill.key, 'Ready', { progress: null });
    }

    command(tab: string, key: string, command: string): void {
        const skill = this.skill(key);
        const state = this.states.get(key)?.state;
        if (command === 'halt') return this.halt([skill], 'HaltRequested', '');
        if (this.owners.get(skill.server) !== tab) throw new Refusal(409, 'locked', 'Take control first');
        const next: Record<string, [StateName, StateName]> = { suspend: ['Running', 'Suspended'], resume: ['Suspended', 'Running'], reset: ['Halted', 'Ready'] };
        const [from, to] = next[command] ?? ['', ''];
        if (state !== from) throw new Refusal(409, 'invalid_state', `${command} is not possible while ${state ?? ''}`);
        this.change(key, to, { reason: '', reason_text: '' });
    }

    haltWhat(what: { server?: string; arm?: string }): string[] {
        const skills = this.skills().filter((skill) => (what.server === undefined || skill.server === what.server) && (what.arm === undefined || skill.arm === what.arm));
        this.halt(skills, 'HaltRequested', 'Halt by operator');
        return [...new Set(skills.map((skill) => skill.server))];
    }

    private halt(skills: Skill[], reason: string, reason_text: string): void {
        for (const skill of skills) {
            for (const arm of this.arms.values()) if (arm.moving?.skill === skill.key) arm.moving = null;
            this.change(skill.key, 'Halted', { reason, reason_text, sub_state: reason === 'OwnerLost' ? 'HaltedOwnerLost' : 'HaltedByClient', progress: null });
        }
    }

    private change(key: string, state: StateName, more: Partial<SkillEvent>): void {
        const before = this.states.get(key) as SkillEvent;
        if (before.state === state && state !== 'Running') return;
        const event: SkillEvent = { ...before, sub_state: '', ...more, state, since: this.now };
        this.states.set(key, event);
        const record = this.records.find((one) => one.id === event.execution && one.ended === null);
        if (record !== undefined) {
            record.transitions.push({ time: this.now, from: before.state, to: state, reason: more.reason ?? '', reason_text: more.reason_text ?? '' });
            record.state = state;
            if (state === 'Ready' || state === 'Halted') Object.assign(record, { ended: this.now, reason: more.reason ?? '', reason_text: more.reason_text ?? '' });
            this.tell('execution', { number: record.number });
        }
        this.tell('skill', event);
    }

    /** Moves everything by `dt` [s] and tells what moved. */
    tick(dt: number): void {
        this.now += dt;
        for (const arm of this.arms.values()) this.move(arm, dt);
        const busy = [...this.arms.values()].some((arm) => arm.moving !== null);
        if (busy || !this.resting) this.tell('live', this.live(false));
        this.resting = !busy;
    }

    private move(arm: FakeArm, dt: number): void {
        const moving = arm.moving;
        const before = arm.q;
        if (moving !== null && this.states.get(moving.skill)?.state === 'Running') {
            const duration = durationOf(moving.motion);
            moving.at = moving.endless ? (moving.at + dt) % duration : Math.min(duration, moving.at + dt);
            arm.q = positionOf(moving.motion, moving.at);
            this.recordOf(moving.skill)?.path.push({ time: moving.at, q: arm.q });
            if (!moving.endless && moving.at >= duration) {
                arm.moving = null;
                this.change(moving.skill, 'Ready', { progress: null });
            }
        }
        arm.v = arm.q.map((value, i) => (value - (before[i] as number)) / dt);
    }

    private recordOf(key: string): RecordDetail | undefined {
        return this.records.find((record) => record.id === this.states.get(key)?.execution && record.ended === null);
    }

    private live(all: boolean): LiveEvent {
        const arms: Record<string, ArmSample> = {};
        for (const [key, arm] of this.arms) {
            const commanded = arm.q.map((value, i) => value + (arm.v[i] as number) * 0.008);
            arms[key] = { q: arm.q, c: commanded, v: arm.v, jitter: 0.00002 * (1 + Math.abs(Math.sin(this.now))), missed: 0, safety: 'normal' };
            if (key === 'iiwa') arms[key].f = [0.4, -0.2, 3.1, 0.02, 0, 0];
        }
        const event: LiveEvent = { t: this.now, arms, grippers: { wsg50: { width: this.width, held: false } } };
        if (all) event.parts = { cube: [0.5, 0.3, 0.015, 0, 0, 0] };
        return event;
    }
}
