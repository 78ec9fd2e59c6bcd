// Messages of the dashboard's server, as JSON. Units are SI, angles in rad, times in s since 1970 UTC.

/** x, y, z [m], then a, b, c [rad] about x, y, z: R = Rz(c) Ry(b) Rx(a). */
export type Frame = readonly [number, number, number, number, number, number];
export type Vector3 = readonly [number, number, number];

export interface Me {
    user: string;
    role: string;
    lab: boolean;
    login_required: boolean;
}

/** One parameter or result of a skill. */
export interface Field {
    name: string;
    type: string;
    rank?: number;
    unit?: string;
    minimum?: number | null;
    maximum?: number | null;
    default?: unknown;
    description?: string;
    kind?: string;
    role?: string;
    optional?: boolean;
    least?: number;
    most?: number;
    choices?: string[];
}

export interface Skill {
    key: string;
    server: string;
    name: string;
    display_name: string;
    type: string;
    controller: string;
    arm: string | null;
    parameters: Field[];
    results: Field[];
    can: { check?: boolean; suspend?: boolean; start_with?: boolean };
    /** What a run cannot have, since the server is of another maker; "" if nothing. */
    lacks?: string;
}

export interface Joint {
    name: string;
    origin: Frame;
    axis: Vector3;
    lower: number;
    upper: number;
    velocity: number;
}

export interface Visual {
    link: number;
    from: Vector3;
    to: Vector3;
    from_radius: number;
    to_radius: number;
    color: Vector3;
    /** Rounding of both edges [m]; absent: a share of the radius. */
    edge?: number;
}

export interface Arm {
    key: string;
    name: string;
    maker: string;
    product: string;
    server: string;
    base: Frame;
    joints: Joint[];
    flange: Frame;
    /** A frame that nobody published is null. */
    tools: { name: string; frame: Frame | null }[];
    visuals: Visual[];
    cycle_time: number;
}

export interface GripperPlace {
    arm: string | null;
    frame: Frame;
    stroke: number;
    width?: number;
}

export interface Server {
    key: string;
    name: string;
    url: string;
    application_uri: string;
    connected: boolean;
    error: string | null;
    arm?: string | null;
    gripper?: GripperPlace | null;
    /** Keys of other servers whose skills its own use. */
    uses?: string[];
    skills: Skill[];
}

export interface Part {
    name: string;
    size: Vector3;
    pose: Frame;
}

export interface World {
    parts?: Part[];
    table?: { height: number } | null;
    walls?: { name: string; point: Vector3; normal: Vector3 }[];
}

export interface Cell {
    name: string;
    lab: boolean;
    /** Whether there are meshes of the user's own to ask for. */
    meshes?: boolean;
    servers: Server[];
    arms: Arm[];
    world?: World | null;
}

export type StateName = 'Halted' | 'Ready' | 'Running' | 'Suspended' | '';

export interface SkillEvent {
    key: string;
    state: StateName;
    sub_state?: string;
    step?: string;
    progress?: number | null;
    reason?: string;
    reason_text?: string;
    execution?: string;
    since?: number;
}

export interface ControlEvent {
    server: string;
    controller: string;
    owner: string;
    mine: boolean;
    until?: number | null;
    lease_ms?: number;
}

export interface ServerEvent {
    key: string;
    connected: boolean;
    error: string | null;
}

export interface AlarmEvent {
    server: string;
    severity: number;
    message: string;
    time: number;
}

/** What an arm's server measured at one time. */
export interface ArmSample {
    q?: number[];
    c?: number[];
    v?: number[];
    f?: number[];
    jitter?: number;
    missed?: number;
    safety?: string;
    width?: number;
}

export interface LiveEvent {
    t: number;
    arms?: Record<string, ArmSample>;
    grippers?: Record<string, { width?: number; force?: number; held?: boolean }>;
    /** In the world; null: the part is gone. */
    parts?: Record<string, Frame | null>;
}

export interface Snapshot {
    t: number;
    servers: ServerEvent[];
    skills: SkillEvent[];
    controls: ControlEvent[];
    live?: LiveEvent;
}

export interface PathPoint {
    time: number;
    q: number[];
}

export interface CheckResult {
    possible: boolean;
    code?: string;
    message?: string;
    duration?: number;
    length?: number;
    preview?: PathPoint[];
    /** What could not be checked, one line each. */
    notes?: string[];
}

export interface Transition {
    time: number;
    from: string;
    to: string;
    sub_state?: string;
    step?: string;
    reason?: string;
    reason_text?: string;
}

export interface RecordRow {
    number: number;
    id: string;
    server: string;
    server_name?: string;
    skill: string;
    arm?: string | null;
    user?: string;
    client_name?: string;
    started: number;
    ended?: number | null;
    state: string;
    reason?: string;
    reason_text?: string;
    parent?: string;
}

export interface RecordDetail extends RecordRow {
    parameters?: unknown;
    check?: unknown;
    result?: unknown;
    session?: string;
    thumbprint?: string;
    missed_cycles?: number;
    device?: string;
    parent_server?: string;
    transitions: Transition[];
    children: RecordRow[];
    path: { time: number; q: number[]; c?: number[]; f?: number[] }[];
}
