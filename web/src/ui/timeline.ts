// What was executed: filter, table, strip of time, and the detail of what is chosen.

import { ApiError, type RecordFilter } from '../api/client.js';
import type { RecordRow } from '../api/types.js';
import type { CellState } from '../state/cell_state.js';
import { wallTime, type Context } from './context.js';
import { fill, h, setText } from './dom.js';
import { durationText, timeText, words } from './format.js';
import { Pill } from './pill.js';
import { RecordView } from './record_view.js';
import { Strip } from './strip.js';

const kPage = 50;
/** After the last keystroke in a filter [ms]. */
const kTyping = 250;

export class Timeline {
    readonly element: HTMLElement;
    readonly search = h('input', { 'type': 'search', 'placeholder': 'Search', 'aria-label': 'Search executions', 'oninput': () => this.later() });
    private readonly server = h('select', { 'aria-label': 'Server', 'onchange': () => void this.load() });
    private readonly state = h('select', { 'aria-label': 'State', 'onchange': () => void this.load() },
        ...['', 'Running', 'Ready', 'Halted', 'Suspended'].map((name) => h('option', { value: name }, name === '' ? 'Any state' : name)));
    private readonly user = h('input', { 'type': 'text', 'placeholder': 'User', 'aria-label': 'User', 'oninput': () => this.later() });
    private readonly since = h('select', { 'aria-label': 'Since', 'onchange': () => void this.load() },
        ...[['', 'Any time'], ['600', '10 min'], ['3600', '1 h'], ['86400', '24 h'], ['604800', '7 days']].map(([value, name]) => h('option', { value: value ?? '' }, name ?? '')));
    private readonly body = h('tbody', {});
    private readonly more = h('button', { class: 'small', onclick: () => void this.load(this.rows.at(-1)?.number) }, 'Earlier ones');
    private readonly note = h('p', { class: 'empty', role: 'status' });
    private readonly strip = new Strip((number) => this.choose(number));
    private readonly view: RecordView;
    private rows: RecordRow[] = [];
    private readonly compared = new Set<number>();
    private chosen: number | null = null;
    private seen = -1;
    private typing = 0;
    private loading = false;
    /** What is to be loaded after what is being loaded. */
    private next: { before: number | undefined } | null = null;

    constructor(private readonly context: Context) {
        this.view = new RecordView(context, (number) => this.choose(number));
        this.element = h('div', { class: 'timeline' }, h('div', { class: 'timeline-list' }, this.filters(), this.strip.element, this.table()), this.view.element);
        context.state.subscribe((state) => this.stateChanged(state));
        context.choice.subscribe(() => this.stateChanged(context.state.get()));
    }

    redraw(): void {
        this.view.redraw();
    }

    private filters(): HTMLElement {
        return h('div', { class: 'filters', role: 'search' }, this.search, this.server, this.state, this.user, this.since);
    }

    private table(): HTMLElement {
        const heads = ['', 'Started', 'Took', 'Skill', 'Server', 'State', 'Reason', 'By'];
        return h('div', { class: 'scroll' }, h('table', {},
            h('thead', {}, h('tr', {}, ...heads.map((head) => h('th', { scope: 'col' }, head)))), this.body), this.note, this.more);
    }

    private stateChanged(state: CellState): void {
        const count = state.cell?.servers.length ?? 0;
        if (this.server.childElementCount !== count + 1) {
            fill(this.server, h('option', { value: '' }, 'All servers'), ...(state.cell?.servers ?? []).map((server) => h('option', { value: server.key }, server.name)));
        }
        const wanted = this.context.choice.get().tab === 'timeline' && state.link === 'live';
        if (!wanted || this.seen === state.records_changed) return;
        this.seen = state.records_changed;
        void this.load();
    }

    private later(): void {
        clearTimeout(this.typing);
        this.typing = window.setTimeout(() => void this.load(), kTyping);
    }

    private filter(before?: number): RecordFilter {
        const filter: RecordFilter = { server: this.server.value, state: this.state.value, text: this.search.value.trim(), user: this.user.value.trim(), count: kPage };
        if (this.since.value !== '') filter.from = Math.floor(wallTime() - Number(this.since.value));
        if (before !== undefined) filter.before = before;
        return filter;
    }

    /** What was asked last is shown last; of what is asked while an answer is awaited only the last. */
    private async load(before?: number): Promise<void> {
        this.next = { before };
        if (this.loading) return;
        this.loading = true;
        for (let wanted = this.takeNext(); wanted !== null; wanted = this.takeNext()) await this.loadOnce(wanted.before);
        this.loading = false;
    }

    private takeNext(): { before: number | undefined } | null {
        const next = this.next;
        this.next = null;
        return next;
    }

    private async loadOnce(before?: number): Promise<void> {
        try {
            const answer = await this.context.api.records(this.filter(before));
            this.rows = before === undefined ? answer.records : [...this.rows, ...answer.records];
            this.more.hidden = !answer.more;
            setText(this.note, this.rows.length === 0 ? 'No execution fits.' : '');
        } catch (error) {
            this.rows = [];
            this.more.hidden = true;
            const none = error instanceof ApiError && error.status === 404;
            setText(this.note, none ? 'This dashboard reads no records.' : error instanceof Error ? error.message : String(error));
        }
        this.render();
    }

    private render(): void {
        fill(this.body, ...this.rows.map((row) => this.row(row)));
        this.strip.set(this.rows, this.chosen);
    }

    private row(record: RecordRow): HTMLElement {
        const now = wallTime();
        const pill = new Pill();
        pill.set(record.state);
        const box = h('input', { 'type': 'checkbox', 'aria-label': `Compare execution ${record.number}`, 'onchange': () => this.toggleCompare(record.number, box.checked) });
        box.checked = this.compared.has(record.number);
        const took = record.ended === undefined || record.ended === null ? 'running' : durationText(record.ended - record.started);
        return h('tr', { 'aria-selected': String(this.chosen === record.number), 'data-record': record.number },
            h('td', {}, box),
            h('td', { class: 'number' }, h('button', { class: 'link', onclick: () => this.choose(record.number) }, timeText(record.started, now))),
            h('td', { class: 'number' }, took), h('td', { title: record.skill }, words(record.skill)), h('td', {}, record.server_name || record.server),
            h('td', {}, pill.element), h('td', { class: 'reason', title: record.reason_text || record.reason || '' }, record.reason_text || words(record.reason ?? '')),
            h('td', {}, record.user || record.client_name || ''));
    }

    private choose(number: number): void {
        this.chosen = number;
        this.compared.clear();
        this.render();
        void this.view.show([number]);
    }

    /** The last two that were ticked are compared. */
    private toggleCompare(number: number, on: boolean): void {
        if (on) this.compared.add(number);
        else this.compared.delete(number);
        while (this.compared.size > 2) this.compared.delete([...this.compared][0] as number);
        this.chosen = null;
        this.render();
        if (this.compared.size > 0) void this.view.show([...this.compared]);
    }
}
