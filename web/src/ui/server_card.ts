// One server in the list: its connection, who controls it, and a row for each skill.

import type { ControlEvent, Server, Skill, SkillEvent } from '../api/types.js';
import { isConnected, leaseLeft, serverError, usersOf, type CellState } from '../state/cell_state.js';
import { wallTime, type Choice, type Context } from './context.js';
import { h, setAttribute, setText } from './dom.js';
import { subStateWords, words } from './format.js';
import { Pill } from './pill.js';

class SkillRow {
    readonly element: HTMLButtonElement;
    private readonly pill = new Pill();
    private readonly step = h('span', { class: 'step' });
    private readonly error = h('span', { class: 'error' });
    private readonly bar = h('span', { class: 'progress', 'aria-hidden': 'true' }, h('i', {}));

    constructor(skill: Skill, choose: () => void) {
        this.element = h('button', { class: 'skill', 'data-skill': skill.key, onclick: choose },
            h('span', { class: 'skill-name' }, words(skill.display_name || skill.name)), this.pill.element, this.step, this.error, this.bar);
    }

    render(event: SkillEvent | undefined, chosen: boolean, old: boolean): void {
        const state = event?.state ?? '';
        this.pill.set(state, old);
        setAttribute(this.element, 'aria-pressed', String(chosen));
        const sub = subStateWords(state, event?.sub_state ?? '');
        const busy = state === 'Running' || state === 'Suspended';
        setText(this.step, busy ? (event?.step ?? '') || (sub === 'executing' ? '' : sub) : '');
        setText(this.error, state === 'Halted' ? errorWords(event) : '');
        const progress = busy ? (event?.progress ?? null) : null;
        this.bar.classList.toggle('on', busy);
        this.bar.classList.toggle('unknown', progress === null);
        (this.bar.firstElementChild as HTMLElement).style.width = progress === null ? '' : `${Math.round(progress * 100)}%`;
    }
}

/** The last error in words: the server's text, else its reason. */
export function errorWords(event: SkillEvent | undefined): string {
    if (event === undefined) return '';
    if ((event.reason_text ?? '') !== '') return event.reason_text as string;
    const reason = words(event.reason ?? '').toLowerCase();
    if (reason !== '' && reason !== 'none') return reason;
    return subStateWords('Halted', event.sub_state ?? '');
}

export class ServerCard {
    readonly element: HTMLElement;
    private readonly dot = h('i', { class: 'dot' });
    private readonly problem = h('p', { class: 'error' });
    private readonly users = h('p', { class: 'users', title: 'Taking control of all leaves it to these: who has control of it keeps them from working' });
    private readonly owner = h('span', { class: 'owner' });
    private readonly lease = h('span', { class: 'lease' });
    private readonly control = h('button', { class: 'small' });
    private readonly rows: { skill: Skill; row: SkillRow }[];

    constructor(private readonly context: Context, private readonly server: Server, named: boolean) {
        this.rows = server.skills.map((skill) => ({ skill, row: new SkillRow(skill, () => this.choose(skill)) }));
        this.control.addEventListener('click', () => this.toggleControl());
        this.element = h('div', { class: 'server', 'data-server': server.key },
            h('div', { class: 'server-head' }, this.dot, h('span', { class: 'server-name', title: server.url }, named ? server.name : server.url),
                this.owner, this.lease, this.control),
            this.problem, this.users, ...this.rows.map((entry) => entry.row.element));
    }

    render(state: CellState, choice: Choice): void {
        const connected = isConnected(state, this.server.key);
        this.dot.className = `dot ${connected ? 'on' : 'off'}`;
        this.dot.title = connected ? 'Connected' : 'Not connected';
        setText(this.problem, connected ? '' : serverError(state, this.server.key) || 'Not connected');
        const users = usersOf(state, this.server.key);
        setText(this.users, users.length === 0 ? '' : `used by ${users.join(', ')}`);
        const old = !connected || state.link !== 'live';
        for (const { skill, row } of this.rows) row.render(state.skills[skill.key], choice.skill === skill.key, old);
        const control = this.controlEvent(state);
        setText(this.owner, ownerWords(control));
        setAttribute(this.owner, 'data-mine', String(control?.mine ?? false));
        setText(this.control, control?.mine === true ? 'Release' : 'Take');
        this.control.setAttribute('aria-label', `${control?.mine === true ? 'Release' : 'Take'} control of ${this.server.name}`);
        this.control.disabled = state.link !== 'live' || !connected;
        this.renderLease(state);
    }

    renderLease(state: CellState): void {
        const control = this.controlEvent(state);
        const left = control === null ? null : leaseLeft(control, state.clock_offset, wallTime());
        // Between two renewals that are reported, the whole lease is what is known.
        const shown = left === 0 ? (control?.lease_ms ?? 0) / 1000 : left;
        setText(this.lease, shown === null || shown === 0 ? '' : `${shown.toFixed(1)} s`);
        this.lease.title = 'Until its lease runs out, if it is not renewed';
    }

    private controlEvent(state: CellState): ControlEvent | null {
        return Object.values(state.controls).find((control) => control.server === this.server.key) ?? null;
    }

    private toggleControl(): void {
        const mine = this.controlEvent(this.context.state.get())?.mine === true;
        void (mine ? this.context.actions.releaseControl(this.server.key) : this.context.actions.takeControl(this.server.key));
    }

    private choose(skill: Skill): void {
        const arm = skill.arm;
        this.context.choice.update((choice) => ({ ...choice, skill: skill.key, arm: arm ?? choice.arm, pane: 'run' }));
    }
}

function ownerWords(control: ControlEvent | null): string {
    if (control === null || control.owner === '') return 'free';
    return control.mine ? 'you' : control.owner;
}
