#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "metier/composition/sequence_skill.hpp"
#include "metier/skill/executor.hpp"

namespace metier::composition {

class Run;

/// Resets the used skills that an execution has halted itself, so that the next execution finds
/// them Ready.
///
/// A skill whose Reset is refused, or not answered within the Run's time to come to rest, stays
/// Halted; its next use resets it. Threading: the owner's thread.
class ResetRound {
public:
    /// \param done called once, from start() or later, maybe not at all after this has ended
    ResetRound(Run& run, std::function<void()> done);
    ~ResetRound();
    ResetRound(const ResetRound&) = delete;
    ResetRound& operator=(const ResetRound&) = delete;

    /// Once.
    void start(BoundSkills& skills);

private:
    class One;
    void ended(const One& one);
    void end();

    Run& run_;
    std::function<void()> done_;
    std::vector<std::unique_ptr<One>> open_;
    skill::Timer limit_;
};

}  // namespace metier::composition
