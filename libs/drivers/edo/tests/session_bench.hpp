#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "fake_edo.hpp"
#include "session.hpp"

namespace metier::edo_driver::testing {

inline constexpr const char* kClassic = "edo_2.4.0";
inline constexpr const char* kExternal = "edo_3.2.0";

inline EdoOptions benchOptions() {
    device::OpenRequest request;
    request.name = "edo";
    request.address = "127.0.0.1";
    return readOptions(request).value();
}

/// A source that goes `step` [rad] further with axis 1 in each cycle, for `cycles`; then it is
/// done.
class Stepper final : public device::SetPointSource {
public:
    Stepper(double step, int cycles) : step_(step), cycles_(cycles) {}

    Next next(const device::ArmState&, device::JointArray& set_point) noexcept override {
        if (asked == cycles_) {
            return Next::done;
        }
        ++asked;
        set_point[0] += step_;
        return Next::set_point;
    }
    void ended(device::EndCause cause, const device::Safety& safety) override {
        ends.emplace_back(cause, safety);
    }

    int asked = 0;
    std::vector<std::pair<device::EndCause, device::Safety>> ends;

private:
    double step_;
    int cycles_;
};

/// A session and a robot without a socket; time is moved by hand.
class Bench final : public Wire {
public:
    explicit Bench(std::string software = kExternal, EdoOptions with = benchOptions())
        : options(std::move(with)), robot(std::move(software), [this](std::string text) {
              to_session_.push_back(std::move(text));
          }) {}

    void connect() {
        session.linkUp(now, *this);
        deliver();
    }
    /// Connects, and lets the robot speak.
    void start() {
        connect();
        run(200);
    }
    void send(std::string_view text) noexcept override { robot.receive(text); }

    /// One cycle of the robot.
    void cycle() {
        now += std::chrono::milliseconds(10);
        robot.tick();
        deliver();
        ticked = session.tick(now, *this);
        deliver();
        core.dispatch();
        session.gripperSlot().dispatch();
    }
    void run(int milliseconds) {
        for (int i = 0; i < milliseconds / 10; ++i) {
            cycle();
        }
    }
    /// Cycles until `holds`, at most for `longest` ms. \return whether it came to hold
    template <typename Condition>
    bool runUntil(Condition holds, int longest = 20'000) {
        for (int i = 0; i < longest / 10 && !holds(); ++i) {
            cycle();
        }
        return holds();
    }
    /// Asks for a reset, runs cycles until it has ended, and asks how it ended.
    Result<void> reset() {
        auto& slot = session.resetSlot();
        auto answer = slot.ask();
        runUntil([&] { return !slot.underWay(); });
        if (!answer && safety() == device::SafetyState::normal) {
            return {};
        }
        answer = answer ? answer : slot.ask();
        return answer ? *answer : fail(Errc::timeout, "the reset has not ended");
    }

    std::shared_ptr<Stepper> attach(double step, int cycles) {
        auto source = std::make_shared<Stepper>(step, cycles);
        attached = core.attach(source);
        return source;
    }
    device::SafetyState safety() const { return core.safetyState(); }
    std::string text() const { return core.safety().text; }

    EdoOptions options;
    SteadyTime now{std::chrono::seconds(1000)};
    device::ArmCore core{{options.name, options.axis_names, EdoOptions::kCycle}};
    FakeEdo robot;
    Session session{options, core};
    Result<void> ticked;
    Result<void> attached;

private:
    void deliver() {
        while (!to_session_.empty()) {
            const auto text = std::exchange(to_session_.front(), {});
            to_session_.pop_front();
            session.onText(text, now, *this);
        }
    }

    std::deque<std::string> to_session_;
};

}  // namespace metier::edo_driver::testing
