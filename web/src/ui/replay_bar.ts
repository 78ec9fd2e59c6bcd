// Time of a replay: play, pause, seek, speed.

import { fill, h, icon, kIcons, setText } from './dom.js';

export interface Played {
    name: string;
    color: string;
    path: { time: readonly number[] };
}

const kSpeeds = [0.25, 0.5, 1, 2, 4];

export class ReplayBar {
    readonly element = h('div', { class: 'replay', role: 'group', 'aria-label': 'Replay', hidden: true });
    private readonly names = h('div', { class: 'replay-names' });
    private readonly play = h('button', { 'class': 'plain', 'aria-label': 'Play or pause' });
    private readonly slider = h('input', { 'type': 'range', 'min': 0, 'step': 0.01, 'value': 0, 'aria-label': 'Time of the replay' });
    private readonly clock = h('output', {});
    private readonly speed = h('select', { 'aria-label': 'Speed of the replay' }, ...kSpeeds.map((speed) => h('option', { value: speed, selected: speed === 1 }, `${speed}\u00d7`)));
    private length = 0;
    private time = 0;
    private last = -1;
    private playing = false;

    constructor(close: () => void) {
        this.play.addEventListener('click', () => this.toggle());
        this.slider.addEventListener('input', () => {
            this.playing = false;
            this.time = Number(this.slider.value);
            this.render();
        });
        fill(this.element, h('strong', {}, 'Replay, not live'), this.names, this.play, this.slider, this.clock, this.speed,
            h('button', { 'class': 'plain', 'aria-label': 'End the replay', 'onclick': close }, icon(kIcons.close)));
    }

    get isOpen(): boolean {
        return !this.element.hidden;
    }

    open(runs: readonly Played[]): void {
        this.element.hidden = runs.length === 0;
        this.length = Math.max(0, ...runs.map((run) => run.path.time.at(-1) ?? 0));
        this.time = 0;
        this.last = -1;
        this.playing = runs.length > 0;
        this.slider.max = String(this.length);
        fill(this.names, ...runs.map((run) => {
            const name = h('span', { class: 'run-name' }, run.name);
            name.style.setProperty('--run', run.color);
            return name;
        }));
        this.render();
    }

    /** The time to draw at `now` [s, monotonic]. */
    advance(now: number): number {
        if (this.playing && this.last >= 0) {
            this.time += (now - this.last) * Number(this.speed.value);
            if (this.time >= this.length) {
                this.time = this.length;
                this.playing = false;
            }
            this.render();
        }
        this.last = now;
        return this.time;
    }

    private toggle(): void {
        this.playing = !this.playing;
        if (this.playing && this.time >= this.length) this.time = 0;
        this.render();
    }

    private render(): void {
        fill(this.play, icon(this.playing ? kIcons.pause : kIcons.play));
        this.slider.value = String(this.time);
        setText(this.clock, `${this.time.toFixed(2)} / ${this.length.toFixed(2)} s`);
    }
}
