// Executions as bars along time, a lane for each server.

import type { RecordRow } from '../api/types.js';
import { wallTime } from './context.js';
import { fill, h, svg } from './dom.js';
import { durationText, timeText, words } from './format.js';

const kLane = 14;
const kWidth = 1000;

export interface Bar {
    number: number;
    lane: number;
    from: number;
    to: number;
    state: string;
    title: string;
}

/** Bars with `from` and `to` as shares of the whole span; lanes in order of the servers' names. */
export function barsOf(records: readonly RecordRow[], now: number): { lanes: string[]; bars: Bar[]; start: number; end: number } {
    const lanes = [...new Set(records.map((record) => record.server_name || record.server))].sort();
    const start = Math.min(...records.map((record) => record.started));
    const end = Math.max(...records.map((record) => record.ended ?? now), start + 1);
    const bars = records.map((record) => ({
        number: record.number,
        lane: lanes.indexOf(record.server_name || record.server),
        from: (record.started - start) / (end - start),
        to: ((record.ended ?? now) - start) / (end - start),
        state: record.state,
        title: `${words(record.skill)}, ${timeText(record.started, now)}, ${durationText((record.ended ?? now) - record.started)}`,
    }));
    return { lanes, bars, start, end };
}

export class Strip {
    readonly element = h('div', { class: 'strip', hidden: true });

    constructor(private readonly choose: (number: number) => void) {}

    set(records: readonly RecordRow[], chosen: number | null): void {
        this.element.hidden = records.length === 0;
        if (records.length === 0) return;
        const now = wallTime();
        const { lanes, bars, start, end } = barsOf(records, now);
        const height = lanes.length * kLane;
        const drawn = bars.map((bar) => svg('rect', {
            'x': bar.from * kWidth, 'y': bar.lane * kLane + 2, 'width': Math.max(3, (bar.to - bar.from) * kWidth), 'height': kLane - 4, 'rx': 1.5,
            'class': bar.number === chosen ? 'lane-bar chosen' : 'lane-bar', 'data-state': bar.state.toLowerCase(), 'onclick': () => this.choose(bar.number),
        }, svg('title', {}, bar.title)));
        const picture = svg('svg', { 'viewBox': `0 0 ${kWidth} ${height}`, 'preserveAspectRatio': 'none', 'height': height, 'role': 'img', 'aria-label': 'Executions along time' }, ...drawn);
        fill(this.element,
            h('div', { class: 'lanes' }, ...lanes.map((lane) => h('span', {}, lane))),
            h('div', { class: 'strip-picture' }, picture, h('div', { class: 'strip-ends' }, h('span', {}, timeText(start, now)), h('span', {}, timeText(end, now)))));
    }
}
