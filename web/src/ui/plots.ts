// Live plots of one arm over the last half minute.

import type { AlignedData } from 'uplot';
import type { TimedSample } from '../state/live_buffer.js';
import { Chart, kSeriesColors, type ChartSeries } from './chart.js';
import { findArm, frameTime, type Context } from './context.js';
import { fill, h } from './dom.js';

/** Drawn so often while the plots are seen [ms]. */
const kPeriod = 120;
const kWindow = 30;
const kForceNames = ['fx', 'fy', 'fz', 'tx', 'ty', 'tz'];

type Column = (sample: TimedSample) => number | null | undefined;

/** Columns for uPlot: time against `now` [s], then a column for each series. */
export function columnsOf(samples: readonly TimedSample[], now: number, columns: readonly Column[]): AlignedData {
    const recent = samples.filter((sample) => sample.t >= now - kWindow);
    const last = samples.at(-1);
    // Nothing is sent while nothing moves: the last sample holds until now.
    if (last !== undefined && last.t < now) recent.push({ ...last, t: now });
    const time = recent.map((sample) => sample.t - now);
    return [time, ...columns.map((column) => recent.map((sample) => column(sample) ?? null))] as AlignedData;
}

export class Plots {
    readonly element: HTMLElement;
    private readonly position = new Chart('Joint position', 'rad', 'live', 0.02, kWindow);
    private readonly velocity = new Chart('Joint velocity', 'rad/s', 'live', 0.02, kWindow);
    private readonly force = new Chart('Force', 'N, N m', 'live', 1, kWindow);
    private readonly jitter = new Chart('Cycle jitter', 'ms', 'live', 0.1, kWindow);
    private readonly names = h('div', { class: 'series' });
    private readonly arms = h('div', { class: 'segments', role: 'group', 'aria-label': 'Arm' });
    private drawn_arm: string | null = null;

    constructor(private readonly context: Context) {
        this.element = h('div', { class: 'plots' }, h('div', { class: 'plots-head' }, this.arms, this.names),
            h('div', { class: 'charts' }, this.position.element, this.velocity.element, this.force.element, this.jitter.element));
        context.state.subscribe(() => this.renderArms());
        context.choice.subscribe(() => this.renderArms());
        setInterval(() => this.draw(), kPeriod);
    }

    redraw(): void {
        for (const chart of [this.position, this.velocity, this.force, this.jitter]) chart.redraw();
    }

    private get arm(): string | null {
        const state = this.context.state.get();
        return this.context.choice.get().arm ?? state.cell?.arms[0]?.key ?? null;
    }

    private renderArms(): void {
        const cell = this.context.state.get().cell;
        const chosen = this.arm;
        const key = `${chosen ?? ''}|${cell?.arms.map((arm) => arm.key).join() ?? ''}`;
        if (key === this.drawn_arm) return;
        this.drawn_arm = key;
        fill(this.arms, ...(cell?.arms ?? []).map((arm) => h('button', {
            'aria-pressed': String(arm.key === chosen), 'onclick': () => this.context.choice.update((choice) => ({ ...choice, arm: arm.key })),
        }, arm.name)));
        const joints = findArm(this.context.state.get(), chosen)?.joints ?? [];
        fill(this.names, ...joints.map((joint, i) => {
            const name = h('span', { class: 'series-name' }, joint.name);
            name.style.setProperty('--run', kSeriesColors[i % kSeriesColors.length] as string);
            return name;
        }));
    }

    private draw(): void {
        const key = this.arm;
        if (key === null || this.element.offsetParent === null) return;
        const samples = this.context.live.arm(key).samples;
        const now = Math.max(this.context.live.drawTime(frameTime()), samples.at(-1)?.t ?? 0);
        const joints = findArm(this.context.state.get(), key)?.joints ?? [];
        const series: ChartSeries[] = joints.map((joint) => ({ label: joint.name }));
        this.position.setData(series, columnsOf(samples, now, joints.map((_, i) => (sample) => sample.q?.[i])));
        this.velocity.setData(series, columnsOf(samples, now, joints.map((_, i) => (sample) => sample.v?.[i])));
        this.force.setData(kForceNames.map((label) => ({ label })), columnsOf(samples, now, kForceNames.map((_, i) => (sample) => sample.f?.[i])));
        const told = samples.some((sample) => sample.jitter !== undefined);
        this.jitter.setTitle(told ? 'Cycle jitter' : 'Missed cycles', told ? 'ms' : '');
        this.jitter.setData([{ label: 'cycle' }], columnsOf(samples, now, [(sample) => (told ? (sample.jitter ?? 0) * 1000 : sample.missed)]));
        this.force.element.classList.toggle('none', !samples.some((sample) => sample.f !== undefined));
        this.jitter.element.classList.toggle('none', !told && !samples.some((sample) => sample.missed !== undefined));
    }
}
