// A value with listeners for its changes. Listeners are called once per frame at most.

export type Listener<T> = (value: T) => void;

export class Store<T> {
    private readonly listeners = new Set<Listener<T>>();
    private scheduled = false;

    /** \param schedule calls the function soon, once; in the browser by the next frame. */
    constructor(
        private value: T,
        private readonly schedule: (tell: () => void) => void,
    ) {}

    get(): T {
        return this.value;
    }

    update(change: (value: T) => T): void {
        const next = change(this.value);
        if (next === this.value) return;
        this.value = next;
        if (this.scheduled) return;
        this.scheduled = true;
        this.schedule(() => {
            this.scheduled = false;
            for (const listener of this.listeners) listener(this.value);
        });
    }

    /** Calls at once with the value of now, then on each change. Returns what ends it. */
    subscribe(listener: Listener<T>): () => void {
        this.listeners.add(listener);
        listener(this.value);
        return () => this.listeners.delete(listener);
    }
}
