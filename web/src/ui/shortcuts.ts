// Keys of the page. Single letters count only where nobody is typing; nothing that moves an arm is on one.

export interface Shortcuts {
    haltAll: () => void;
    haltArm: () => void;
    takeControl: () => void;
    tab: (index: number) => void;
    search: () => void;
    fit: () => void;
    theme: () => void;
    help: () => void;
    check: () => void;
    start: () => void;
}

function isTyping(target: EventTarget | null): boolean {
    return target instanceof HTMLElement && target.matches('input:not([type=checkbox]):not([type=range]), select, textarea');
}

function formKey(event: KeyboardEvent, on: Shortcuts): boolean {
    if (event.key !== 'Enter' || !(event.target instanceof HTMLElement) || event.target.closest('.form') === null) return false;
    if (event.target.matches('button, summary')) return false;
    if (event.ctrlKey || event.metaKey) on.start();
    else on.check();
    return true;
}

export function listenToKeys(on: Shortcuts): void {
    const plain: Record<string, () => void> = {
        'H': on.haltAll, 'h': on.haltArm, 'c': on.takeControl, '1': () => on.tab(0), '2': () => on.tab(1), '3': () => on.tab(2),
        '/': on.search, 'f': on.fit, 't': on.theme, '?': on.help,
    };
    document.addEventListener('keydown', (event) => {
        if (formKey(event, on)) {
            event.preventDefault();
            return;
        }
        if (isTyping(event.target) || event.ctrlKey || event.metaKey || event.altKey || event.repeat) return;
        if (document.querySelector('dialog[open]') !== null && event.key !== 'H') return;
        const act = plain[event.key];
        if (act === undefined) return;
        event.preventDefault();
        act();
    });
}
