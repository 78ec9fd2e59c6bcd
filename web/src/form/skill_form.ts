// The form of a skill, made from its fields.

import type { Arm, Field, Skill } from '../api/types.js';
import { h, setText } from '../ui/dom.js';
import {
    choiceEditor, flagEditor, freeListEditor, listEditor, namesOf, numberEditor, rangesEditor, textEditor, textsEditor, type Editor,
} from './editors.js';
import { boundsOf, defaultText, editorOf, isRequired, jointBounds, rangeText } from './field_value.js';
import { jointsEditor, poseEditor, posesEditor, type TargetOptions } from './target_editors.js';

export interface FormValues {
    /** What a person set; the rest takes its default. */
    parameters: Record<string, unknown>;
    /** Of every field with a mistake. */
    errors: Record<string, string>;
}

export interface FormOptions {
    arm: Arm | null;
    changed: () => void;
    /** The pose of a tool frame by name now. */
    currentFrame: (tool: string) => TargetOptions['currentFrame'];
    currentJoints: TargetOptions['currentJoints'];
}

interface Row {
    field: Field;
    editor: Editor;
    element: HTMLElement;
    error: HTMLElement;
    touched: boolean;
}

const kToolField = 'ToolFrame';
const kRelativeField = 'Relative';

function makeEditor(field: Field, options: TargetOptions, arm: Arm | null): Editor {
    const axes = arm?.joints.length ?? 0;
    switch (editorOf(field)) {
        case 'flag': return flagEditor(field, options);
        case 'pose': return poseEditor(field, options);
        case 'poses': return posesEditor(field, options);
        case 'ranges': return rangesEditor(field, options);
        case 'texts': return textsEditor(field, options);
        // The server knows whether a relative target is meant: here only the field's own bounds are sure.
        case 'joints': return jointsEditor(field, options, arm, jointBounds(field, arm, false));
        case 'integer': return numberEditor(field, options, true);
        case 'number': return numberEditor(field, options, false);
        case 'list': return listOf(field, options, axes);
        case 'choice': return choiceEditor(field, options, field.choices ?? []);
        case 'text': return toolOrText(field, options, arm);
    }
}

function listOf(field: Field, options: TargetOptions, axes: number): Editor {
    const count = field.type === 'vector3' ? 3 : field.rank ?? 0;
    if (count === 0 || count > 12) return freeListEditor(field, options);
    return listEditor(field, options, namesOf(field, count, axes), Array.from({ length: count }, () => boundsOf(field)));
}

function toolOrText(field: Field, options: TargetOptions, arm: Arm | null): Editor {
    if (field.name !== kToolField || arm === null) return textEditor(field, options);
    const names = arm.tools.map((tool) => tool.name);
    return choiceEditor(field, options, names.includes('flange') ? names : ['flange', ...names]);
}

export class SkillForm {
    readonly element: HTMLFormElement;
    private readonly rows: Row[];

    constructor(readonly skill: Skill, private readonly options: FormOptions) {
        this.rows = skill.parameters.map((field) => this.row(field));
        const main = this.rows.filter((row) => row.field.kind !== 'option' && this.isMain(row.field));
        const rest = this.rows.filter((row) => !main.includes(row));
        this.element = h('form', { class: 'form', novalidate: true, onsubmit: (event: Event) => event.preventDefault() },
            ...main.map((row) => row.element),
            rest.length > 0 && h('details', { class: 'options' }, h('summary', {}, `Limits and options (${rest.length})`), ...rest.map((row) => row.element)),
            this.rows.length === 0 && h('p', { class: 'empty' }, 'This skill takes no parameters.'));
    }

    read(): FormValues {
        const values: FormValues = { parameters: {}, errors: {} };
        for (const row of this.rows) {
            const parsed = row.editor.read();
            if (parsed === null) {
                if (isRequired(row.field)) values.errors[row.field.name] = 'A value is needed';
            } else if ('error' in parsed) {
                values.errors[row.field.name] = parsed.error;
            } else {
                values.parameters[row.field.name] = parsed.value;
            }
        }
        return values;
    }

    /** Shows the mistakes; of fields that nobody touched yet only if `all`. */
    showErrors(errors: Record<string, string>, all: boolean): void {
        for (const row of this.rows) {
            const error = errors[row.field.name] ?? '';
            const shown = all || row.touched ? error : '';
            setText(row.error, shown);
            row.element.classList.toggle('wrong', shown !== '');
            for (const input of row.element.querySelectorAll('input, select')) input.setAttribute('aria-invalid', String(shown !== ''));
            if (shown !== '' && all) row.element.closest('details')?.setAttribute('open', '');
        }
    }

    /** Puts where the arm is now into targets that nobody has set: a start that moves nothing, not a leap to zero. */
    fillTargets(): void {
        for (const row of this.rows) {
            const role = row.field.role;
            if (row.touched || row.editor.read() !== null) continue;
            if (role === 'joints') row.editor.set(this.options.currentJoints());
            else if (editorOf(row.field) === 'pose') row.editor.set(this.options.currentFrame(this.tool)());
        }
    }

    set(parameters: Record<string, unknown>): void {
        for (const row of this.rows) {
            if (row.field.name in parameters) row.editor.set(parameters[row.field.name]);
        }
    }

    focusFirstError(): void {
        this.element.querySelector<HTMLElement>('.wrong input, .wrong select')?.focus();
    }

    /** Whether the targets are meant relative to where the arm is. */
    get isRelative(): boolean {
        const parsed = this.rows.find((row) => row.field.name === kRelativeField)?.editor.read();
        return parsed !== null && parsed !== undefined && 'value' in parsed && Number(parsed.value) !== 0;
    }

    private isMain(field: Field): boolean {
        return isRequired(field) || field.role === 'pose' || field.role === 'joints' || field.name === kToolField ||
            this.skill.parameters.length <= 4;
    }

    private get tool(): string {
        const parsed = this.rows.find((row) => row.field.name === kToolField)?.editor.read();
        return parsed !== null && parsed !== undefined && 'value' in parsed ? String(parsed.value) : '';
    }

    private row(field: Field): Row {
        const id = `field-${field.name}`;
        const error = h('p', { class: 'field-error', id: `${id}-error`, role: 'alert' });
        const changed = (): void => {
            row.touched = true;
            this.options.changed();
        };
        const editor = makeEditor(field, {
            id, changed, currentJoints: this.options.currentJoints, currentFrame: () => this.options.currentFrame(this.tool)(),
        }, this.options.arm);
        const range = rangeText(field);
        const preset = defaultText(field);
        const hints = [range, preset === '' ? '' : `default ${preset}`].filter((hint) => hint !== '').join(' \u00b7 ');
        const element = h('div', { class: 'field', 'data-field': field.name },
            h('label', { for: id, title: field.description ?? '' }, splitName(field.name), isRequired(field) && h('span', { class: 'required', title: 'needed' }, ' *')),
            editor.element,
            hints !== '' && h('p', { class: 'hint' }, hints), error);
        for (const input of element.querySelectorAll('input, select')) input.setAttribute('aria-describedby', `${id}-error`);
        const row: Row = { field, editor, element, error, touched: false };
        return row;
    }
}

function splitName(name: string): string {
    return name.replace(/([a-z0-9])([A-Z])/g, '$1 $2');
}
