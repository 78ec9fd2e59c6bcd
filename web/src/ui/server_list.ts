// Every server and skill with its state, owner, lease, step and last error; grouped by the arm they move.

import type { Arm, Cell, Server } from '../api/types.js';
import type { CellState } from '../state/cell_state.js';
import type { Context } from './context.js';
import { fill, h, icon, kIcons, setText } from './dom.js';
import { words } from './format.js';
import { ServerCard } from './server_card.js';

export interface Group {
    arm: Arm | null;
    name: string;
    detail: string;
    servers: Server[];
}

/** The arm whose server it is, or that all its skills move. */
function armOf(server: Server, arms: readonly Arm[]): string | null {
    const own = arms.find((arm) => arm.server === server.key || arm.key === server.arm);
    if (own !== undefined) return own.key;
    const moved = new Set(server.skills.map((skill) => skill.arm));
    const [only] = moved;
    return moved.size === 1 && only !== undefined ? only : null;
}

/** Arms in their order with their servers, then every other server by itself. */
export function groupsOf(cell: Cell): Group[] {
    const groups: Group[] = cell.arms.map((arm) => ({
        arm, name: arm.name, detail: `${arm.maker} ${arm.product}`.trim(), servers: [],
    }));
    for (const server of cell.servers) {
        const key = armOf(server, cell.arms);
        const group = groups.find((candidate) => candidate.arm !== null && candidate.arm.key === key);
        if (group !== undefined) group.servers.push(server);
        else groups.push({ arm: null, name: server.name, detail: '', servers: [server] });
    }
    return groups.filter((group) => group.servers.length > 0);
}

export class ServerList {
    readonly element = h('nav', { class: 'panel servers', id: 'skills', tabindex: '-1', 'aria-label': 'Servers and skills' });
    private cards: ServerCard[] = [];
    private safety: { arm: string; badge: HTMLElement }[] = [];
    private drawn: Cell | null = null;

    constructor(private readonly context: Context) {
        context.state.subscribe((state) => this.render(state));
        context.choice.subscribe(() => this.render(context.state.get()));
        // Leases count down between the events.
        setInterval(() => this.renderLive(), 200);
    }

    private render(state: CellState): void {
        if (state.cell !== this.drawn) this.build(state.cell);
        for (const card of this.cards) card.render(state, this.context.choice.get());
    }

    private renderLive(): void {
        for (const card of this.cards) card.renderLease(this.context.state.get());
        for (const { arm, badge } of this.safety) {
            const safety = this.context.live.arm(arm).latest?.safety ?? '';
            const usual = safety === '' || /^(normal|unknown)$/i.test(safety);
            badge.hidden = usual;
            if (!usual) setText(badge, words(safety));
        }
    }

    private build(cell: Cell | null): void {
        this.drawn = cell;
        this.cards = [];
        this.safety = [];
        if (cell === null) {
            fill(this.element, h('p', { class: 'empty' }, 'Waiting for the cell\u2026'));
            return;
        }
        fill(this.element, ...groupsOf(cell).map((group) => this.group(group)));
    }

    private group(group: Group): HTMLElement {
        const cards = group.servers.map((server) => new ServerCard(this.context, server, group.servers.length > 1 || group.arm !== null));
        this.cards.push(...cards);
        const badge = h('span', { class: 'badge warn', hidden: true, role: 'status' });
        if (group.arm !== null) this.safety.push({ arm: group.arm.key, badge });
        return h('section', { class: 'group', 'aria-label': group.name },
            h('div', { class: 'group-head' },
                h('div', {}, h('h2', {}, group.name), h('small', {}, group.detail), badge),
                this.haltButton(group)),
            ...cards.map((card) => card.element));
    }

    private haltButton(group: Group): HTMLElement {
        const what = group.arm !== null ? { arm: group.arm.key } : { server: (group.servers[0] as Server).key };
        return h('button', {
            class: 'halt', title: `Halt ${group.name}. Not an emergency stop.`, 'aria-label': `Halt ${group.name}, not an emergency stop`,
            onclick: () => void this.context.actions.halt(what, group.name),
        }, icon(kIcons.stop), 'Halt');
    }
}
