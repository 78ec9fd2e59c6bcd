// The bar on top: which cell, whether it is heard, who is there, who has control, and Halt.

import { controlSummary, type CellState } from '../state/cell_state.js';
import type { Context } from './context.js';
import { h, icon, kIcons, setAttribute, setText } from './dom.js';

const kLinkWords = { connecting: 'Connecting', live: 'Live', lost: 'No connection' };

export interface HeaderActions {
    toggleTheme: () => void;
    help: () => void;
    logOut: () => void;
    logIn: () => void;
}

export class Header {
    readonly element: HTMLElement;
    private readonly cell = h('span', { class: 'cell-name' });
    private readonly link = h('span', { class: 'link-state', role: 'status' });
    private readonly lab = h('span', { class: 'badge warn', title: 'No encryption, no users: this machine only' }, 'Insecure lab');
    private readonly mode = h('span', { class: 'mode', role: 'status' });
    private readonly take: HTMLButtonElement;
    private readonly user: HTMLButtonElement;

    constructor(private readonly context: Context, private readonly on: HeaderActions) {
        this.take = h('button', { class: 'primary', id: 'take-control', onclick: () => this.toggleControl() });
        this.user = h('button', { class: 'plain user', onclick: () => this.toggleUser() });
        this.element = h('header', { class: 'bar' }, this.brand(),
            h('div', { class: 'bar-middle' }, this.mode, this.take),
            h('div', { class: 'bar-end' }, this.user,
                h('button', { class: 'plain', title: 'Light or dark (t)', 'aria-label': 'Light or dark', onclick: on.toggleTheme }, icon(kIcons.sun)),
                h('button', { class: 'plain', title: 'Keys (?)', 'aria-label': 'Keys', onclick: on.help }, icon(kIcons.help)),
                this.haltAll()));
        context.state.subscribe((state) => this.render(state));
    }

    private brand(): HTMLElement {
        return h('div', { class: 'brand' }, h('strong', {}, 'metier'), this.cell, this.link, this.lab);
    }

    private haltAll(): HTMLElement {
        return h('button', {
            class: 'halt all', id: 'halt-all', 'aria-describedby': 'halt-note', title: 'Halt every skill of the cell (Shift+H). Not an emergency stop.',
            onclick: () => void this.context.actions.halt({}, 'all'),
        }, icon(kIcons.stop), h('span', {}, 'Halt all', h('small', { id: 'halt-note' }, 'not an emergency stop')));
    }

    private toggleControl(): void {
        const { state, actions } = this.context;
        void (controlSummary(state.get()) === 'none' ? actions.takeControl() : actions.releaseControl());
    }

    private toggleUser(): void {
        const me = this.context.state.get().me;
        if (me === null || me.user === '') this.on.logIn();
        else this.on.logOut();
    }

    private render(state: CellState): void {
        setText(this.cell, state.cell?.name ?? '');
        setText(this.link, kLinkWords[state.link]);
        setAttribute(this.link, 'data-link', state.link);
        this.lab.hidden = !(state.cell?.lab ?? state.me?.lab ?? false);
        const summary = controlSummary(state);
        const mode = { none: 'Read-only', some: 'You control a part', all: 'You have control' }[summary];
        setText(this.mode, mode);
        setAttribute(this.mode, 'data-control', summary);
        setText(this.take, summary === 'none' ? 'Take control' : 'Release control');
        this.take.disabled = state.link !== 'live';
        this.take.classList.toggle('primary', summary === 'none');
        const name = state.me?.user ?? '';
        this.user.hidden = state.me === null || (name === '' && !state.me.login_required);
        setText(this.user, name === '' ? 'Log in' : name);
        this.user.title = name === '' ? '' : `${state.me?.role ?? ''}: log out`;
    }
}
