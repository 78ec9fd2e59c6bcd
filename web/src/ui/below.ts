// The tabs below the cell: plots, timeline, alarms.

import { Alarms } from './alarms.js';
import type { Context, Tab } from './context.js';
import { h, setText } from './dom.js';
import { Plots } from './plots.js';
import { Timeline } from './timeline.js';

export const kTabs: Tab[] = ['plots', 'timeline', 'alarms'];
const kNames: Record<Tab, string> = { plots: 'Plots', timeline: 'Timeline', alarms: 'Alarms' };

export class Below {
    readonly element: HTMLElement;
    readonly timeline: Timeline;
    private readonly plots: Plots;
    private readonly panels: Record<Tab, HTMLElement>;
    private readonly buttons: Record<Tab, HTMLButtonElement>;

    constructor(private readonly context: Context) {
        this.plots = new Plots(context);
        this.timeline = new Timeline(context);
        const alarms = new Alarms(context);
        this.panels = { plots: this.plots.element, timeline: this.timeline.element, alarms: alarms.element };
        this.buttons = Object.fromEntries(kTabs.map((tab) => [tab, this.button(tab)])) as Record<Tab, HTMLButtonElement>;
        for (const tab of kTabs) {
            this.panels[tab].id = `panel-${tab}`;
            this.panels[tab].setAttribute('role', 'tabpanel');
            this.panels[tab].setAttribute('aria-labelledby', `tab-${tab}`);
        }
        this.element = h('section', { class: 'panel below', 'aria-label': 'Plots and history' },
            h('div', { class: 'tabs', role: 'tablist' }, ...kTabs.map((tab) => this.buttons[tab])), ...kTabs.map((tab) => this.panels[tab]));
        context.choice.subscribe((choice) => this.render(choice.tab));
        context.state.subscribe((state) => setText(this.buttons.alarms, state.alarms.length === 0 ? 'Alarms' : `Alarms (${state.alarms.length})`));
    }

    /** After a change of theme. */
    redraw(): void {
        this.plots.redraw();
        this.timeline.redraw();
    }

    private button(tab: Tab): HTMLButtonElement {
        return h('button', {
            'role': 'tab', 'id': `tab-${tab}`, 'aria-controls': `panel-${tab}`,
            'onclick': () => this.context.choice.update((choice) => ({ ...choice, tab })),
            'onkeydown': (event: KeyboardEvent) => this.step(tab, event),
        }, kNames[tab]);
    }

    private step(tab: Tab, event: KeyboardEvent): void {
        const step = event.key === 'ArrowRight' ? 1 : event.key === 'ArrowLeft' ? -1 : 0;
        if (step === 0) return;
        const next = kTabs[(kTabs.indexOf(tab) + step + kTabs.length) % kTabs.length] as Tab;
        this.context.choice.update((choice) => ({ ...choice, tab: next }));
        this.buttons[next].focus();
    }

    private render(chosen: Tab): void {
        for (const tab of kTabs) {
            this.panels[tab].hidden = tab !== chosen;
            this.buttons[tab].setAttribute('aria-selected', String(tab === chosen));
            this.buttons[tab].tabIndex = tab === chosen ? 0 : -1;
        }
    }
}
