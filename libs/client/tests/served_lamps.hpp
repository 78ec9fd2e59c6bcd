#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "metier/client/skill_handle.hpp"
#include "metier/skill/state.hpp"
#include "served_nodes.hpp"

namespace metier::client::testing {

/// What the server was asked for, in order.
class Calls {
public:
    void add(std::string call) {
        {
            const std::lock_guard lock(mutex_);
            calls_.push_back(std::move(call));
        }
        changed_.notify_all();
    }
    /// All but the renewals of locks.
    std::vector<std::string> all() const {
        const std::lock_guard lock(mutex_);
        std::vector<std::string> calls;
        std::copy_if(calls_.begin(), calls_.end(), std::back_inserter(calls),
                     [](const auto& call) { return call != "RenewLock"; });
        return calls;
    }
    /// Waits until it was asked so often; false after 10 s.
    bool await(const std::string& call, int times) {
        std::unique_lock lock(mutex_);
        return changed_.wait_for(lock, std::chrono::seconds(10), [&] {
            return std::count(calls_.begin(), calls_.end(), call) >= times;
        });
    }

private:
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<std::string> calls_;
};

/// A device with two lamps, each of which goes on with Start and off with End.
class LockedDevice : public ::testing::Test {
protected:
    static constexpr std::uint16_t kDi = 2;  // index of the namespace of OPC 10000-100
    enum class Lock { implemented, bare };

    LockedDevice() : device_(served_.object(opcua::ids::kObjectsFolder, "Light")) {
        const auto skills = served_.object(device_, "Skills");
        for (const auto* name : {"Left", "Right"}) {
            addLamp(skills, name);
        }
    }

    struct Lamp {
        SkillAddress address;
        opcua::NodeId end;
    };
    void addLamp(const opcua::NodeId& skills, const std::string& name) {
        auto& lamp = lamps_[name];
        const auto node = served_.program(skills, name);
        lamp.address.name = name;
        lamp.address.node = node;
        lamp.address.above = {{"Light", device_}, {"Skills", skills}};
        const auto current = served_.variable(node, {0, "CurrentState"}, opcua::Value::of("Ready"));
        const auto state =
            served_.variable(current, {0, "Number"}, opcua::Value::of(number(skill::State::ready)));
        const auto parameters = served_.object(node, "ParameterSet");
        const auto level =
            served_.nodes()
                .addVariable({.node = {{}, parameters, opcua::ids::kHasComponent, {1, "Level"}},
                              .value = opcua::Value::of(0.0),
                              .access = opcua::Access::read_write})
                .value();
        const auto go = [this, state](skill::State to) -> Result<std::vector<opcua::Value>> {
            METIER_TRY(served_.nodes().write(state, opcua::Value::of(number(to))));
            return std::vector<opcua::Value>();
        };
        setMethod(served_.method(node, "Start"), [this, name, level, go](auto /*in*/) {
            const auto value = served_.nodes().read(level).value();
            calls_.add(fmt::format("{} Start {}", name, value.value.as<double>().value()));
            return refuses_start_ ? fail(Errc::invalid_state, "no") : go(skill::State::running);
        });
        lamp.end = served_.method(node, "End");
        setMethod(lamp.end, [this, name, go](auto /*in*/) {
            calls_.add(name + " End");
            return go(skill::State::ready);
        });
        setMethod(served_.method(node, "Suspend"),
                  [go](auto /*in*/) { return go(skill::State::suspended); });
        setMethod(served_.method(node, "Resume"),
                  [go](auto /*in*/) { return go(skill::State::running); });
        setMethod(served_.method(node, "Halt"), [this, name, go](auto /*in*/) {
            calls_.add(name + " Halt");
            return go(skill::State::halted);
        });
    }
    /// \param remaining RemainingLockTime [ms]
    void addLock(Lock kind = Lock::implemented, double remaining = 3.0e5) {
        const auto lock = add(device_, "Lock");
        client_ = served_.variable(lock, {kDi, "LockingClient"}, opcua::Value::of("the panel"));
        served_.variable(lock, {kDi, "RemainingLockTime"}, opcua::Value::of(remaining));
        for (const auto* name : {"InitLock", "RenewLock", "ExitLock"}) {
            opcua::MethodSpec spec{
                .node = {{}, lock, opcua::ids::kHasComponent, {kDi, name}},
                .outputs = {{.name = "Status", .data_type = opcua::NodeId(0, 6U)}}};
            if (std::string_view(name) == "InitLock") {
                spec.inputs = {{.name = "Context", .data_type = opcua::NodeId(0, 12U)}};
            }
            const auto method = served_.nodes().addMethod(spec).value();
            if (kind == Lock::implemented) {
                setMethod(method, [this, name](auto /*in*/) -> Result<std::vector<opcua::Value>> {
                    calls_.add(name);
                    return std::vector{opcua::Value::of(lock_status_.load())};
                });
            }
        }
    }

    static std::uint32_t number(skill::State state) { return static_cast<std::uint32_t>(state); }
    opcua::NodeId add(const opcua::NodeId& parent, const std::string& name) {
        return served_.nodes()
            .addObject({{{}, parent, opcua::ids::kHasComponent, {kDi, name}},
                        opcua::ids::kBaseObjectType,
                        opcua::EventNotifier::none,
                        opcua::Children::none})
            .value();
    }
    void setMethod(
        const opcua::NodeId& method,
        std::function<Result<std::vector<opcua::Value>>(std::span<const opcua::Value>)> work) {
        EXPECT_TRUE(served_.nodes().setMethod(
            method,
            [work = std::move(work)](const auto& /*caller*/, auto in) { return work(in); }));
    }
    void end(const std::string& lamp) {
        const auto& [address, method] = lamps_.at(lamp);
        EXPECT_TRUE(served_.client().call(address.node, method));
    }
    SkillHandle open(const std::string& lamp) {
        return std::move(SkillHandle::open(served_.client(), lamps_.at(lamp).address).value());
    }

    Calls calls_;
    // Set before the server is asked, and read on its thread then.
    std::atomic<std::int32_t> lock_status_ = 0;
    std::atomic<bool> refuses_start_ = false;
    ServedNodes served_{{}, {"http://opcfoundation.org/UA/DI/"}};  // its thread uses the above
    opcua::NodeId device_;
    std::map<std::string, Lamp> lamps_;
    opcua::NodeId client_;
};

}  // namespace metier::client::testing
