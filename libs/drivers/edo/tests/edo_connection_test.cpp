// The whole driver against a scripted robot behind a real websocket.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <condition_variable>
#include <future>
#include <mutex>

#include "edo_arm.hpp"
#include "fake_edo.hpp"
#include "metier/device/driver.hpp"
#include "rosbridge_server.hpp"

namespace metier::device {
Driver edoDriver();
}  // namespace metier::device

namespace metier::edo_driver {
namespace {

using namespace std::chrono_literals;
using device::EndCause;
using device::SafetyState;
using testing::FakeEdo;
using ::testing::HasSubstr;
using testing::RosbridgeServer;

/// A robot on a free port, at its real rate.
class Robot {
public:
    explicit Robot(const char* software)
        : edo_(software, [this](std::string text) { server_->send(std::move(text)); }) {
        server_ = std::make_unique<RosbridgeServer>(
            [this](std::string_view text) {
                const std::lock_guard lock(mutex_);
                edo_.receive(text);
            },
            [this] {
                const std::lock_guard lock(mutex_);
                edo_.tick();
            },
            10ms);
    }

    /// The robot, while nothing else happens to it.
    template <typename Use>
    auto with(Use use) {
        const std::lock_guard lock(mutex_);
        return use(edo_);
    }
    RosbridgeServer& server() { return *server_; }

private:
    std::mutex mutex_;
    FakeEdo edo_;
    std::unique_ptr<RosbridgeServer> server_;
};

/// Moves axis 1 with 0.1 rad/s for so many cycles.
class Source final : public device::SetPointSource {
public:
    explicit Source(int cycles) : cycles_(cycles) {}

    Next next(const device::ArmState&, device::JointArray& set_point) noexcept override {
        if (holds_.load()) {
            return Next::set_point;
        }
        if (asked_.fetch_add(1) >= cycles_) {
            return Next::done;
        }
        set_point[0] += 0.001;
        return Next::set_point;
    }
    void ended(EndCause cause, const device::Safety&) override { end_.set_value(cause); }

    /// Keeps the arm where it is, or goes on.
    void hold(bool holds) { holds_.store(holds); }
    int asked() const { return asked_.load(); }
    /// Waits until the arm moves, at most 20 s.
    bool moves() const {
        const auto deadline = std::chrono::steady_clock::now() + 20s;
        while (asked() < 10 && std::chrono::steady_clock::now() < deadline) {
            std::this_thread::yield();
        }
        return asked() >= 10;
    }
    /// Waits for the end, at most 20 s.
    std::optional<EndCause> end() {
        return ended_.wait_for(20s) == std::future_status::ready ? std::optional(ended_.get())
                                                                 : std::nullopt;
    }

private:
    const int cycles_;
    std::atomic<int> asked_{0};
    std::atomic<bool> holds_{false};
    std::promise<EndCause> end_;
    std::future<EndCause> ended_ = end_.get_future();
};

device::OpenRequest requestFor(std::uint16_t port) {
    device::OpenRequest request;
    request.name = "edo";
    request.address = "127.0.0.1";
    request.settings.set("port", static_cast<double>(port));
    request.settings.set("joint_timeout", 5.0);  // the machine of the test may be busy
    request.settings.set("machine_timeout", 5.0);
    return request;
}

class EdoConnectionTest : public ::testing::TestWithParam<const char*> {
protected:
    const device::OpenDevice& open() {
        device_ = device::edoDriver().open(requestFor(robot_.server().port())).value();
        watch_ = device_.arm->onSafetyChange([this](const device::Safety&) {
            const std::lock_guard lock(mutex_);
            changed_.notify_all();
        });
        return device_;
    }
    void close() {
        watch_ = {};
        device_ = {};
    }
    bool waitFor(const device::Arm& arm, SafetyState state) {
        std::unique_lock lock(mutex_);
        const auto deadline = std::chrono::steady_clock::now() + 20s;
        while (arm.safety().state != state && std::chrono::steady_clock::now() < deadline) {
            changed_.wait_for(lock, 5ms);  // changes that follow each other may not be reported
        }
        return arm.safety().state == state;
    }
    /// Waits until the arm's safety says so; what it says then. It need not change its state.
    std::string tellsSoon(const device::Arm& arm, const std::string& part) {
        std::unique_lock lock(mutex_);
        const auto deadline = std::chrono::steady_clock::now() + 20s;
        auto text = arm.safety().text;
        while (text.find(part) == std::string::npos &&
               std::chrono::steady_clock::now() < deadline) {
            changed_.wait_for(lock, 5ms);
            text = arm.safety().text;
        }
        return text;
    }
    static std::shared_ptr<Source> attach(device::Arm& arm, int cycles) {
        auto source = std::make_shared<Source>(cycles);
        const auto attached = arm.attach(source);
        EXPECT_TRUE(attached) << attached.error().message;
        return source;
    }

    Robot robot_{GetParam()};
    std::mutex mutex_;
    std::condition_variable changed_;
    device::OpenDevice device_;
    device::Registration watch_;  // ends before its arm
};
INSTANTIATE_TEST_SUITE_P(Edo, EdoConnectionTest, ::testing::Values("edo_2.4.0", "edo_3.2.0"),
                         [](const auto& of) {
                             return of.param == std::string("edo_2.4.0") ? "Classic" : "External";
                         });

TEST_P(EdoConnectionTest, MovesTheArmAndThenTheJaws) {
    const auto& device = open();
    ASSERT_TRUE(waitFor(*device.arm, SafetyState::normal)) << device.arm->safety().text;
    EXPECT_EQ(device.arm->info().axisCount(), 6U);
    EXPECT_EQ(device.arm->info().cycle, 10ms);
    const auto source = std::make_shared<Source>(50);
    source->hold(true);
    ASSERT_TRUE(device.arm->attach(source));
    EXPECT_EQ(device.gripper->release({}, [](auto) {}).error().code, Errc::resource_unavailable);
    EXPECT_EQ(device.arm->attach(std::make_shared<Source>(1)).error().code,
              Errc::resource_unavailable);
    source->hold(false);
    EXPECT_EQ(source->end(), EndCause::done);
    EXPECT_NEAR(device.arm->state().commanded_position[0], 0.05, 1e-9);

    std::promise<Result<device::GripperOutcome>> done;
    auto outcome = done.get_future();
    ASSERT_TRUE(device.gripper->release({}, [&](auto result) { done.set_value(result); }));
    EXPECT_EQ(device.arm->attach(std::make_shared<Source>(1)).error().code,
              Errc::resource_unavailable);
    ASSERT_EQ(outcome.wait_for(20s), std::future_status::ready);
    const auto released = outcome.get();
    ASSERT_TRUE(released) << released.error().message;
    EXPECT_NEAR(released->width, 0.08, 1e-4);
    EXPECT_NEAR(robot_.with([](auto& edo) { return edo.joints[0]; }), 2.8648, 1e-3);
}

TEST_P(EdoConnectionTest, ComesBackAfterALostLinkAndMovesNothing) {
    const auto& device = open();
    ASSERT_TRUE(waitFor(*device.arm, SafetyState::normal));
    const auto source = attach(*device.arm, 100'000);
    ASSERT_TRUE(source->moves());
    robot_.server().drop();
    EXPECT_EQ(source->end(), EndCause::disconnected);
    const int asked = source->asked();
    ASSERT_TRUE(waitFor(*device.arm, SafetyState::normal)) << device.arm->safety().text;
    EXPECT_EQ(robot_.server().connections(), 2);
    EXPECT_EQ(source->asked(), asked);
    const auto next = attach(*device.arm, 5);
    EXPECT_EQ(next->end(), EndCause::done) << "although control was left taken";
}

TEST_P(EdoConnectionTest, ResetFaultReleasesTheBrakes) {
    const auto& device = open();
    ASSERT_TRUE(waitFor(*device.arm, SafetyState::normal));
    robot_.with([](auto& edo) { edo.brake(1U << 9U); });
    ASSERT_TRUE(waitFor(*device.arm, SafetyState::protective_stop));
    EXPECT_THAT(device.arm->safety().text, HasSubstr("edo: BRAKED (collision)"));
    EXPECT_EQ(device.gripper->state().safety, SafetyState::protective_stop);
    EXPECT_EQ(device.gripper->grasp({}, [](auto) {}).error().code, Errc::device_fault);
    auto reset = device.arm->resetFault();
    const auto deadline = std::chrono::steady_clock::now() + 20s;
    while (!reset && reset.error().code == Errc::timeout &&
           std::chrono::steady_clock::now() < deadline) {
        EXPECT_THAT(reset.error().message, HasSubstr("edo: the reset goes on, ask again"));
        reset = device.arm->resetFault();
    }
    EXPECT_TRUE(reset) << reset.error().message;
    EXPECT_EQ(device.arm->safety().state, SafetyState::normal);
}

TEST_P(EdoConnectionTest, GivesControlBackWhenItEnds) {
    const auto& device = open();
    ASSERT_TRUE(waitFor(*device.arm, SafetyState::normal));
    const auto source = attach(*device.arm, 100'000);
    ASSERT_TRUE(source->moves());
    close();
    EXPECT_EQ(source->end(), EndCause::stopped);
    EXPECT_FALSE(robot_.with([](auto& edo) { return edo.control_taken; }));
}

TEST(EdoDriver, IsDisconnectedWhileNobodyAnswers) {
    const auto device = device::edoDriver().open(requestFor(1)).value();
    EXPECT_EQ(device.arm->safety().state, SafetyState::disconnected);
    EXPECT_EQ(device.arm->resetFault().error().code, Errc::connection_lost);
    EXPECT_EQ(device.arm->attach(std::make_shared<Source>(1)).error().code, Errc::device_fault);
    EXPECT_EQ(device.gripper->release({}, [](auto) {}).error().code, Errc::connection_lost);
    EXPECT_DOUBLE_EQ(device.gripper->info().stroke, 0.08);
    EXPECT_DOUBLE_EQ(device.gripper->info().max_force, 0.0);
}

TEST_P(EdoConnectionTest, TellsWhyAResetFailed) {
    robot_.with([](auto& edo) {
        edo.restart();
        edo.uncalibrated = true;
    });
    const auto& device = open();
    ASSERT_TRUE(waitFor(*device.arm, SafetyState::protective_stop)) << device.arm->safety().text;
    auto reset = device.arm->resetFault();
    const auto deadline = std::chrono::steady_clock::now() + 20s;
    while (!reset && reset.error().code == Errc::timeout &&
           std::chrono::steady_clock::now() < deadline) {
        std::this_thread::yield();
        reset = device.arm->resetFault();
    }
    ASSERT_FALSE(reset);
    EXPECT_EQ(reset.error().code, Errc::device_fault);
    EXPECT_THAT(reset.error().message, HasSubstr("edo: NOT_CALIBRATED"));
}

TEST_P(EdoConnectionTest, TellsWhereNoVersionIsAnsweredAndTriesAgain) {
    robot_.with([](auto& edo) { edo.faults.mute_services = true; });
    const auto& device = open();
    const auto text = tellsSoon(*device.arm, "machine_bridge_sw_version_srv");
    EXPECT_THAT(text, HasSubstr("edo: 127.0.0.1:"));
    EXPECT_THAT(text, HasSubstr("no answer of /machine_bridge_sw_version_srv within 3 s"));
    robot_.with([](auto& edo) { edo.faults.mute_services = false; });
    EXPECT_TRUE(waitFor(*device.arm, SafetyState::normal)) << device.arm->safety().text;
    EXPECT_GE(robot_.server().connections(), 2);
}

TEST(EdoDriver, TellsASettingThatIsWrong) {
    auto request = requestFor(1);
    request.settings.set("stroke", 8.0);
    const auto device = device::edoDriver().open(request);
    ASSERT_FALSE(device);
    EXPECT_THAT(device.error().message, HasSubstr("stroke"));
}

TEST(EdoDriver, TellsWhatItsJawsCannotDoWithTheNameOfTheGripper) {
    const auto device = device::edoDriver().open(requestFor(1)).value();
    EXPECT_EQ(device.gripper->move({.width = 0.2}, [](auto) {}).error().message,
              "edo gripper: width 0.2 m is not within 0 and 0.08 m");
}

TEST(EdoDriver, TellsAHostThatHasNoAddress) {
    auto request = requestFor(1);
    request.address = "no host";
    const auto device = device::edoDriver().open(request).value();
    const auto deadline = std::chrono::steady_clock::now() + 20s;
    while (device.arm->safety().text.find("no host:1: ") == std::string::npos) {
        ASSERT_LT(std::chrono::steady_clock::now(), deadline) << device.arm->safety().text;
        std::this_thread::yield();
    }
    EXPECT_EQ(device.arm->safety().state, SafetyState::disconnected);
}

TEST(EdoDriver, HasNoGripperIfTheSettingsSaySo) {
    auto request = requestFor(1);
    request.settings.set("gripper", false);
    EXPECT_EQ(device::edoDriver().open(request)->gripper, nullptr);
}

}  // namespace
}  // namespace metier::edo_driver
