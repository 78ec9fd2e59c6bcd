// One execution in detail, or two beside each other: facts, transitions, children, plots, replay.

import type { AlignedData } from 'uplot';
import type { RecordDetail, RecordRow, Transition } from '../api/types.js';
import { timedPath } from '../scene/overlays.js';
import { shortText } from '../form/field_value.js';
import { Chart, kSeriesColors, type ChartSeries } from './chart.js';
import { findArm, wallTime, type Context } from './context.js';
import { fill, h, icon, kIcons } from './dom.js';
import { durationText, timeText, words } from './format.js';
import { Pill } from './pill.js';

/** Of the first and the second run in pictures. */
const kRunColors = ['#9a6bff', '#1fa88e'];

/** What a record says of its run, in the order in which it is shown; empty: not known. */
function factsOf(record: RecordDetail): [string, string | Node][] {
    const now = wallTime();
    const pill = new Pill();
    pill.set(record.state);
    const took = record.ended === undefined || record.ended === null ? 'running' : durationText(record.ended - record.started);
    return [
        ['Execution', `${record.number}`], ['State', pill.element], ['Started', timeText(record.started, now)], ['Took', took],
        ['Server', record.server_name || record.server], ['By', [record.user, record.client_name].filter((text) => (text ?? '') !== '').join(', ')],
        ['Reason', record.reason_text || words(record.reason ?? '')], ['Missed cycles', String(record.missed_cycles ?? 0)],
    ];
}

/** A column for each run, so that what differs is side by side. */
function facts(records: readonly RecordDetail[]): HTMLElement {
    const columns = records.map(factsOf);
    const rows = (columns[0] ?? []).map(([name], row) => ({ name, values: columns.map((column) => column[row]?.[1] ?? '') }));
    const list = h('dl', { class: 'facts' },
        ...(records.length > 1 ? [h('dt'), ...records.map((_, k) => runMark(k))] : []),
        ...rows.filter(({ values }) => values.some((value) => value !== '')).flatMap(({ name, values }) => [h('dt', {}, name), ...values.map((value) => h('dd', {}, value))]));
    list.style.setProperty('--runs', String(records.length));
    return list;
}

/** Names the columns in pictures. */
function runMark(run: number): HTMLElement {
    const mark = h('dd', { class: 'run-mark', 'aria-hidden': 'true' });
    mark.style.setProperty('--run', kRunColors[run] as string);
    return mark;
}

/** Joint velocities between the points of a path [rad/s]. */
export function velocities(path: RecordDetail['path']): number[][] {
    return path.map((point, k) => {
        const before = path[Math.max(0, k - 1)] as RecordDetail['path'][number];
        const after = path[Math.min(path.length - 1, k + 1)] as RecordDetail['path'][number];
        const span = after.time - before.time;
        return point.q.map((_, i) => (span > 0 ? ((after.q[i] ?? 0) - (before.q[i] ?? 0)) / span : 0));
    });
}

/** Several runs over one time: the times of all, and each run's columns with gaps where it has no point. */
export function overlay(runs: readonly { time: readonly number[]; columns: readonly (readonly number[])[] }[]): AlignedData {
    const times = [...new Set(runs.flatMap((run) => run.time))].sort((a, b) => a - b);
    const columns = runs.flatMap((run) => {
        const index = new Map(run.time.map((time, k) => [time, k]));
        return run.columns.map((column) => times.map((time) => {
            const k = index.get(time);
            return k === undefined ? null : column[k] ?? null;
        }));
    });
    return [times, ...columns] as AlignedData;
}

function columnsOf(rows: readonly (readonly number[])[]): number[][] {
    return (rows[0] ?? []).map((_, i) => rows.map((row) => row[i] ?? 0));
}

export class RecordView {
    readonly element = h('aside', { class: 'record', 'aria-label': 'Execution', 'tabindex': '-1' });
    private readonly position = new Chart('Joint position', 'rad', 'record', 0.02);
    private readonly velocity = new Chart('Joint velocity', 'rad/s', 'record', 0.02);
    private asked: readonly number[] = [];

    constructor(private readonly context: Context, private readonly choose: (number: number) => void) {
        fill(this.element, h('p', { class: 'empty' }, 'Choose an execution; tick two to compare them.'));
    }

    redraw(): void {
        this.position.redraw();
        this.velocity.redraw();
    }

    async show(numbers: readonly number[]): Promise<void> {
        this.asked = numbers;
        try {
            const records = await Promise.all(numbers.map((number) => this.context.api.record(number)));
            if (this.asked === numbers) this.render(records);
        } catch (error) {
            fill(this.element, h('p', { class: 'empty' }, error instanceof Error ? error.message : String(error)));
        }
    }

    private render(records: readonly RecordDetail[]): void {
        const drawable = records.some((record) => record.path.length > 1);
        fill(this.element,
            h('div', { class: 'record-head' }, h('h3', {}, records.length > 1 ? 'Comparison' : words(records[0]?.skill ?? '')),
                drawable && h('button', { class: 'small', id: 'replay', onclick: () => this.replay(records) }, icon(kIcons.play), 'Replay in 3D')),
            facts(records),
            ...(drawable ? [this.position.element, this.velocity.element] : [h('p', { class: 'empty' }, 'No joint path was recorded.')]),
            ...(records.length === 1 ? this.details(records[0] as RecordDetail) : []));
        if (drawable) this.plot(records);
    }

    private details(record: RecordDetail): Node[] {
        return [
            transitionsTable(record.transitions, record.started),
            ...(record.children.length > 0 ? [this.children(record.children)] : []),
            values('Parameters', record.parameters), values('Result', record.result), values('Check', record.check),
        ].filter((node): node is HTMLElement => node !== null);
    }

    private children(children: readonly RecordRow[]): HTMLElement {
        return h('section', {}, h('h4', {}, 'Started by it'), h('ul', { class: 'children' }, ...children.map((child) =>
            h('li', {}, h('button', { class: 'link', onclick: () => this.choose(child.number) }, `${words(child.skill)} on ${child.server_name || child.server}`), ` ${child.state}`))));
    }

    private plot(records: readonly RecordDetail[]): void {
        const runs = records.filter((record) => record.path.length > 1);
        const names = findArm(this.context.state.get(), runs[0]?.arm)?.joints.map((joint) => joint.name) ?? [];
        const series: ChartSeries[] = runs.flatMap((record, k) => (record.path[0]?.q ?? []).map((_, i) => ({
            label: names[i] ?? `${i + 1}`, color: kSeriesColors[i % kSeriesColors.length] as string, ...(k > 0 ? { dash: [5, 4] } : {}),
        })));
        const timed = (rowsOf: (record: RecordDetail) => number[][]) => overlay(runs.map((record) => ({
            time: record.path.map((point) => point.time - (record.path[0]?.time ?? 0)), columns: columnsOf(rowsOf(record)),
        })));
        this.position.setData(series, timed((record) => record.path.map((point) => point.q)));
        this.velocity.setData(series, timed((record) => velocities(record.path)));
    }

    private replay(records: readonly RecordDetail[]): void {
        const arms = this.context.state.get().cell?.arms ?? [];
        const runs = records.map((record, k) => ({
            name: `${words(record.skill)} ${record.number}`,
            arm: record.arm ?? arms.find((arm) => arm.server === record.server || arm.name === record.device)?.key ?? '',
            path: timedPath(record.path), color: kRunColors[k] as string,
        }));
        this.context.stage.replay(runs);
        this.context.choice.update((choice) => ({ ...choice, pane: 'stage' }));
    }
}

function transitionsTable(transitions: readonly Transition[], started: number): HTMLElement {
    return h('section', {}, h('h4', {}, 'What happened'), h('table', { class: 'transitions' }, h('tbody', {}, ...transitions.map((transition) =>
        h('tr', {}, h('td', { class: 'number' }, `${(transition.time - started).toFixed(3)} s`), h('td', {}, `${transition.from || '\u2013'} \u2192 ${transition.to}`),
            h('td', {}, [transition.step, transition.sub_state, transition.reason_text || transition.reason].filter((text) => (text ?? '') !== '').join(' \u00b7 ')))))));
}

function values(title: string, value: unknown): HTMLElement | null {
    if (typeof value !== 'object' || value === null || Object.keys(value).length === 0) return null;
    return h('section', {}, h('h4', {}, title), h('dl', { class: 'facts' }, ...Object.entries(value as Record<string, unknown>)
        .flatMap(([name, item]) => [h('dt', {}, name.replace(/([a-z0-9])([A-Z])/g, '$1 $2')), h('dd', { class: 'number' }, shortText(item))])));
}
