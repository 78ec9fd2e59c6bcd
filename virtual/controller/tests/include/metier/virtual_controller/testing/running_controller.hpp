#pragma once

#include <asio/io_context.hpp>
#include <asio/post.hpp>
#include <chrono>
#include <cstdint>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <thread>

#include "metier/virtual_controller/controller.hpp"

namespace metier::virtual_controller::testing {

/// A world whose effect the test sets.
class ScriptedWorld final : public WorldLink {
public:
    /// Like a real world it answers reports: there is no effect before the first report.
    void report(const WorldReport& report) override {
        last_report = report;
        ++reports;
        answered_ = true;
    }
    const WorldEffect& effect() const override { return answered_ ? next_effect : none_; }

    WorldReport last_report;
    std::uint64_t reports = 0;  ///< number of reports so far
    WorldEffect next_effect;

private:
    WorldEffect none_;
    bool answered_ = false;
};

/// Parameters with which a test starts a controller.
struct Start {
    std::map<std::string, cell::Settings::Value> settings;
    const motion::RobotModel* model = nullptr;
    std::string address = "127.0.0.1";
};

/// A virtual controller on a thread of its own, as in its process.
class RunningController {
public:
    RunningController(const ControllerType& type, const Start& start) {
        auto controller =
            type.start({context_, "test", start.address, cell::Settings("test", start.settings),
                        start.model, faults, world_});
        if (!controller) {
            throw std::runtime_error(controller.error().message);
        }
        controller_ = std::move(*controller);
        thread_ = std::jthread([this](const std::stop_token& stop) {
            const std::stop_callback end(stop, [this] { context_.stop(); });
            context_.run();
        });
    }

    /// Runs an action on the controller's thread and waits for its end.
    void inTurn(const std::function<void(Controller&, ScriptedWorld&)>& action) {
        std::promise<void> done;
        asio::post(context_, [&] {
            action(*controller_, world_);
            done.set_value();
        });
        done.get_future().get();
    }
    Result<void> inject(const std::string& name, const std::string& value = "") {
        Result<void> result;
        inTurn([&](Controller& controller, ScriptedWorld&) {
            result = controller.inject({name, value});
        });
        return result;
    }
    nlohmann::ordered_json state() {
        nlohmann::ordered_json result;
        inTurn([&](Controller& controller, ScriptedWorld&) { result = controller.state(); });
        return result;
    }
    void setEffect(const WorldEffect& effect) {
        inTurn([&](Controller&, ScriptedWorld& world) { world.next_effect = effect; });
    }
    WorldReport report() {
        WorldReport result;
        inTurn([&](Controller&, ScriptedWorld& world) { result = world.last_report; });
        return result;
    }
    /// Reads state() until it is as wanted. False after `longest`.
    bool waitUntil(const std::function<bool(const nlohmann::ordered_json&)>& wanted,
                   std::chrono::milliseconds longest = std::chrono::seconds(10)) {
        const auto end = std::chrono::steady_clock::now() + longest;
        while (!wanted(state())) {
            if (std::chrono::steady_clock::now() > end) {
                return false;
            }
            std::this_thread::yield();
        }
        return true;
    }

    LinkFaults faults;

private:
    asio::io_context context_;
    ScriptedWorld world_;
    std::unique_ptr<Controller> controller_;
    std::jthread thread_;
};

}  // namespace metier::virtual_controller::testing
