// Log-in and the list of keys, as dialogs of the browser: focus stays inside, Escape closes.

import type { Api } from '../api/client.js';
import type { Me } from '../api/types.js';
import { h, setText } from './dom.js';

export class LogIn {
    readonly element: HTMLDialogElement;
    private readonly user = h('input', { name: 'user', autocomplete: 'username', required: true, id: 'login-user' });
    private readonly password = h('input', { name: 'password', type: 'password', autocomplete: 'current-password', id: 'login-password' });
    private readonly error = h('p', { class: 'field-error', role: 'alert' });
    private readonly submit = h('button', { class: 'primary', type: 'submit' }, 'Log in');

    /** \param required whether nothing can be seen without it: then Escape does not close */
    constructor(private readonly api: Api, private readonly done: (me: Me) => void, private readonly required: () => boolean) {
        this.element = h('dialog', { 'class': 'dialog', 'aria-labelledby': 'login-title' }, h('form', { onsubmit: (event: Event) => this.send(event) },
            h('h2', { id: 'login-title' }, 'Log in'), h('p', { class: 'hint' }, 'With the user and password of the cell\u2019s servers.'),
            h('label', { for: 'login-user' }, 'User'), this.user, h('label', { for: 'login-password' }, 'Password'), this.password, this.error, this.submit));
        this.element.addEventListener('cancel', (event) => this.required() && event.preventDefault());
    }

    open(): void {
        if (!this.element.open) this.element.showModal();
    }

    private send(event: Event): void {
        event.preventDefault();
        this.submit.disabled = true;
        setText(this.error, '');
        this.api.login(this.user.value, this.password.value).then(
            (me) => {
                this.element.close();
                this.done(me);
            },
            (error: unknown) => setText(this.error, error instanceof Error ? error.message : String(error)),
        ).finally(() => {
            this.password.value = '';
            this.submit.disabled = false;
        });
    }
}

const kKeys: [string, string][] = [
    ['Shift H', 'Halt all (not an emergency stop)'], ['H', 'Halt the chosen arm'], ['C', 'Take control'],
    ['Enter', 'in a form: Check'], ['Ctrl Enter', 'in a form: Check, then Start'],
    ['\u2191 \u2193', 'in a number: step; with Shift \u00d710, with Alt \u00f710'], ['1 2 3', 'Plots, timeline, alarms'], ['/', 'Search executions'],
    ['F', 'Whole cell in view'], ['T', 'Light or dark'], ['?', 'These keys'],
];

export class Help {
    readonly element = h('dialog', { 'class': 'dialog', 'aria-labelledby': 'help-title' }, h('h2', { id: 'help-title' }, 'Keys'),
        h('dl', { class: 'keys' }, ...kKeys.flatMap(([keys, meaning]) => [h('dt', {}, h('kbd', {}, keys)), h('dd', {}, meaning)])),
        h('p', { class: 'hint' }, 'metier is not safety-rated. Halt brakes arms on their path; in danger use the emergency stop of the cell.'),
        h('form', { method: 'dialog' }, h('button', { class: 'primary' }, 'Close')));

    open(): void {
        if (!this.element.open) this.element.showModal();
    }
}
