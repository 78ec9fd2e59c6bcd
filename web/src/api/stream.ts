// The stream of server-sent events of this tab. It is silent for at most a second (`beat`): longer silence is a loss.

export type StreamHandler = (name: string, data: unknown) => void;

const kEvents = ['hello', 'cell', 'snapshot', 'skill', 'control', 'server', 'alarm', 'live', 'execution', 'beat'];

/** Longest silence before the stream is given up and opened anew [ms]. */
const kSilence = 5_000;

/** Reconnects by itself until closed. Calls `lost` once for each loss. */
export class Stream {
    private source: EventSource | null = null;
    private watchdog = 0;
    private closed = false;

    constructor(
        private readonly url: string,
        private readonly handle: StreamHandler,
        private readonly lost: () => void,
    ) {
        this.open();
    }

    close(): void {
        this.closed = true;
        this.drop();
    }

    /** Gives its connection back until resume(). */
    rest(): void {
        this.drop();
    }

    /** Whether it rested, or was about to open anew. */
    resume(): boolean {
        if (this.closed || this.source !== null) return false;
        clearTimeout(this.watchdog);
        this.open();
        return true;
    }

    private open(): void {
        const source = new EventSource(this.url);
        this.source = source;
        for (const name of kEvents) {
            source.addEventListener(name, (event) => this.receive(name, (event as MessageEvent<string>).data));
        }
        source.onerror = () => this.again();
        this.feed();
    }

    private receive(name: string, text: string): void {
        this.feed();
        if (name === 'beat') return;
        this.handle(name, JSON.parse(text) as unknown);
    }

    private feed(): void {
        clearTimeout(this.watchdog);
        this.watchdog = window.setTimeout(() => this.again(), kSilence);
    }

    private drop(): void {
        clearTimeout(this.watchdog);
        this.source?.close();
        this.source = null;
    }

    private again(): void {
        this.drop();
        if (this.closed) return;
        this.lost();
        this.watchdog = window.setTimeout(() => this.open(), 1000);
    }
}
