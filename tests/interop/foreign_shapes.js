// The ways in which Programs of other makers differ, one Program each.
'use strict';

const kMethods = ['Start', 'Suspend', 'Resume', 'Halt', 'Reset'];

/**
 * A Program that waits for Duration [s] and then says how often it did.
 *
 * @typedef {object} Shape
 * @property {string} name
 * @property {string[]} methods that it has
 * @property {string|null} event the type of its events; null: none
 * @property {boolean} numbers whether its state has a number; its events have none in namespace 0
 * @property {boolean} ids whether states and transitions have NodeIds
 * @property {number} [namespace] of the methods' BrowseNames; default: 0
 * @property {number} [rank] that its fields declare as ValueRank; default: -1, scalar
 * @property {number} [lasts] [s] its fixed duration: it has no parameters, no results, and no
 *     LastTransition
 */

/** @type {Shape[]} */
const kShapes = [
  { name: 'Whole', methods: kMethods, event: 'ProgramTransitionEventType', numbers: true, ids: true },
  { name: 'WithoutNumbers', methods: kMethods, event: 'ProgramTransitionEventType', numbers: false, ids: true },
  { name: 'PlainEvents', methods: kMethods, event: 'TransitionEventType', numbers: false, ids: true },
  { name: 'WithoutEvents', methods: kMethods, event: null, numbers: true, ids: true },
  { name: 'NamesOnly', methods: kMethods, event: 'TransitionEventType', numbers: false, ids: false },
  {
    name: 'OwnMethods', methods: kMethods, event: 'TransitionEventType', numbers: false, ids: true,
    namespace: 1,
  },
  {
    name: 'WrongRanks', methods: kMethods, event: 'TransitionEventType', numbers: false, ids: true,
    rank: -2,
  },
  { name: 'Bare', methods: kMethods, event: null, numbers: false, ids: true, lasts: 5 },
  { name: 'StartAndHalt', methods: ['Start', 'Halt'], event: 'TransitionEventType', numbers: false, ids: true },
  { name: 'StartOnly', methods: ['Start'], event: null, numbers: false, ids: true },
];

/** Names of the shapes that have a Method. */
const namesWith = (method) =>
  kShapes.filter(({ methods }) => methods.includes(method)).map(({ name }) => name);

/** Values that have a Program run so long; one with a fixed duration takes none. */
function lasting(name, seconds) {
  return kShapes.find((shape) => shape.name === name).lasts ? {} : { Duration: seconds };
}

/** Options of `metier run` that have a Program run so long. */
function setLasting(name, seconds) {
  return Object.entries(lasting(name, seconds)).flatMap(([field, value]) => ['--set', `${field}=${value}`]);
}

module.exports = { kShapes, lasting, namesWith, setLasting };
