// Light or dark: as the system has it, until a person chooses.

export type Theme = 'light' | 'dark';

const kKey = 'metier.theme';

function chosen(): Theme | null {
    const value = localStorage.getItem(kKey);
    return value === 'light' || value === 'dark' ? value : null;
}

export class ThemeSwitch {
    private readonly system = matchMedia('(prefers-color-scheme: dark)');

    constructor(private readonly changed: (theme: Theme) => void) {
        this.system.addEventListener('change', () => this.apply());
        this.apply();
    }

    get theme(): Theme {
        return chosen() ?? (this.system.matches ? 'dark' : 'light');
    }

    toggle(): void {
        localStorage.setItem(kKey, this.theme === 'dark' ? 'light' : 'dark');
        this.apply();
    }

    private apply(): void {
        document.documentElement.dataset['theme'] = this.theme;
        this.changed(this.theme);
    }
}
