// What a person can do. Each says how it went; none throws.

import { ApiError, type Api, type SkillCommand } from '../api/client.js';
import type { CheckResult, Skill } from '../api/types.js';
import type { CellState } from '../state/cell_state.js';
import type { Store } from '../state/store.js';
import type { Toasts } from './toast.js';

const kWords: Record<SkillCommand, string> = { suspend: 'Suspend', resume: 'Resume', reset: 'Reset', halt: 'Halt' };

function textOf(error: unknown): string {
    return error instanceof Error ? error.message : String(error);
}

export class Actions {
    constructor(
        private readonly api: Api,
        private readonly state: Store<CellState>,
        private readonly toasts: Toasts,
        private readonly logInNeeded: () => void,
    ) {}

    private get tab(): string {
        return this.state.get().tab;
    }

    /** Runs a request; a refusal becomes a message with its reason. Returns whether it went well. */
    private async attempt(what: string, request: () => Promise<unknown>): Promise<boolean> {
        try {
            await request();
            return true;
        } catch (error) {
            this.refused(what, error);
            return false;
        }
    }

    refused(what: string, error: unknown): void {
        if (error instanceof ApiError && error.status === 401) this.logInNeeded();
        this.toasts.show('bad', `${what}: not done`, textOf(error));
    }

    takeControl(server = 'all'): Promise<boolean> {
        return this.control('Take control', 'take', server);
    }

    releaseControl(server = 'all'): Promise<boolean> {
        return this.control('Release control', 'release', server);
    }

    private control(what: string, action: 'take' | 'release', server: string): Promise<boolean> {
        return this.attempt(what, async () => {
            const answer = await this.api.control(this.tab, action, server);
            for (const failure of answer.failed ?? []) this.toasts.show('note', `${what} of ${failure.server}: not done`, failure.message);
            const left_out = answer.left_out ?? [];
            if (left_out.length > 0) {
                this.toasts.show('note', `Left out: ${left_out.map((one) => one.server).join(', ')}`,
                    `Used by ${[...new Set(left_out.map((one) => one.used_by))].join(', ')}, which could not move them otherwise. Take one by itself if you want it.`);
            }
        });
    }

    command(skill: Skill, command: SkillCommand): Promise<boolean> {
        return this.attempt(`${kWords[command]} ${skill.display_name}`, () => this.api.skill(this.tab, skill.key, command));
    }

    /** Halts what is named, or all. What could not be halted is named: a person must know. */
    async halt(what: { server?: string; arm?: string }, name: string): Promise<void> {
        try {
            const answer = await this.api.halt(what);
            for (const failure of answer.failed) {
                this.toasts.show('bad', `${failure.server} was NOT halted`, failure.message);
            }
            if (answer.failed.length === 0) this.toasts.show('good', `Halt of ${name} sent`, 'Arms brake on their path. This is not an emergency stop.');
        } catch (error) {
            this.refused(`Halt of ${name}`, error);
        }
    }

    /** The verdict; a request that fails is a verdict, too. */
    async check(skill: Skill, parameters: object): Promise<CheckResult> {
        try {
            return await this.api.check(this.tab, skill.key, parameters);
        } catch (error) {
            if (error instanceof ApiError && error.status === 401) this.logInNeeded();
            return { possible: false, code: error instanceof ApiError ? error.code : 'error', message: textOf(error) };
        }
    }

    start(skill: Skill, parameters: object): Promise<boolean> {
        return this.attempt(`Start ${skill.display_name}`, () => this.api.start(this.tab, skill.key, parameters));
    }
}
