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

}  // namespace

/// The parts and threads behind the faces.
class IiwaArm::Machine {
public:
    Machine(const IiwaOptions& options, const motion::RobotModel& model, Session::Links links)
        : commander_(infoOf(options, model), model, {options.force_tolerance, options.tool}),
          force_(commander_.core(), longestSilence(options)),
          notifier_([this] { commander_.dispatch(); }),
          session_(std::move(links), {commander_, force_, [this] { notifier_.signal(); }},
                   {options.precision, options.cycle, options.answer_timeout}),
          thread_([this](const std::stop_token& stop) { session_.run(stop); }) {}

    ~Machine() {
        thread_.request_stop();
        session_.shutdown();
        thread_.join();
        commander_.lost(commander_.core().info().name + ": the driver was shut down");
        notifier_.signal();
    }
    Machine(const Machine&) = delete;
    Machine& operator=(const Machine&) = delete;

    MotionCommander& commander() noexcept { return commander_; }
    FlangeForce& force() noexcept { return force_; }
    std::uint16_t port() const { return session_.port(); }

private:
    MotionCommander commander_;
    FlangeForce force_;
    device::Notifier notifier_;
    Session session_;
    std::jthread thread_;
};

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
    return std::unique_ptr<IiwaArm>(new IiwaArm(std::make_unique<Machine>(
        options, model, Session::Links{std::move(*listener), std::move(*guard)})));
}

IiwaArm::IiwaArm(std::unique_ptr<Machine> machine) : machine_(std::move(machine)) {}

IiwaArm::~IiwaArm() = default;

std::uint16_t IiwaArm::port() const {
    return machine_->port();
}

device::ForceTorqueSensor& IiwaArm::flangeForce() noexcept {
    return machine_->force();
}

const device::ArmInfo& IiwaArm::info() const noexcept {
    return machine_->commander().core().info();
}

device::ArmState IiwaArm::state() const noexcept {
    return machine_->commander().core().state();
}

const TimeHistogram* IiwaArm::cycleJitter() const noexcept {
    return machine_->commander().core().cycleJitter();
}

device::Safety IiwaArm::safety() const {
    return machine_->commander().core().safety();
}

Result<void> IiwaArm::attach(std::shared_ptr<device::SetPointSource> source) {
    return machine_->commander().attach(std::move(source));
}

void IiwaArm::stop() noexcept {
    machine_->commander().core().stop();
    machine_->commander().stopMotion();
}

Result<void> IiwaArm::resetFault() {
    return machine_->commander().resetFault();
}

device::Registration IiwaArm::onSafetyChange(SafetyCallback callback) {
    return machine_->commander().core().onSafetyChange(std::move(callback));
}

Result<void> IiwaArm::move(const device::ControllerPlannedMotion& motion, Done done) {
    return machine_->commander().move(motion, std::move(done));
}

void IiwaArm::stopMotion() noexcept {
    machine_->commander().stopMotion();
}

}  // namespace metier::iiwa_driver
