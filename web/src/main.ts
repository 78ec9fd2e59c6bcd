// Puts the page together: state and stream in, parts of the page around them.

import { api } from './api/client.js';
import { Stream } from './api/stream.js';
import type { LiveEvent, Me, Snapshot } from './api/types.js';
import { afterEvent, afterLoss, controlSummary, kNothing, type CellState } from './state/cell_state.js';
import { LiveBuffer } from './state/live_buffer.js';
import { Store } from './state/store.js';
import { Actions } from './ui/actions.js';
import { Below, kTabs } from './ui/below.js';
import { frameTime, wallTime, type Choice, type Context, type Pane } from './ui/context.js';
import { Help, LogIn } from './ui/dialogs.js';
import { fill, h } from './ui/dom.js';
import { Header } from './ui/header.js';
import { RunPanel } from './ui/run_panel.js';
import { ServerList } from './ui/server_list.js';
import { listenToKeys } from './ui/shortcuts.js';
import { Stage } from './ui/stage.js';
import { ThemeSwitch } from './ui/theme.js';
import { Toasts } from './ui/toast.js';

/** Soon, also in a tab that is not seen: frames rest there, and states should not. */
function soon(tell: () => void): void {
    setTimeout(tell, 16);
}

/**
 * How long a tab that nobody sees keeps its stream, unless it has control [ms]. A browser has six connections to a
 * server for all its tabs: those that rest leave theirs to the one that is to halt.
 */
const kUnseen = 5_000;

const kPanes: [Pane, string][] = [['stage', 'Cell'], ['skills', 'Skills'], ['run', 'Run'], ['below', 'History']];

class App {
    private readonly state = new Store<CellState>(kNothing, soon);
    private readonly choice = new Store<Choice>({ skill: null, arm: null, tab: 'plots', pane: 'stage' }, soon);
    private readonly live = new LiveBuffer();
    private readonly toasts = new Toasts();
    private readonly stage = new Stage(this.live, (arm) => this.choice.update((choice) => ({ ...choice, arm })));
    private readonly actions = new Actions(api, this.state, this.toasts, () => this.log_in.open());
    private readonly context: Context = {
        api, state: this.state, choice: this.choice, live: this.live, actions: this.actions, stage: this.stage,
    };
    private readonly log_in = new LogIn(api, (me) => void this.welcome(me), () => this.state.get().me?.login_required === true && this.state.get().me?.user === '');
    private readonly help = new Help();
    private readonly run = new RunPanel(this.context);
    private readonly below = new Below(this.context);
    private readonly theme = new ThemeSwitch((theme) => {
        this.stage.setTheme(theme);
        this.below?.redraw();
    });
    private stream: Stream | null = null;
    private unseen = 0;

    constructor(root: HTMLElement) {
        const header = new Header(this.context, {
            toggleTheme: () => this.theme.toggle(), help: () => this.help.open(), logIn: () => this.log_in.open(), logOut: () => void this.logOut(),
        });
        const panes = this.panes();
        fill(root, header.element, h('main', { class: 'layout', 'data-pane': 'stage', 'id': 'layout' },
            new ServerList(this.context).element, this.stage.element, this.run.element, this.below.element),
        panes, this.toasts.element, this.log_in.element, this.help.element);
        this.keys();
        document.addEventListener('visibilitychange', () => this.seenOrNot());
        void this.begin();
    }

    private seenOrNot(): void {
        clearTimeout(this.unseen);
        if (document.visibilityState === 'visible') {
            // Servers may have come meanwhile. If the dashboard is away, the stream says so.
            if (this.stream?.resume() === true) this.loadCell().catch(() => undefined);
        } else this.unseen = window.setTimeout(() => this.rest(), kUnseen);
    }

    private rest(): void {
        if (controlSummary(this.state.get()) !== 'none') return;
        this.stream?.rest();
        this.live.forgetClock();
        this.state.update(afterLoss);
    }

    private async begin(): Promise<void> {
        try {
            await this.welcome(await api.me());
        } catch (error) {
            this.toasts.show('bad', 'The dashboard does not answer', error instanceof Error ? error.message : '');
            setTimeout(() => void this.begin(), 2000);
        }
    }

    private async welcome(me: Me): Promise<void> {
        this.state.update((state) => ({ ...state, me }));
        this.stream?.close();
        if (me.login_required && me.user === '') {
            this.log_in.open();
            return;
        }
        await this.loadCell();
        this.stream = new Stream('/api/stream', (name, data) => this.receive(name, data), () => this.lost());
        this.seenOrNot();
    }

    private async loadCell(): Promise<void> {
        const cell = await api.cell();
        this.state.update((state) => ({ ...state, cell }));
        this.choice.update((choice) => ({ ...choice, arm: choice.arm ?? cell.arms[0]?.key ?? null }));
        document.title = `${cell.name} \u2013 metier`;
        this.stage.setCell(cell);
        const view = this.stage.view;
        if (view !== null && cell.meshes === true) void import('./scene/user_meshes.js').then((meshes) => meshes.useUserMeshes(view, (arm) => this.stage.usesMeshes(arm)));
    }

    private receive(name: string, data: unknown): void {
        if (name === 'live') this.live.add(data as LiveEvent, frameTime());
        else if (name === 'cell') void this.loadCell();
        else this.state.update((state) => afterEvent(state, name, data, wallTime()));
        const live = name === 'snapshot' ? (data as Snapshot).live : undefined;
        if (live !== undefined && live !== null) this.live.add(live, frameTime());
    }

    private lost(): void {
        this.live.forgetClock();
        this.state.update(afterLoss);
        // A log-in that is over ends the stream, too.
        api.me().then((me) => {
            if (!me.login_required || me.user !== '') return;
            this.stream?.close();
            this.state.update((state) => ({ ...state, me }));
            this.log_in.open();
        }, () => undefined);
    }

    private async logOut(): Promise<void> {
        await api.logout().catch((error: unknown) => this.actions.refused('Log out', error));
        location.reload();
    }

    private panes(): HTMLElement {
        const buttons = kPanes.map(([pane, name]) => h('button', { onclick: () => this.choice.update((choice) => ({ ...choice, pane })) }, name));
        this.choice.subscribe((choice) => {
            document.getElementById('layout')?.setAttribute('data-pane', choice.pane);
            kPanes.forEach(([pane], i) => buttons[i]?.setAttribute('aria-pressed', String(pane === choice.pane)));
        });
        return h('nav', { 'class': 'panes', 'aria-label': 'Parts of the page' }, ...buttons);
    }

    private keys(): void {
        const tab = (index: number): void => this.choice.update((choice) => ({ ...choice, tab: kTabs[index] ?? choice.tab, pane: 'below' }));
        listenToKeys({
            haltAll: () => void this.actions.halt({}, 'all'),
            haltArm: () => this.haltArm(),
            takeControl: () => void (controlSummary(this.state.get()) === 'none' && this.actions.takeControl()),
            tab,
            search: () => {
                tab(1);
                setTimeout(() => this.below.timeline.search.focus(), 50);
            },
            fit: () => this.stage.look('fit'), theme: () => this.theme.toggle(), help: () => this.help.open(),
            check: () => void this.run.check(), start: () => void this.run.start(),
        });
    }

    private haltArm(): void {
        const arm = this.choice.get().arm;
        if (arm !== null) void this.actions.halt({ arm }, this.state.get().cell?.arms.find((one) => one.key === arm)?.name ?? arm);
    }
}

const root = document.getElementById('app');
if (root !== null) {
    const app = new App(root);
    // For a look from the browser's console.
    Object.assign(window, { metier: app });
}
