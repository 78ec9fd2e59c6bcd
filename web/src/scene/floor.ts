// The floor: a grid of 10 cm that fades out, the arms' shadow, and a darker spot where an arm stands.

import {
    Color, DataTexture, Group, LinearFilter, Mesh, MeshBasicMaterial, PlaneGeometry, RGBAFormat, ShaderMaterial, ShadowMaterial,
} from 'three';

const kVertex = `
varying vec2 at;
varying float far;
void main() {
    vec4 world = modelMatrix * vec4(position, 1.0);
    at = world.xy;
    vec4 eye = viewMatrix * world;
    far = length(eye.xyz);
    gl_Position = projectionMatrix * eye;
}`;

const kFragment = `
uniform vec3 ground;
uniform vec3 line;
uniform vec3 sky;
uniform vec2 middle;
uniform float reach;
varying vec2 at;
varying float far;
float grid(float step, float width) {
    vec2 cell = at / step;
    vec2 derivative = max(fwidth(cell), 1e-6);
    vec2 near = abs(fract(cell - 0.5) - 0.5) / derivative;
    float visible = 1.0 - smoothstep(0.15, 0.6, max(derivative.x, derivative.y));
    return (1.0 - min(min(near.x, near.y) / width, 1.0)) * visible;
}
void main() {
    float lines = max(grid(0.1, 1.0) * 0.45, grid(1.0, 1.4));
    float fade = smoothstep(reach, reach * 0.35, distance(at, middle));
    vec3 color = mix(ground, line, lines * fade);
    gl_FragColor = vec4(mix(sky, color, smoothstep(reach * 1.25, reach * 0.4, distance(at, middle))), 1.0);
    #include <colorspace_fragment>
}`;

export interface FloorColors {
    ground: string;
    line: string;
    sky: string;
}

function spotTexture(): DataTexture {
    const size = 64;
    const data = new Uint8Array(size * size * 4);
    for (let i = 0; i < size * size; ++i) {
        const r = Math.hypot((i % size) - 31.5, Math.floor(i / size) - 31.5) / 31.5;
        data[4 * i + 3] = Math.round(255 * Math.max(0, 1 - r) ** 1.6);
    }
    const texture = new DataTexture(data, size, size, RGBAFormat);
    texture.magFilter = LinearFilter;
    texture.needsUpdate = true;
    return texture;
}

/** \param middle of the cell [m]; \param reach to where the grid is seen [m] */
export class Floor {
    readonly root = new Group();
    private readonly grid: ShaderMaterial;
    private readonly shadow = new ShadowMaterial({ opacity: 0.28 });
    private readonly spot = new MeshBasicMaterial({ map: spotTexture(), transparent: true, opacity: 0.45, depthWrite: false });

    constructor() {
        this.grid = new ShaderMaterial({
            vertexShader: kVertex,
            fragmentShader: kFragment,
            uniforms: {
                ground: { value: new Color() }, line: { value: new Color() }, sky: { value: new Color() },
                middle: { value: [0, 0] }, reach: { value: 6 },
            },
        });
        const plane = new PlaneGeometry(200, 200);
        const ground = new Mesh(plane, this.grid);
        const shade = new Mesh(plane, this.shadow);
        shade.receiveShadow = true;
        shade.position.z = 0.0008;
        this.root.add(ground, shade);
    }

    setColors(colors: FloorColors, shadow_opacity: number): void {
        (this.grid.uniforms['ground']?.value as Color).set(colors.ground);
        (this.grid.uniforms['line']?.value as Color).set(colors.line);
        (this.grid.uniforms['sky']?.value as Color).set(colors.sky);
        this.shadow.opacity = shadow_opacity;
        this.spot.opacity = shadow_opacity * 1.5;
    }

    setReach(x: number, y: number, reach: number): void {
        (this.grid.uniforms['middle'] as { value: number[] }).value = [x, y];
        (this.grid.uniforms['reach'] as { value: number }).value = reach;
    }

    /** A contact shadow below what stands at x, y. */
    addSpot(x: number, y: number, radius: number, height = 0.0012): void {
        const mesh = new Mesh(new PlaneGeometry(2 * radius, 2 * radius), this.spot);
        mesh.position.set(x, y, height);
        mesh.renderOrder = 1;
        this.root.add(mesh);
    }
}
