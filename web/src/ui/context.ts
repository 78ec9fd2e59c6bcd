// What every part of the page works with.

import type { Api } from '../api/client.js';
import type { Arm, Skill } from '../api/types.js';
import type { CellState } from '../state/cell_state.js';
import type { LiveBuffer } from '../state/live_buffer.js';
import type { Store } from '../state/store.js';
import type { Actions } from './actions.js';
import type { Stage } from './stage.js';

export type Tab = 'plots' | 'timeline' | 'alarms';
/** What a narrow screen shows. */
export type Pane = 'stage' | 'skills' | 'run' | 'below';

export interface Choice {
    readonly skill: string | null;
    readonly arm: string | null;
    readonly tab: Tab;
    readonly pane: Pane;
}

export interface Context {
    readonly api: Api;
    readonly state: Store<CellState>;
    readonly choice: Store<Choice>;
    readonly live: LiveBuffer;
    readonly actions: Actions;
    readonly stage: Stage;
}

export function findSkill(state: CellState, key: string | null): Skill | null {
    if (key === null) return null;
    for (const server of state.cell?.servers ?? []) {
        const skill = server.skills.find((candidate) => candidate.key === key);
        if (skill !== undefined) return skill;
    }
    return null;
}

export function findArm(state: CellState, key: string | null | undefined): Arm | null {
    return state.cell?.arms.find((arm) => arm.key === key) ?? null;
}

/** s since 1970 by this computer. */
export function wallTime(): number {
    return Date.now() / 1000;
}

/** Monotonic [s]; the clock of the frames. */
export function frameTime(): number {
    return performance.now() / 1000;
}
