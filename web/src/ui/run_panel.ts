// The chosen skill: its state, its form, Check with the verdict, and the commands.

import type { CheckResult, Skill } from '../api/types.js';
import { currentFrame } from '../kinematics/chain.js';
import { SkillForm } from '../form/skill_form.js';
import { commandsOf, type CellState } from '../state/cell_state.js';
import { findArm, findSkill, frameTime, wallTime, type Context } from './context.js';
import { fill, h, icon, kIcons, setText } from './dom.js';
import { durationText, subStateWords, words } from './format.js';
import { Pill } from './pill.js';
import { errorWords } from './server_card.js';

const kEmpty = 'Choose a skill in the list to see and run it.';

export class RunPanel {
    readonly element = h('section', { class: 'panel run', 'aria-label': 'The chosen skill' });
    private readonly forms = new Map<string, SkillForm>();
    private readonly pill = new Pill();
    private readonly status = h('p', { class: 'status' });
    private readonly error = h('p', { class: 'error', role: 'alert' });
    private readonly bar = h('span', { class: 'progress' }, h('i', {}));
    private readonly verdict = h('div', { class: 'verdict', role: 'status', 'aria-live': 'polite' });
    private readonly why_not = h('p', { class: 'why-not', id: 'why-not' });
    private readonly buttons = {
        check: this.button('Check', kIcons.check, '', () => void this.check()),
        start: this.button('Start', kIcons.play, 'primary', () => void this.start()),
        suspend: this.button('Suspend', kIcons.pause, '', () => this.command('suspend')),
        resume: this.button('Resume', kIcons.play, 'primary', () => this.command('resume')),
        reset: this.button('Reset', kIcons.reset, '', () => this.command('reset')),
        halt: this.button('Halt', kIcons.stop, 'halt', () => this.command('halt')),
    };
    private skill: Skill | null = null;
    private form: SkillForm | null = null;
    /** The parameters that were found possible, as text. */
    private checked = '';
    private checking = false;

    constructor(private readonly context: Context) {
        this.buttons.start.setAttribute('aria-describedby', 'why-not');
        context.state.subscribe(() => this.render());
        context.choice.subscribe(() => this.render());
    }

    /** Check of the form by keyboard. */
    async check(): Promise<boolean> {
        if (this.skill === null || this.form === null || this.checking) return false;
        const values = this.form.read();
        this.form.showErrors(values.errors, true);
        if (Object.keys(values.errors).length > 0) {
            this.form.focusFirstError();
            return false;
        }
        const skill = this.skill;
        if (skill.can.check === false) return true;
        this.checking = true;
        this.buttons.check.disabled = true;
        const result = await this.context.actions.check(skill, values.parameters);
        this.checking = false;
        this.buttons.check.disabled = false;
        if (this.skill !== skill) return false;
        this.checked = result.possible ? JSON.stringify(values.parameters) : '';
        this.showVerdict(result);
        return result.possible;
    }

    async start(): Promise<void> {
        if (this.skill === null || this.form === null || this.buttons.start.disabled) return;
        const skill = this.skill;
        const text = JSON.stringify(this.form.read().parameters);
        if (this.checked !== text && !(await this.check())) return;
        const { parameters } = this.form.read();
        this.context.stage.preview(null, null);
        this.context.stage.target(null, null);
        await this.context.actions.start(skill, parameters);
    }

    private button(name: string, path: string, kind: string, act: () => void): HTMLButtonElement {
        return h('button', { type: 'button', class: kind, 'data-command': name.toLowerCase(), onclick: act }, icon(path), name);
    }

    private command(command: 'suspend' | 'resume' | 'reset' | 'halt'): void {
        if (this.skill !== null) void this.context.actions.command(this.skill, command);
    }

    private render(): void {
        const state = this.context.state.get();
        const skill = findSkill(state, this.context.choice.get().skill);
        if (skill !== this.skill || this.element.childElementCount === 0) this.build(skill, state);
        if (skill !== null) this.renderState(state, skill);
    }

    private build(skill: Skill | null, state: CellState): void {
        this.skill = skill;
        this.checked = '';
        this.context.stage.preview(null, null);
        this.context.stage.target(null, null);
        fill(this.verdict);
        if (skill === null) {
            this.form = null;
            fill(this.element, h('div', { class: 'empty' }, h('p', {}, kEmpty), h('p', {}, 'Keys: press ? for a list.')));
            return;
        }
        this.form = this.forms.get(skill.key) ?? this.makeForm(skill, state);
        this.forms.set(skill.key, this.form);
        this.form.fillTargets();
        const server = state.cell?.servers.find((candidate) => candidate.key === skill.server);
        fill(this.element,
            h('div', { class: 'run-head' }, h('h2', {}, words(skill.display_name || skill.name)), this.pill.element,
                h('small', {}, `${server?.name ?? skill.server} \u00b7 ${skill.controller}`), this.status, this.bar, this.error,
                ...(skill.lacks ? [h('p', { class: 'lacks' }, `Of another maker: ${skill.lacks}`)] : [])),
            h('div', { class: 'run-body' }, this.form.element, this.verdict),
            h('div', { class: 'run-foot' }, this.why_not, h('div', { class: 'commands' }, ...Object.values(this.buttons))));
    }

    private makeForm(skill: Skill, state: CellState): SkillForm {
        const arm = findArm(state, skill.arm);
        const joints = (): number[] | null => (arm === null ? null : this.context.live.arm(arm.key).at(this.context.live.drawTime(frameTime()), 'q'));
        return new SkillForm(skill, {
            arm,
            changed: () => this.changed(),
            currentJoints: joints,
            currentFrame: (tool) => () => {
                const now = joints();
                return arm === null || now === null ? null : currentFrame(arm, now, tool);
            },
        });
    }

    private changed(): void {
        if (this.skill === null || this.form === null) return;
        const values = this.form.read();
        this.form.showErrors(values.errors, false);
        this.checked = '';
        fill(this.verdict);
        this.context.stage.preview(null, null);
        this.showTarget(values.parameters);
    }

    private showTarget(parameters: Record<string, unknown>): void {
        const arm = findArm(this.context.state.get(), this.skill?.arm);
        const field = this.skill?.parameters.find((candidate) => candidate.role === 'joints' || candidate.role === 'pose' || candidate.type === 'frame');
        const value = field === undefined ? undefined : parameters[field.name];
        if (arm === null || !Array.isArray(value) || this.form?.isRelative === true) this.context.stage.target(null, null);
        else this.context.stage.target(arm.key, field?.role === 'joints' ? { joints: value as number[] } : { frame: value as never });
    }

    private renderState(state: CellState, skill: Skill): void {
        const event = state.skills[skill.key];
        const name = event?.state ?? '';
        this.pill.set(name, state.link !== 'live');
        const since = event?.since === undefined ? '' : `for ${durationText(Math.max(0, wallTime() + state.clock_offset - event.since))}`;
        const busy = name === 'Running' || name === 'Suspended';
        setText(this.status, [busy ? event?.step ?? '' : '', subStateWords(name, event?.sub_state ?? ''), busy ? since : ''].filter((text) => text !== '').join(' \u00b7 '));
        setText(this.error, name === 'Halted' ? errorWords(event) : '');
        const progress = busy ? (event?.progress ?? null) : null;
        this.bar.classList.toggle('on', busy);
        this.bar.classList.toggle('unknown', progress === null);
        (this.bar.firstElementChild as HTMLElement).style.width = progress === null ? '' : `${Math.round(progress * 100)}%`;
        this.renderCommands(state, skill);
    }

    private renderCommands(state: CellState, skill: Skill): void {
        const can = commandsOf(state, skill);
        this.buttons.check.hidden = skill.can.check === false;
        this.buttons.check.disabled = state.link !== 'live' || this.checking;
        this.buttons.start.disabled = !can.start;
        this.buttons.suspend.disabled = !can.suspend;
        this.buttons.resume.disabled = !can.resume;
        this.buttons.reset.disabled = !can.reset;
        this.buttons.halt.disabled = !can.halt;
        this.buttons.resume.hidden = !can.resume;
        this.buttons.suspend.hidden = can.resume || skill.can.suspend === false;
        setText(this.why_not, can.start || state.skills[skill.key]?.state === 'Running' ? '' : can.why_not);
    }

    private showVerdict(result: CheckResult): void {
        const facts = [
            result.duration === undefined || !result.possible ? '' : durationText(result.duration),
            result.length === undefined ? '' : `${result.length.toFixed(3)} m`,
        ].filter((text) => text !== '').join(' \u00b7 ');
        const title = result.possible ? 'Possible' : `Not possible: ${words(result.code ?? 'refused').replace(/_/g, ' ')}`;
        fill(this.verdict, h('div', { class: result.possible ? 'good' : 'bad' },
            h('strong', {}, title), facts !== '' && h('span', {}, facts), (result.message ?? '') !== '' && h('p', {}, result.message as string),
            ...(result.notes ?? []).map((note) => h('p', { class: 'note' }, note))));
        this.verdict.scrollIntoView({ block: 'nearest' });
        this.context.stage.preview(this.skill?.arm ?? null, result.preview ?? null);
    }
}
