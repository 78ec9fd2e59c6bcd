#pragma once

#include <string>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"
#include "metier/edo_driver/generation.hpp"
#include "metier/edo_driver/messages.hpp"
#include "wire.hpp"

namespace metier::edo_driver {

/// Takes control of the joints from the robot's own trajectory generator and gives it back.
///
/// An answer of the service alone proves nothing: the algorithm state must agree. Older software
/// does not publish that state while control is taken; then its silence is the proof that control
/// was taken, and the next state the proof that it was given back. If a robot has never published
/// its algorithm state, the answer alone must do.
///
/// Threading: one thread. tick() and onAlgorithmState() do not allocate unless something is wrong.
class Handover {
public:
    enum class State : std::uint8_t { free, taking, taken, giving_back };

    /// A new connection: nothing is pending, control is free as far as is known.
    void begin(const Generation& generation) noexcept;

    State state() const noexcept { return state_; }
    const Generation& generation() const noexcept { return generation_; }

    /// Only while free.
    void take(SteadyTime now, Wire& wire);
    /// Only while free or taken. From free it takes back what an earlier connection left taken, and
    /// a refusal is no failure.
    void giveBack(SteadyTime now, Wire& wire);

    void onResponse(const ServiceResponse& response, SteadyTime now);
    void onAlgorithmState(const AlgorithmState& state, SteadyTime now) noexcept;

    /// Errors: device_fault once when the robot refused or did not do what it said; then free.
    Result<void> tick(SteadyTime now);

private:
    void call(int mode, SteadyTime now, Wire& wire);
    bool agrees(SteadyTime now) const noexcept;
    Result<void> failed(std::string_view problem);
    std::string disagreement() const;

    Generation generation_{};
    State state_ = State::free;
    bool granted_ = false;   // the service agreed; the algorithm state must confirm it
    bool leftover_ = false;  // gives back control that was not taken by this connection
    std::string refusal_;
    std::string id_;
    unsigned calls_ = 0;
    SteadyTime deadline_{};
    SteadyTime granted_at_{};
    int algorithm_ = -1;  // last published state; -1: none on this connection
    SteadyTime heard_at_{};
    int contradictions_ = 0;  // states in a row that say that control is not taken
};

}  // namespace metier::edo_driver
