// Times and durations for a person.

function two(value: number): string {
    return String(Math.floor(value)).padStart(2, '0');
}

/** Time of day; with the day if it is another one than `now`'s. Local time of this computer; s since 1970. */
export function timeText(seconds: number, now: number): string {
    const date = new Date(seconds * 1000);
    const day = `${date.getFullYear()}-${two(date.getMonth() + 1)}-${two(date.getDate())}`;
    const time = `${two(date.getHours())}:${two(date.getMinutes())}:${two(date.getSeconds())}`;
    return new Date(now * 1000).toDateString() === date.toDateString() ? time : `${day} ${time}`;
}

/** 0.35 s, 12.4 s, 3 min 05 s, 2 h 10 min. */
export function durationText(seconds: number): string {
    if (!Number.isFinite(seconds) || seconds < 0) return '\u2013';
    if (seconds < 10) return `${seconds.toFixed(2)} s`;
    if (seconds < 60) return `${seconds.toFixed(1)} s`;
    if (seconds < 3600) return `${Math.floor(seconds / 60)} min ${two(seconds % 60)} s`;
    return `${Math.floor(seconds / 3600)} h ${two((seconds % 3600) / 60)} min`;
}

/** HaltedOwnerLost, JointPtpMoveSkill as words. */
export function words(name: string): string {
    return name.replace(/Skill$/, '').replace(/([a-z0-9])([A-Z])/g, '$1 $2').trim();
}

/** The sub-state without its state: HaltedOwnerLost of Halted is "owner lost". */
export function subStateWords(state: string, sub_state: string): string {
    const rest = sub_state.startsWith(state) ? sub_state.slice(state.length) : sub_state;
    return words(rest).toLowerCase();
}
