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
/// The robot drops what its state does not allow without a word, so only the machine state tells
/// whether something happened.
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

    /// Goes on. \return how it ended, once; device_fault with what is still wrong
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
    std::string_view command_;  // what was sent last
    std::uint8_t sent_in_ = 0;  // the state it was sent in
    bool init_sent_ = false;
    bool reset_sent_ = false;
    SteadyTime deadline_{};
};

}  // namespace metier::edo_driver
