// Elements without markup in strings: text is always a text node, so data can never become markup.

type Child = Node | string | null | undefined | false;

type Properties = Record<string, string | number | boolean | null | undefined | ((event: never) => void)>;

function setProperty(element: Element, name: string, value: Properties[string]): void {
    if (value === null || value === undefined || value === false) return;
    if (typeof value === 'function') {
        element.addEventListener(name.slice(2), value as (event: Event) => void);
    } else {
        element.setAttribute(name, value === true ? '' : String(value));
    }
}

/** An element: attributes by name, listeners as `onclick`, children as nodes or text. */
export function h<K extends keyof HTMLElementTagNameMap>(
    tag: K, properties: Properties = {}, ...children: Child[]
): HTMLElementTagNameMap[K] {
    const element = document.createElement(tag);
    for (const [name, value] of Object.entries(properties)) setProperty(element, name, value);
    append(element, children);
    return element;
}

const kSvg = 'http://www.w3.org/2000/svg';

export function svg(tag: string, properties: Properties = {}, ...children: Child[]): SVGElement {
    const element = document.createElementNS(kSvg, tag);
    for (const [name, value] of Object.entries(properties)) setProperty(element, name, value);
    append(element, children);
    return element;
}

function append(element: Element, children: Child[]): void {
    for (const child of children) {
        if (child !== null && child !== undefined && child !== false) element.append(child);
    }
}

/** Sets the text only if it differs: no work for the browser where nothing changed. */
export function setText(element: Element, text: string): void {
    if (element.textContent !== text) element.textContent = text;
}

export function setClass(element: Element, name: string, on: boolean): void {
    if (element.classList.contains(name) !== on) element.classList.toggle(name, on);
}

export function setAttribute(element: Element, name: string, value: string): void {
    if (element.getAttribute(name) !== value) element.setAttribute(name, value);
}

/** Replaces all children. */
export function fill(element: Element, ...children: Child[]): void {
    element.replaceChildren();
    append(element, children);
}

/** An icon of 16 by 16 from one path. */
export function icon(path: string): SVGElement {
    return svg('svg', { class: 'icon', viewBox: '0 0 16 16', 'aria-hidden': 'true' }, svg('path', { d: path }));
}

export const kIcons = {
    play: 'M4 2.5v11l9-5.5z',
    pause: 'M4 3h3v10H4zM9 3h3v10H9z',
    stop: 'M3.5 3.5h9v9h-9z',
    check: 'M6.4 12.6 2 8.2l1.5-1.5 2.9 2.9 6.1-6.1L14 5z',
    reset: 'M8 3V.5L4 4l4 3.5V5a3.5 3.5 0 1 1-3.5 3.5h-2A5.5 5.5 0 1 0 8 3z',
    close: 'M3 4.4 4.4 3 8 6.6 11.6 3 13 4.4 9.4 8l3.6 3.6-1.4 1.4L8 9.4 4.4 13 3 11.6 6.6 8z',
    fit: 'M2 2h4v1.6H3.6V6H2zM10 2h4v4h-1.600V3.600H10zM2 10h1.600v2.400H6V14H2zM12.400 10H14v4h-4v-1.600h2.400z',
    sun: 'M8 4.500a3.500 3.500 0 1 0 0 7 3.500 3.500 0 0 0 0-7zM7.300 0h1.400v2.600H7.300zM7.300 13.400h1.400V16H7.300zM0 7.300h2.600v1.400H0zM13.400 7.300H16v1.400h-2.600zM2 3l1-1 1.900 1.900-1 1zM11.100 12.100l1-1L14 13l-1 1zM12.100 4.900l-1-1L13 2l1 1zM3 14l-1-1 1.900-1.900 1 1z',
    help: 'M8 1a7 7 0 1 0 0 14A7 7 0 0 0 8 1zm-.8 10.300h1.600V13H7.200zM8 3.200c1.700 0 2.900 1 2.900 2.500 0 1.200-.7 1.800-1.400 2.300-.5.400-.8.600-.8 1.200v.6H7.300v-.8c0-1 .6-1.500 1.200-2 .5-.4.900-.7.900-1.300s-.6-1.100-1.400-1.100c-.9 0-1.500.5-1.600 1.400H4.900c.1-1.700 1.400-2.800 3.100-2.800z',
};
