// The 3D part of the page: the cell, its tool buttons, the legend, the arms' names, and the replay.

import type { Arm, Cell, Frame, PathPoint } from '../api/types.js';
import { CellView } from '../scene/cell_view.js';
import { PathGhost, Preview, Target, timedPath, type TimedPath } from '../scene/overlays.js';
import { cssGradient } from '../scene/speed_color.js';
import { Viewer, type View } from '../scene/viewer.js';
import type { LiveBuffer } from '../state/live_buffer.js';
import { fill, h, icon, kIcons, setText } from './dom.js';
import { ReplayBar } from './replay_bar.js';
import type { Theme } from './theme.js';

const kPlanColor = '#3d8bfd';

export type TargetValue = { joints: number[] } | { frame: Frame };

/** A recorded execution to be played. */
export interface Run {
    name: string;
    arm: string;
    path: TimedPath;
    color: string;
}

export class Stage {
    readonly element = h('section', { class: 'stage', 'aria-label': 'The cell in 3D' });
    readonly view: CellView | null;
    private readonly viewer: Viewer | null;
    private readonly labels = h('div', { class: 'labels', 'aria-hidden': 'true' });
    private readonly scale = h('span', {});
    private readonly replay_bar = new ReplayBar(() => this.replay([]));
    private planned: Preview | null = null;
    private aimed: { arm: string; overlay: Target } | null = null;
    private ghosts: PathGhost[] = [];
    private readonly names = new Map<string, HTMLElement>();

    constructor(live: LiveBuffer, private readonly chosen: (arm: string) => void) {
        const canvas = h('div', { class: 'canvas' });
        fill(this.element, canvas, this.labels, this.tools(), this.legend(), this.replay_bar.element);
        try {
            this.viewer = new Viewer(canvas, (now) => this.tick(now));
            this.view = new CellView(this.viewer, live);
            this.view.onScale((end) => setText(this.scale, `${end} m/s`));
            this.viewer.canvas.addEventListener('dblclick', (event) => this.pick(event));
            this.viewer.canvas.setAttribute('aria-label', 'The cell; drag to turn, wheel to come nearer, double click an arm to choose it');
        } catch {
            this.viewer = null;
            this.view = null;
            fill(canvas, h('p', { class: 'empty' }, 'This browser shows no 3D (WebGL). Everything else works.'));
        }
    }

    setCell(cell: Cell): void {
        this.view?.setCell(cell);
        this.names.clear();
        fill(this.labels);
        for (const actor of this.view?.actors.values() ?? []) {
            const label = h('span', { class: 'label' }, actor.arm.name);
            this.names.set(actor.arm.key, label);
            this.labels.append(label);
        }
    }

    setTheme(theme: Theme): void {
        this.viewer?.setTheme(theme);
    }

    look(view: View): void {
        this.viewer?.look(view);
    }

    get framesPerSecond(): number {
        return this.viewer?.framesPerSecond ?? 0;
    }

    redraw(): void {
        this.viewer?.requestDraw();
    }

    /** An arm is drawn with a user's meshes now. */
    usesMeshes(arm: string): void {
        this.element.dataset['meshes'] = `${this.element.dataset['meshes'] ?? ''} ${arm}`.trim();
        this.redraw();
    }

    /** Plays a planned path of an arm as a ghost; null ends it. */
    preview(arm: string | null, points: readonly PathPoint[] | null): void {
        if (this.planned !== null) this.view?.remove(this.planned);
        this.planned = null;
        const actor = arm === null ? undefined : this.view?.actors.get(arm);
        if (actor === undefined || points === null || points.length === 0) return;
        this.planned = new Preview(actor, timedPath(points), kPlanColor);
        this.view?.add(this.planned);
    }

    /** Shows where a form's target is; null ends it. */
    target(arm: string | null, value: TargetValue | null): void {
        if (this.aimed !== null && (value === null || this.aimed.arm !== arm)) {
            this.view?.remove(this.aimed.overlay);
            this.aimed = null;
        }
        const actor = arm === null ? undefined : this.view?.actors.get(arm);
        if (actor === undefined || value === null || arm === null) return;
        if (this.aimed === null) {
            this.aimed = { arm, overlay: new Target(actor) };
            this.view?.add(this.aimed.overlay);
        }
        if ('joints' in value) this.aimed.overlay.showJoints(value.joints);
        else this.aimed.overlay.showFrame(value.frame);
    }

    /** Plays recorded executions over the live cell, all from their starts; none ends it. Returns how many can be drawn. */
    replay(runs: readonly Run[]): number {
        for (const ghost of this.ghosts) this.view?.remove(ghost);
        this.ghosts = [];
        const played: Run[] = [];
        for (const run of runs) {
            const actor = this.view?.actors.get(run.arm);
            if (actor === undefined || run.path.time.length === 0) continue;
            const ghost = new PathGhost(actor, run.path, run.color, 0.5);
            this.ghosts.push(ghost);
            this.view?.add(ghost);
            played.push(run);
        }
        this.replay_bar.open(played);
        return played.length;
    }

    private tick(now: number): boolean {
        if (this.replay_bar.isOpen) {
            const time = this.replay_bar.advance(now);
            for (const ghost of this.ghosts) ghost.seek(time);
        }
        const moved = this.view?.update(now) ?? false;
        this.placeLabels();
        return moved;
    }

    private placeLabels(): void {
        for (const actor of this.view?.actors.values() ?? []) {
            const label = this.names.get(actor.arm.key);
            const at = this.viewer?.project(actor.labelPoint()) ?? null;
            if (label === undefined) continue;
            label.hidden = at === null;
            if (at !== null) label.style.transform = `translate(${at.x.toFixed(1)}px, ${at.y.toFixed(1)}px) translate(-50%, 14px)`;
        }
    }

    private pick(event: MouseEvent): void {
        const roots = [...(this.view?.actors.values() ?? [])].map((actor) => actor.view.frames.root);
        const arm = this.viewer?.pick(event.clientX, event.clientY, roots)?.userData['arm'] as Arm['key'] | undefined;
        if (arm !== undefined) this.chosen(arm);
    }

    private tools(): HTMLElement {
        const views: [View, string][] = [['fit', 'Whole cell'], ['top', 'Top'], ['front', 'Front'], ['side', 'Side']];
        const toggle = (name: 'trace' | 'commanded' | 'frames', text: string, title: string): HTMLButtonElement => {
            const button = h('button', {
                'class': 'chip', 'aria-pressed': 'true', title,
                'onclick': () => {
                    if (this.view === null) return;
                    this.view.show[name] = !this.view.show[name];
                    button.setAttribute('aria-pressed', String(this.view.show[name]));
                    this.redraw();
                },
            }, text);
            return button;
        };
        return h('div', { class: 'stage-tools', role: 'toolbar', 'aria-label': 'View' },
            ...views.map(([view, name]) => h('button', { class: 'chip', onclick: () => this.look(view) }, view === 'fit' ? icon(kIcons.fit) : null, name)),
            h('span', { class: 'gap' }),
            toggle('trace', 'Path', 'The way of each tool frame'),
            toggle('commanded', 'Commanded', 'An amber ghost where the commanded position differs from the actual one'),
            toggle('frames', 'Frames', 'The axes of each tool frame'),
            h('button', { class: 'chip', title: 'Forget the paths so far', onclick: () => this.view?.clearTraces() }, 'Clear'));
    }

    private legend(): HTMLElement {
        const gradient = h('i', { class: 'gradient' });
        gradient.style.background = cssGradient();
        return h('div', { class: 'legend' },
            h('div', { class: 'scale' }, h('span', {}, '0'), gradient, this.scale),
            h('span', { class: 'key commanded' }, 'commanded'), h('span', { class: 'key planned' }, 'planned'), h('span', { class: 'key replayed' }, 'replayed'));
    }
}
