#pragma once

#include <memory>

#include "metier/base/clock.hpp"
#include "metier/composition/force_source.hpp"
#include "metier/composition/used_skill.hpp"
#include "metier/skill/executor.hpp"

namespace metier::composition {

/// Makes any move end at a force, too: a used skill that halts `move` once a force that is measured
/// anywhere exceeds a limit along an axis of the base frame.
///
/// Parameters besides those of the move:
/// - MaxForce, a vector [N]: force along each axis of the base frame that ends the move; 0: no
///   limit along this axis; at least one is over 0.
/// - HaltOnForce, default false: a force over its limit is an error: halted, force_exceeded.
///
/// Results besides those of the move, which are Null where a force ended it, since it was halted:
/// - ContactForce [N], ContactTorque [N m] (Null: not measured): at the end, in the base frame.
/// - ForcesExceeded [N]: the force that ended it; zero: it reached its target.
/// - ForcesMax [N]: largest force along each axis, without sign.
/// - ReactionTime [s]: from the arrival of the last force within the limits until the move began to
///   brake; its server reports that, or, if it does not, the standstill. It is not shorter than the
///   time from the contact, but for the way of one value to here.
/// - StoppingTime [s]: the same until the move stood. Both are Null if no force ended it.
///
/// A force that is over its limit at the start ends the move before it begins. A move whose force
/// is not known any more is halted: device_lost. A move that a force has ended is reset at once.
/// Threading: the owner's thread.
/// \param move     has Halt; its events and those of `source` come on the owner's thread
/// \param source   shared by the moves that it ends
/// \param executor of the owner's thread
/// \param clock    by which the times of the source are; must outlive the result
std::unique_ptr<UsedSkill> limitForce(std::unique_ptr<UsedSkill> move,
                                      std::shared_ptr<ForceSource> source,
                                      std::shared_ptr<skill::Executor> executor,
                                      const Clock& clock);

}  // namespace metier::composition
