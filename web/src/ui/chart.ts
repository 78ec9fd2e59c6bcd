// A line chart of time by uPlot, in the colours of the page.

import uPlot from 'uplot';
import { fill, h } from './dom.js';

export const kSeriesColors = ['#4f8fe8', '#e0873a', '#45a86b', '#b06fd8', '#d6555f', '#2aa5b3', '#b59a2c'];

export interface ChartSeries {
    label: string;
    color?: string;
    dash?: number[];
}

function css(name: string): string {
    return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

function axis(size: number): uPlot.Axis {
    return {
        stroke: () => css('--text-weak'), grid: { stroke: () => css('--line-weak'), width: 1 }, ticks: { show: false },
        font: '11px system-ui, sans-serif', size, gap: 3, space: size === 20 ? 60 : 26,
    };
}

/** A chart that fills its element. `x` is in s: the last `window` seconds, or all there is. `least_span` of y at least is shown. */
export class Chart {
    readonly element: HTMLElement;
    private readonly box = h('div', { class: 'chart-box' });
    private readonly caption = h('figcaption', {});
    private plot: uPlot | null = null;
    private data: uPlot.AlignedData = [[]];
    private signature = '';

    constructor(title: string, unit: string, private readonly sync: string, private readonly least_span = 0, private readonly window = 0) {
        this.element = h('figure', { class: 'chart' }, this.caption, this.box);
        this.setTitle(title, unit);
        new ResizeObserver(() => this.resize()).observe(this.box);
    }

    setTitle(title: string, unit: string): void {
        if (this.caption.textContent !== `${title} ${unit}`) fill(this.caption, title, h('small', {}, ` ${unit}`));
    }

    setData(series: readonly ChartSeries[], data: uPlot.AlignedData): void {
        this.data = data;
        const signature = series.map((one) => `${one.label}${one.color ?? ''}`).join('|');
        if (this.plot === null || signature !== this.signature) {
            this.signature = signature;
            this.make(series);
        } else {
            this.plot.setData(data);
        }
    }

    /** After a change of theme. */
    redraw(): void {
        this.plot?.redraw(false);
    }

    private make(series: readonly ChartSeries[]): void {
        this.plot?.destroy();
        const { clientWidth: width, clientHeight: height } = this.box;
        const options: uPlot.Options = {
            width: Math.max(width, 50), height: Math.max(height, 40),
            legend: { show: false }, cursor: { sync: { key: this.sync }, drag: { x: false, y: false }, points: { size: 5 } },
            scales: { x: { time: false, ...(this.window > 0 ? { range: [-this.window, 0] as uPlot.Range.MinMax } : {}) }, y: { range: (_plot, low, high) => this.range(low, high) } },
            axes: [axis(20), axis(46)],
            padding: [6, 6, 0, 0],
            series: [{}, ...series.map((one, i) => ({
                label: one.label, stroke: one.color ?? (kSeriesColors[i % kSeriesColors.length] as string), width: 1.5,
                ...(one.dash === undefined ? {} : { dash: one.dash }), points: { show: false }, spanGaps: true,
            }))],
        };
        this.plot = new uPlot(options, this.data, this.box);
    }

    private range(low: number | null, high: number | null): uPlot.Range.MinMax {
        if (low === null || high === null) return [0, Math.max(1, this.least_span)];
        const span = Math.max(high - low, this.least_span, 1e-9);
        const middle = (high + low) / 2;
        return [middle - span * 0.56, middle + span * 0.56];
    }

    private resize(): void {
        const { clientWidth: width, clientHeight: height } = this.box;
        if (width > 0 && height > 0) this.plot?.setSize({ width, height });
    }
}
