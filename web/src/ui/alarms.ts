// What servers reported, newest first.

import type { CellState } from '../state/cell_state.js';
import { wallTime, type Context } from './context.js';
import { fill, h } from './dom.js';
import { timeText } from './format.js';

/** Severity of OPC 10000-5 (1 to 1000) in words. */
export function severityWords(severity: number): 'high' | 'medium' | 'low' {
    return severity >= 667 ? 'high' : severity >= 334 ? 'medium' : 'low';
}

export class Alarms {
    readonly element = h('div', { class: 'alarms' });
    private drawn: CellState['alarms'] | null = null;

    constructor(context: Context) {
        context.state.subscribe((state) => this.render(state));
    }

    private render(state: CellState): void {
        if (state.alarms === this.drawn) return;
        this.drawn = state.alarms;
        if (state.alarms.length === 0) {
            fill(this.element, h('p', { class: 'empty' }, 'No alarms since this page was opened.'));
            return;
        }
        const name = (key: string): string => state.cell?.servers.find((server) => server.key === key)?.name ?? key;
        fill(this.element, h('table', {}, h('tbody', {}, ...state.alarms.map((alarm) => h('tr', { 'data-severity': severityWords(alarm.severity) },
            h('td', { class: 'number' }, timeText(alarm.time, wallTime())), h('td', {}, severityWords(alarm.severity)), h('td', {}, name(alarm.server)), h('td', {}, alarm.message))))));
    }
}
