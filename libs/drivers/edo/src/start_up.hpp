#pragma once

#include <optional>
#include <string>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"
#include "metier/edo_driver/messages.hpp"
#include "wire.hpp"

namespace metier::edo_driver {

/// Leads the robot from INIT or BRAKED to CALIBRATED: discovers its joints, releases its brakes.
/// It never calibrates, which is a person's work.
///
/// The robot drops commands that its state does not allow, without an answer, so only the machine
/// state shows whether a command had an effect.
///
/// Threading: one thread.
class StartUp {
public:
    /// \param layout must outlive this
    StartUp(const JointLayout& layout, const ResetRequest& request)
        : layout_(layout), request_(request) {}

    void start(SteadyTime now);
    bool running() const noexcept { return step_ != Step::idle; }
    void cancel() noexcept { step_ = Step::idle; }

    /// Continues the start-up.
    /// \return its outcome, once; device_fault with the reason that remains
    std::optional<Result<void>> tick(const MachineState& machine, SteadyTime now, Wire& wire);

private:
    enum class Step : std::uint8_t { idle, deciding, sent, executing };

    std::optional<Result<void>> decide(const MachineState& machine, SteadyTime now, Wire& wire);
    void send(std::string_view what, const std::string& text, const MachineState& machine,
              Wire& wire);
    Result<void> ended(Result<void> how) noexcept;

    const JointLayout& layout_;
    ResetRequest request_;
    Step step_ = Step::idle;
    std::string_view command_;  // last command sent
    std::uint8_t sent_in_ = 0;  // the state it was sent in
    bool init_sent_ = false;
    bool reset_sent_ = false;
    SteadyTime deadline_{};
};

}  // namespace metier::edo_driver
