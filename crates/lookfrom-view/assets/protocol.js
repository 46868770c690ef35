// The types of the messages between page and server. `view` is the whole request of a window, never a part of it.
// Keys are in snake_case. Types of inspections are made from the schema of `lookfrom inspect --json`.

/** @typedef {import("../types/inspection.js").Vector} Vector */
/** In a mirrored picture u is to the right. @typedef {{lookfrom: Vector, lookat: Vector, up: Vector, fov: number | null, is_mirrored?: boolean}} Camera */
/** @typedef {"wipe" | "reference" | "difference" | "flip" | "z"} Compare */

/**
 * What a window shows; null means the scene's own.
 * @typedef {object} View
 * @property {Camera | null} camera
 * @property {[number, number] | null} size
 * @property {string | null} integrator
 * @property {number | null} depth
 * @property {number | null} samples
 * @property {number | null} min_contribution
 * @property {number | null} turn degrees
 * @property {number | null} rotate_environment degrees
 * @property {number | null} animation
 * @property {number | null} at seconds
 * @property {string | null} variant
 * @property {number | null} exposure stops
 * @property {string | null} tonemap
 * @property {boolean | null} denoise
 * @property {string} layer
 * @property {Compare | null} compare
 */

/** A number of things, or numbers by kind, or the things themselves. @typedef {number | Record<string, number> | object[]} Count */

/**
 * @typedef {object} Scene
 * @property {"scene"} type
 * @property {number} generation
 * @property {string} name
 * @property {[number, number]} size
 * @property {boolean} is_sized Whether the size was asked for on the command line.
 * @property {Camera & {projection: string}} camera
 * @property {{min: Vector, max: Vector}} bounds
 * @property {string} integrator
 * @property {string[]} integrators
 * @property {number} depth
 * @property {number} samples
 * @property {number} min_contribution
 * @property {number} exposure
 * @property {string} tonemap
 * @property {string[]} tonemaps
 * @property {boolean} denoise
 * @property {{name: string, title: string}[]} layers
 * @property {string[]} variants
 * @property {{name: string, seconds: number}[]} animations
 * @property {number | null} duration
 * @property {boolean} turntable
 * @property {number | null} turn degrees
 * @property {number | null} rotate_environment degrees
 * @property {number | null} at seconds
 * @property {string | null} variant
 * @property {number | null} animation
 * @property {Record<string, Count>} counts
 * @property {{name: string, position: Vector | null}[]} lights
 * @property {string | null} reference
 * @property {string[]} warnings
 * @property {string} version
 */

/** @typedef {{type: "progress", view: number, samples: number, of: number, seconds: number, rays_per_second: number, done: boolean, hash: string | null}} Progress */
/** @typedef {{type: "error", id: number | null, message: string, place: {file: string, line: number, column: number} | null, excerpt: string | null}} Failure */
/** @typedef {{type: "value", x: number, y: number, rgb: Vector, samples: number, deviation: number | string, reference: Vector | null}} Value */
/** @typedef {{kind: "picture", view: number, width: number, height: number, scale: number, samples: number, of: number, done: boolean, layer: string, seconds: number, camera: Camera, screen_from_world: number[] | null, sizes?: number[]}} PictureHeader */
/** @typedef {{kind: "space", id: number, width: number, height: number, screen_from_world: number[], sizes: number[]}} SpaceHeader */
/** @typedef {{kind: "file", id: number, name: string, mime: string}} FileHeader */
/** A table of the scene format: its title is `[camera]`, `[[light]] point`, `[materials.NAME] whitted`, or the name of a table within one. @typedef {{title: string, keys: string[]}} Table */
/** A binary message of any kind. @typedef {{header: {kind: string, id?: number}, payload: ArrayBuffer}} Binary */
/** @typedef {{header: PictureHeader, payload: ArrayBuffer}} Picture */
/** @typedef {{type: "lobe", address: number, point: Vector, normal: Vector, wi: Vector, chosen: Vector | null, theta: number, phi: number, values: number[], directions: Vector[]}} Lobe */

/**
 * The answers by the type of their question.
 * @typedef {object} Answers
 * @property {{report: PixelReport}} pixel
 * @property {{inspection: Inspection, text: string}} inspect
 * @property {Value} value
 * @property {Lobe} lobe
 * @property {{toml: string, command: string}} words
 * @property {{header: SpaceHeader, payload: ArrayBuffer}} space
 * @property {{tables: Table[]}} vocabulary
 * @property {{header: FileHeader, payload: ArrayBuffer}} save
 * @property {{header: FileHeader, payload: ArrayBuffer}} handout
 */

/** @typedef {import("../types/inspection.js").SampleSummary} SampleRow */
/** @typedef {import("../types/inspection.js").Contribution} Contribution */
/** @typedef {import("../types/inspection.js").Pixel} PixelReport */
/** @typedef {import("../types/inspection.js").Amount} Amount */
/** @typedef {import("../types/inspection.js").Twice} Twice */
/** @typedef {import("../types/inspection.js").Candidate} Candidate */
/** @typedef {import("../types/inspection.js").Shadow} Shadow */
/** @typedef {import("../types/inspection.js").Microfacet} Microfacet */
/** @typedef {import("../types/inspection.js").MatrixStep} Step */
/** @typedef {import("../types/inspection.js").Ray} Ray */
/** @typedef {import("../types/inspection.js").Segment} Segment */
/** @typedef {import("../types/inspection.js").Sample} Inspection */

export {};
