#pragma once

#include <gmock/gmock.h>

#include <asio/io_context.hpp>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "robot.hpp"

namespace metier::virtual_ur {

inline motion::RobotModel modelOf(const std::string& name) {
    return motion::RobotModel::load(std::string(METIER_MODELS_DIR) + "/" + name + ".toml").value();
}

/// A world whose effect is set by hand.
class HandMadeWorld final : public virtual_controller::WorldLink {
public:
    void report(const virtual_controller::WorldReport& report) override { reported = report; }
    const virtual_controller::WorldEffect& effect() const override { return given; }

    virtual_controller::WorldReport reported;
    virtual_controller::WorldEffect given;
};

/// A virtual robot without ports; time is moved by hand.
class RobotOnTable {
public:
    using Values = std::map<std::string, cell::Settings::Value>;

    explicit RobotOnTable(const std::string& model_name = "ur5", Values settings = {})
        : model(modelOf(model_name)),
          robot(
              readOptions(cell::Settings("test", std::move(settings)), model).value(),
              {context, faults, world, [this](const Bytes& message) { told.push_back(message); }}) {
    }

    void cycles(std::size_t count) {
        for (std::size_t i = 0; i < count; ++i) {
            robot.cycle();
        }
    }
    void seconds(double time) {
        cycles(static_cast<std::size_t>(std::lround(time * robot.rate())));
    }
    /// Cycles until it is so, at most that many seconds. \return whether it became so
    template <typename Condition>
    bool until(Condition condition, double most = 20.0) {
        for (double time = 0.0; time < most; time += 1.0 / robot.rate()) {
            if (condition()) {
                return true;
            }
            robot.cycle();
        }
        return condition();
    }
    bool runtimeBecomes(RuntimeState state) {
        return until([&] { return robot.state().runtime_state == state; });
    }
    /// Reports whether a message of that kind (its tenth byte after the head) with that text was
    /// sent.
    bool wasReported(int kind, const std::string& text) const {
        return std::any_of(told.begin(), told.end(), [&](const Bytes& message) {
            const std::string all(reinterpret_cast<const char*>(message.data()), message.size());
            return message.size() > 14 && static_cast<int>(message[14]) == kind &&
                   all.find(text) != std::string::npos;
        });
    }

    asio::io_context context;
    virtual_controller::LinkFaults faults;
    HandMadeWorld world;
    std::vector<Bytes> told;
    motion::RobotModel model;
    Robot robot;
};

}  // namespace metier::virtual_ur
