// Short messages at the edge of the page; refusals stay until they are closed.

import { h, icon, kIcons } from './dom.js';

export type Tone = 'good' | 'note' | 'bad';

const kShown = 6_000;
const kMost = 4;

export class Toasts {
    readonly element = h('div', { class: 'toasts', role: 'status', 'aria-live': 'polite' });

    show(tone: Tone, title: string, text = ''): void {
        const close = h('button', { class: 'plain', 'aria-label': 'Close message', onclick: () => toast.remove() }, icon(kIcons.close));
        const toast = h('div', { class: `toast ${tone}`, role: tone === 'bad' ? 'alert' : null },
            h('div', {}, h('strong', {}, title), text !== '' && h('p', {}, text)), close);
        while (this.element.children.length >= kMost) this.element.firstElementChild?.remove();
        this.element.append(toast);
        if (tone !== 'bad') setTimeout(() => toast.remove(), kShown);
    }
}
