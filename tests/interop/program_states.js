// States of a Program (OPC 10000-10) as servers of other makers publish them: NodeId in namespace 0 and
// number.
'use strict';

const kStates = {
  Halted: { id: 2406, number: 11 },
  Ready: { id: 2400, number: 12 },
  Running: { id: 2402, number: 13 },
  Suspended: { id: 2404, number: 14 },
};

/** Methods of a Program that cannot be suspended. */
const kMethodsWithoutSuspend = {
  Start: { from: ['Ready'], to: 'Running' },
  Halt: { from: ['Ready', 'Running'], to: 'Halted' },
  Reset: { from: ['Halted'], to: 'Ready' },
};

module.exports = { kMethodsWithoutSuspend, kStates };
