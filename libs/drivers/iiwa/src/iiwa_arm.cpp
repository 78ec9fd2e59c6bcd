#include "metier/iiwa_driver/iiwa_arm.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <thread>
#include <utility>

#include "metier/device/notifier.hpp"
#include "session.hpp"

namespace metier::iiwa_driver {

namespace {

// Largest delay of a cycle with the slowest answer before the guard closes the connection.
constexpr std::chrono::milliseconds kGuardMargin{300};

device::ArmInfo infoOf(const IiwaOptions& options, const motion::RobotModel& model) {
    device::ArmInfo info{options.name, {}, options.cycle};
    for (const auto& joint : model.chain().joints) {
        info.axis_names.push_back(joint.name);
    }
    return info;
}

/// Longest silence of a connected cabinet, and 5 cycles at least.
std::chrono::nanoseconds longestSilence(const IiwaOptions& options) {
    return std::max(5 * options.cycle, options.cycle + options.answer_timeout);
}

Result<void> check(const IiwaOptions& options, const motion::RobotModel& model) {
    if (model.axisCount() != kAxes) {
        return fail(Errc::invalid_argument,
                    fmt::format("{}: the model {} has {} axes, an iiwa has {}", options.name,
                                model.name(), model.axisCount(), kAxes));
    }
    if (options.cycle.count() <= 0 || options.answer_timeout.count() <= 0) {
        return fail(Errc::invalid_argument,
                    options.name + ": cycle and answer time-out must be over 0");
    }
    return {};
}

/// The parts and threads of an arm.
class Machine final : public IiwaArm {
public:
    Machine(const IiwaOptions& options, const motion::RobotModel& model, Session::Links links)
        : commander_(infoOf(options, model), model, options),
          force_(core_, longestSilence(options)),
          notifier_([this] { commander_.dispatch(); }),
          session_(std::move(links), {commander_, force_, [this] { notifier_.signal(); }}, options),
          thread_([this](const std::stop_token& stop) { session_.run(stop); }) {}

    ~Machine() override {
        thread_.request_stop();
        session_.shutdown();
        thread_.join();
        commander_.lost(info().name + ": the driver was shut down");
        notifier_.signal();
    }
    Machine(const Machine&) = delete;
    Machine& operator=(const Machine&) = delete;

    std::uint16_t port() const override { return session_.port(); }
    device::ForceTorqueSensor& flangeForce() noexcept override { return force_; }

    const device::ArmInfo& info() const noexcept override { return core_.info(); }
    device::ArmState state() const noexcept override { return core_.state(); }
    device::Safety safety() const override { return core_.safety(); }
    const TimeHistogram* cycleJitter() const noexcept override { return core_.cycleJitter(); }
    Result<void> attach(std::shared_ptr<device::SetPointSource> source) override {
        return commander_.attach(std::move(source));
    }
    void stop() noexcept override {
        core_.stop();
        commander_.stopMotion();
    }
    Result<void> resetFault() override { return commander_.resetFault(); }
    device::Registration onSafetyChange(SafetyCallback callback) override {
        return core_.onSafetyChange(std::move(callback));
    }

    Result<void> move(const device::ControllerPlannedMotion& motion, Done done) override {
        return commander_.move(motion, std::move(done));
    }
    void stopMotion() noexcept override { commander_.stopMotion(); }

private:
    MotionCommander commander_;
    device::ArmCore& core_ = commander_.core();
    FlangeForce force_;
    device::Notifier notifier_;
    Session session_;
    std::jthread thread_;
};

}  // namespace

Result<std::unique_ptr<IiwaArm>> IiwaArm::create(const IiwaOptions& options,
                                                 const motion::RobotModel& model) {
    METIER_TRY(check(options, model));
    auto listener = link::TcpListener::listen(options.address, options.port);
    if (!listener) {
        return fail(listener.error().code, options.name + ": " + listener.error().message);
    }
    auto guard = link::LinkGuard::start(
        std::chrono::ceil<std::chrono::milliseconds>(options.cycle + options.answer_timeout) +
        kGuardMargin);
    if (!guard) {
        return fail(guard.error().code, options.name + ": " + guard.error().message);
    }
    return std::make_unique<Machine>(options, model,
                                     Session::Links{std::move(*listener), std::move(*guard)});
}

}  // namespace metier::iiwa_driver
