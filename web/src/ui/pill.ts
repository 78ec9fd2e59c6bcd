// A state as colour, shape and word.

import { h, setAttribute, setText } from './dom.js';

const kUnknown = 'unknown';

export class Pill {
    readonly element = h('span', { class: 'pill' }, h('i', { 'aria-hidden': 'true' }), h('b', {}));

    set(state: string, old = false): void {
        const name = state === '' ? kUnknown : state;
        setAttribute(this.element, 'data-state', name.toLowerCase());
        this.element.classList.toggle('old', old);
        setText(this.element.lastElementChild as Element, name === kUnknown ? 'Unknown' : name);
    }
}
