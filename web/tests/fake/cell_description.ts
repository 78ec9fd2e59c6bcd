// The cell of the fake dashboard: three arms of models/, their servers, a gripper and a part.

import { join } from 'node:path';
import type { Cell, Field, Server, Skill } from '../../src/api/types.js';
import { readArm, type ModelArm } from './model_file.js';

function field(name: string, type: string, more: Partial<Field> = {}): Field {
    return { name, type, rank: 0, unit: '', minimum: null, maximum: null, default: null, description: '', kind: 'parameter', role: '', ...more };
}

function moveFields(arm: ModelArm, target: Field): Field[] {
    const axes = arm.joints.length;
    return [
        target,
        field('ToolFrame', 'text', { default: '', choices: ['flange'], description: 'Tool frame that moves' }),
        field('MaxVelocity', 'numbers', { rank: axes, unit: 'rad/s', minimum: 0, maximum: 20, default: new Array<number>(axes).fill(0), description: 'Largest velocity of each axis; 0: the robot\u2019s own' }),
        field('SpeedOverride', 'number', { minimum: 0, maximum: 1, default: 1, kind: 'option', description: 'Share of the planned speed' }),
        field('Duration', 'number', { unit: 's', minimum: 0, maximum: 3600, kind: 'option', description: 'How long the motion takes' }),
    ];
}

function skill(server: string, name: string, arm: string | null, parameters: Field[]): Skill {
    return {
        key: `${server}/Controller/${name}`, server, name, display_name: name, type: `${name}Type`, controller: 'Controller', arm, parameters,
        results: [field('Duration', 'number', { unit: 's' })], can: { check: true, suspend: true, start_with: true },
    };
}

function moveSkills(server: string, arm: ModelArm): Skill[] {
    const joints = field('TargetJointPosition', 'numbers', { rank: arm.joints.length, unit: 'rad', role: 'joints', description: 'Joint position to move to, axis 1 first' });
    const pose = field('TargetPosition', 'frame', { unit: 'm', role: 'pose', description: 'Pose of the tool frame, in the base frame' });
    return [
        skill(server, 'CartesianLinearMoveSkill', arm.key, moveFields(arm, pose)),
        skill(server, 'CartesianPtpMoveSkill', arm.key, moveFields(arm, pose)),
        skill(server, 'JointPtpMoveSkill', arm.key, moveFields(arm, joints)),
    ];
}

function server(key: string, port: number, skills: Skill[], more: Partial<Server> = {}): Server {
    return { key, name: key, url: `opc.tcp://127.0.0.1:${port}`, application_uri: `urn:fake:${key}`, connected: true, error: '', arm: null, gripper: null, skills, ...more };
}

export interface FakeDescription {
    cell: Cell;
    arms: Map<string, ModelArm>;
}

export function describeCell(models: string): FakeDescription {
    const iiwa = readArm(join(models, 'iiwa7.toml'), 'iiwa', [0, 0, 0, 0, 0, 0]);
    const ur5 = readArm(join(models, 'ur5.toml'), 'ur5', [1.5, 0, 0, 0, 0, 0]);
    const edo = readArm(join(models, 'edo.toml'), 'edo', [3, 0, 0, 0, 0, 0]);
    const width = field('Width', 'number', { unit: 'm', minimum: 0, maximum: 0.11, description: 'Between the jaws' });
    const force = field('Force', 'number', { unit: 'N', minimum: 5, maximum: 80, default: 20 });
    const gripper = [skill('wsg50', 'GraspGripperSkill', null, [force]), skill('wsg50', 'ReleaseGripperSkill', null, []), skill('wsg50', 'MoveGripperSkill', null, [width])];
    const servers = [
        server('iiwa', 48421, moveSkills('iiwa', iiwa), { arm: 'iiwa' }),
        server('ur5', 48411, [skill('ur5', 'PositionStreamSkill', 'ur5', [field('TargetJointPosition', 'numbers', { rank: 6, unit: 'rad', role: 'joints' })])], { arm: 'ur5' }),
        server('ur5-move', 48412, moveSkills('ur5-move', ur5), { uses: ['ur5'] }),
        server('edo', 48431, moveSkills('edo', edo), { arm: 'edo' }),
        server('wsg50', 48441, gripper, { gripper: { arm: 'iiwa', frame: [0, 0, 0.15, 0, 0, 0], stroke: 0.11, width: 0.05 } }),
    ];
    const world = { table: { height: 0 }, parts: [{ name: 'cube', size: [0.03, 0.03, 0.03] as const, pose: [0.5, 0.3, 0.015, 0, 0, 0] as const }], walls: [] };
    return { cell: { name: 'demo', lab: true, servers, arms: [iiwa, ur5, edo], world }, arms: new Map([iiwa, ur5, edo].map((arm) => [arm.key, arm])) };
}
