#pragma once

#include <gmock/gmock.h>

#include <memory>
#include <optional>
#include <string>

#include "fake_controller.hpp"
#include "metier/device/driver.hpp"
#include "moving_source.hpp"
#include "ur_arm.hpp"

namespace metier::device {
Driver urDriver();
}

namespace metier::ur_driver {

using device::EndCause;
using device::SafetyState;
using testing::AllOf;
using testing::HasSubstr;

inline motion::RobotModel ur5() {
    return motion::RobotModel::load(METIER_MODELS_DIR "/ur5.toml").value();
}

/// An arm that the driver opened at a fake controller.
class ArmTest : public testing::Test {
protected:
    using Values = std::map<std::string, cell::Settings::Value>;

    /// \param changed settings that differ from the fake's
    void open(const Values& changed = {}) {
        auto values = fake_.settings();
        for (const auto& [name, value] : changed) {
            values[name] = value;
        }
        auto opened =
            device::urDriver().open({"ur5", "127.0.0.1", cell::Settings("test", values), &model_});
        ASSERT_TRUE(opened) << opened.error().message;
        device_ = std::move(*opened);
    }
    /// open(), and waits until the arm may move and the driver has finished a cycle with it.
    void openReady(const Values& changed = {}) {
        open(changed);
        ASSERT_TRUE(becomes(SafetyState::normal)) << arm().safety().text;
        const auto cycle = arm().state().cycle;
        ASSERT_TRUE(fake_.await([&] { return arm().state().cycle > cycle; }));
    }

    device::Arm& arm() { return *device_.arm; }
    bool becomes(SafetyState state) {
        return fake_.await([&] { return arm().state().safety == state; });
    }
    std::shared_ptr<MovingSource> attach(double distance, int cycles) {
        auto source = std::make_shared<MovingSource>(distance, cycles);
        const auto attached = arm().attach(source);
        EXPECT_TRUE(attached) << attached.error().message;
        return source;
    }
    /// Attaches a long motion and waits until it moves.
    std::shared_ptr<MovingSource> moving() {
        auto source = attach(1.0, 1000);
        EXPECT_TRUE(fake_.await([&] { return source->asked() > 20; })) << arm().safety().text;
        return source;
    }
    std::string attachError() {
        const auto attached = arm().attach(std::make_shared<MovingSource>(0.1, 10));
        return attached ? "" : attached.error().message;
    }
    /// Resets until it is done or 10 s have passed; the last error.
    std::string resetUntilDone() {
        Result<void> result;
        fake_.await([&] {
            result = arm().resetFault();
            return result || result.error().code == Errc::device_fault;
        });
        return result ? "" : result.error().message;
    }

    FakeController fake_;
    motion::RobotModel model_ = ur5();
    device::OpenDevice device_;  // ends before the controller
};

}  // namespace metier::ur_driver
