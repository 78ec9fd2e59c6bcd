#include "device_lock.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <future>
#include <optional>
#include <utility>

#include "metier/opcua/text.hpp"
#include "metier/opcua_skill/namespaces.hpp"
#include "metier/opcua_skill/wire_numbers.hpp"
#include "questions.hpp"

namespace metier::client {

using opcua::Answer;
using opcua::CallResult;
using opcua::Failure;
using opcua::NodeId;
using opcua::Value;
using opcua_skill::kDiUri;
using opcua_skill::LockStatus;
using namespace std::chrono_literals;

namespace {

const NodeId kServerCapabilities(0, 2268U);

constexpr auto kDone = static_cast<std::int32_t>(LockStatus::done);
constexpr auto kAlreadyLocked = static_cast<std::int32_t>(LockStatus::refused);

// How often a lock is renewed whose server publishes no time, and the limits for one that does.
constexpr auto kRenewal = 1'000ms;
constexpr auto kShortestRenewal = 50ms;
constexpr auto kLongestRenewal = 60'000ms;
constexpr int kRenewalsPerTime = 3;

// Codes by which servers say that a Method is there and has no implementation.
constexpr std::array kNotImplemented{
    opcua::StatusCode(0x80400000),  // BadNotImplemented
    opcua::StatusCode(0x803D0000),  // BadNotSupported
    opcua::status::kBadServiceUnsupported, opcua::status::kBadMethodInvalid,
    opcua::status::kBadNotExecutable,      opcua::status::kBadInternalError};

bool isNotImplemented(const Answer<CallResult>& answer) {
    return !answer && answer.error().delivery == Failure::Delivery::answered &&
           std::find(kNotImplemented.begin(), kNotImplemented.end(), answer.error().status) !=
               kNotImplemented.end();
}

std::int32_t statusOf(const CallResult& result) {
    return result.outputs.empty() ? kDone
                                  : result.outputs.front().as<std::int32_t>().value_or(kDone);
}

/// Outcome of a Method of the lock, which returns a status.
Answer<> outcomeOf(const Answer<CallResult>& answer, const LockNodes& nodes, const char* method) {
    if (!answer) {
        return tl::unexpected(answer.error());
    }
    const auto status = statusOf(*answer);
    return status == kDone
               ? Answer<>()
               : tl::unexpected(
                     failureOf(Errc::locked, fmt::format("the device {} refused {} with status {}",
                                                         nodes.device, method, status)));
}

/// Pause between renewals for the times [ms] that a server publishes.
std::chrono::milliseconds renewalFor(const std::vector<opcua::DataValue>& times) {
    std::optional<double> least;
    for (const auto& time : times) {
        const auto ms = time.value.as<double>().value_or(0.0);
        if (ms > 0.0) {
            least = std::min(ms, least.value_or(ms));
        }
    }
    if (!least) {
        return kRenewal;
    }
    const auto third = std::min(*least / kRenewalsPerTime, double(kLongestRenewal.count()));
    return std::max(std::chrono::milliseconds(std::int64_t(third)), kShortestRenewal);
}

}  // namespace

Answer<LockNodes> findLock(opcua::Client& client, const SkillAddress& skill) {
    const auto di = client.namespaceIndex(kDiUri);
    if (!di) {
        return di.error().code == Errc::not_found ? Answer<LockNodes>(LockNodes())
                                                  : tl::unexpected(di.error());
    }
    constexpr std::array kMembers{&LockNodes::init, &LockNodes::renew, &LockNodes::exit,
                                  &LockNodes::client, &LockNodes::remaining};
    constexpr std::array kNames{"InitLock", "RenewLock", "ExitLock", "LockingClient",
                                "RemainingLockTime"};
    std::vector<SkillAddress::Above> owners{{skill.name, skill.node}};
    owners.insert(owners.end(), skill.above.rbegin(), skill.above.rend());
    std::vector<opcua::RelativePath> paths{{kServerCapabilities, {{*di, "MaxInactiveLockTime"}}}};
    for (const auto& owner : owners) {
        paths.push_back({owner.node, {{*di, "Lock"}}});
        for (const auto* name : kNames) {
            paths.push_back({owner.node, {{*di, "Lock"}, {*di, name}}});
        }
    }
    METIER_ASSIGN(const auto found, client.translateMany(std::move(paths)));
    for (std::size_t i = 0; i < owners.size(); ++i) {
        const auto first = 1 + i * (1 + kNames.size());
        LockNodes nodes{.device = owners[i].name,
                        .lock = found[first].value_or(NodeId()),
                        .most_silent = found[0].value_or(NodeId())};
        for (std::size_t member = 0; member < kMembers.size(); ++member) {
            nodes.*kMembers.at(member) = found[first + 1 + member].value_or(NodeId());
        }
        if (!nodes.lock.isNull() && !nodes.init.isNull() && !nodes.exit.isNull()) {
            return nodes;
        }
    }
    return LockNodes();
}

DeviceLocks::~DeviceLocks() {
    thread_.request_stop();
    thread_ = {};
    for (const auto& [id, lock] : locks_) {
        if (lock.stage == Stage::held) {
            // If it does not arrive, the session ends, and with it the lock.
            static_cast<void>(
                client_.callAsync({id, lock.nodes.exit, {}}, [](const auto& /*any*/) {}));
        }
    }
}

void DeviceLocks::take(const LockNodes& nodes, const Done& done) {
    bool has_it = false;
    bool must_ask = false;
    {
        const std::lock_guard guard(mutex_);
        const auto [found, is_new] = locks_.try_emplace(nodes.lock, Lock{.nodes = nodes});
        auto& lock = found->second;
        has_it = lock.stage == Stage::held || lock.stage == Stage::missing;
        must_ask = is_new;
        if (has_it) {
            ++lock.users;
        } else {
            lock.waiting.push_back(done);
        }
    }
    if (has_it) {
        done({});
    } else if (must_ask) {
        ask(nodes);
    }
}

void DeviceLocks::ask(const LockNodes& nodes) {
    const auto sent =
        client_.callAsync({nodes.lock, nodes.init, {Value::of(std::string("metier runs a skill"))}},
                          [self = shared_from_this(), nodes](const Answer<CallResult>& answer) {
                              self->asked(nodes, answer);
                          });
    if (!sent) {
        settle(nodes, Stage::missing, sent);
    }
}

void DeviceLocks::asked(const LockNodes& nodes, const Answer<CallResult>& answer) {
    if (isNotImplemented(answer)) {
        spdlog::warn("the device {} does not implement its lock ({}): its skills run without",
                     nodes.device, answer.error().status.name());
        settle(nodes, Stage::missing, {});
        return;
    }
    const auto outcome = outcomeOf(answer, nodes, "InitLock");
    if (outcome) {
        settle(nodes, Stage::held, {});
    } else if (answer && statusOf(*answer) == kAlreadyLocked && !nodes.client.isNull()) {
        explainRefusal(nodes, outcome.error());
    } else {
        settle(nodes, Stage::missing, outcome);
    }
}

/// Adds the name of the client that holds the lock.
void DeviceLocks::explainRefusal(const LockNodes& nodes, Failure failure) {
    const auto sent = client_.readManyAsync(
        {{nodes.client}}, [self = shared_from_this(), nodes,
                           failure](const Answer<std::vector<opcua::DataValue>>& values) mutable {
            const auto name =
                opcua::sanitise(values ? values->front().value.as<std::string>().value_or("") : "");
            failure.message =
                fmt::format("the device {} is locked by {}", nodes.device,
                            name.empty() ? "another client" : fmt::format("\"{}\"", name));
            self->settle(nodes, Stage::missing, tl::unexpected(failure));
        });
    if (!sent) {
        settle(nodes, Stage::missing, tl::unexpected(failure));
    }
}

/// Ends the wait for InitLock.
/// \param stage held, or missing; with an error nothing is kept of the lock
void DeviceLocks::settle(const LockNodes& nodes, Stage stage, const Answer<>& outcome) {
    std::vector<Done> waiting;
    {
        const std::lock_guard guard(mutex_);
        auto& lock = locks_.at(nodes.lock);
        waiting = std::exchange(lock.waiting, {});
        lock.stage = stage;
        lock.users = static_cast<int>(waiting.size());
        lock.renewal = kRenewal;
        lock.next_renewal = std::chrono::steady_clock::now() + kRenewal;
        lock.loss_reported = false;
        ++changes_;
        if (!outcome) {
            locks_.erase(nodes.lock);
        } else if (stage == Stage::held && !thread_.joinable() && !nodes.renew.isNull()) {
            thread_ = std::jthread([this](const std::stop_token& stop) { renewAll(stop); });
        }
    }
    changed_.notify_all();
    if (outcome && stage == Stage::held) {
        learnTime(nodes);
    }
    for (const auto& done : waiting) {
        done(outcome);
    }
}

void DeviceLocks::giveBack(const LockNodes& nodes, const Done& done) {
    bool must_leave = false;
    {
        const std::lock_guard guard(mutex_);
        const auto found = locks_.find(nodes.lock);
        const bool last = found != locks_.end() && --found->second.users == 0;
        must_leave = last && found->second.stage == Stage::held;
        if (must_leave) {
            found->second.stage = Stage::leaving;
            found->second.leaving.push_back(done);
        } else if (last) {
            locks_.erase(found);
        }
    }
    if (!must_leave) {
        done({});
        return;
    }
    const auto sent =
        client_.callAsync({nodes.lock, nodes.exit, {}},
                          [self = shared_from_this(), nodes](const Answer<CallResult>& answer) {
                              self->left(nodes, outcomeOf(answer, nodes, "ExitLock"));
                          });
    if (!sent) {
        left(nodes, sent);
    }
}

void DeviceLocks::left(const LockNodes& nodes, const Answer<>& outcome) {
    std::vector<Done> leaving;
    bool again = false;
    {
        const std::lock_guard guard(mutex_);
        auto& lock = locks_.at(nodes.lock);
        leaving = std::exchange(lock.leaving, {});
        again = !lock.waiting.empty();
        lock.stage = Stage::asking;
        if (!again) {
            locks_.erase(nodes.lock);
        }
    }
    for (const auto& done : leaving) {
        done(outcome);
    }
    if (again) {
        ask(nodes);
    }
}

/// Asks how long the lock lasts without a renewal.
void DeviceLocks::learnTime(const LockNodes& nodes) {
    std::vector<opcua::ReadItem> items;
    for (const auto& node : {nodes.remaining, nodes.most_silent}) {
        if (!node.isNull()) {
            items.push_back({node});
        }
    }
    if (items.empty() || nodes.renew.isNull()) {
        return;
    }
    const auto sent = client_.readManyAsync(
        std::move(items), [self = shared_from_this(),
                           id = nodes.lock](const Answer<std::vector<opcua::DataValue>>& times) {
            {
                const std::lock_guard guard(self->mutex_);
                const auto found = self->locks_.find(id);
                if (!times || found == self->locks_.end()) {
                    return;
                }
                found->second.renewal = renewalFor(*times);
                found->second.next_renewal =
                    std::chrono::steady_clock::now() + found->second.renewal;
                ++self->changes_;
            }
            self->changed_.notify_all();
        });
    static_cast<void>(sent);  // then it is renewed each kRenewal
}

/// Locks to renew now. If there are none, it first waits until one is due, or the times change, or
/// `stop`, and the answer is empty.
std::vector<LockNodes> DeviceLocks::dueRenewals(const std::stop_token& stop) {
    std::vector<LockNodes> due;
    std::unique_lock guard(mutex_);
    const auto now = std::chrono::steady_clock::now();
    auto next = now + kLongestRenewal;
    for (auto& [id, lock] : locks_) {
        if (lock.stage != Stage::held || lock.nodes.renew.isNull()) {
            continue;
        }
        if (lock.next_renewal <= now) {
            due.push_back(lock.nodes);
            lock.next_renewal = now + lock.renewal;
        }
        next = std::min(next, lock.next_renewal);
    }
    if (due.empty()) {
        changed_.wait_until(guard, stop, next,
                            [this, before = changes_] { return changes_ != before; });
    }
    return due;
}

void DeviceLocks::renewAll(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        for (const auto& nodes : dueRenewals(stop)) {
            renew(nodes);
        }
    }
}

void DeviceLocks::renew(const LockNodes& nodes) {
    // The answer may come after the end of this object, which waits for nothing.
    const auto sent = client_.callAsync(
        {nodes.lock, nodes.renew, {}},
        [locks = weak_from_this(), id = nodes.lock](const Answer<CallResult>& answer) {
            if (const auto self = locks.lock()) {
                self->renewed(id, answer);
            }
        });
    static_cast<void>(sent);  // it is tried again
}

void DeviceLocks::renewed(const NodeId& id, const Answer<CallResult>& answer) {
    std::string why;
    {
        const std::lock_guard guard(mutex_);
        const auto found = locks_.find(id);
        if (found == locks_.end() || found->second.stage != Stage::held) {
            return;
        }
        auto& lock = found->second;
        const auto outcome = outcomeOf(answer, lock.nodes, "RenewLock");
        const bool refused = !outcome && outcome.error().delivery == Failure::Delivery::answered;
        if (!refused || std::exchange(lock.loss_reported, true)) {
            return;
        }
        why = outcome.error().message;
    }
    spdlog::warn("the lock is lost, other clients may write and start: {}", why);
}

LockUse::~LockUse() {
    giveBack([](const auto& /*any*/) {});
}

void LockUse::take(Done done) {
    bool ask = false;
    {
        const std::lock_guard guard(mutex_);
        ask = nodes_.isThere() && state_ == State::free;
        state_ = ask ? State::asking : state_;
    }
    if (!ask) {
        done({});
        return;
    }
    locks_->take(nodes_, [self = shared_from_this(), done = std::move(done)](Answer<> outcome) {
        done(self->taken(std::move(outcome)));
    });
}

Answer<> LockUse::taken(Answer<> outcome) {
    {
        const std::lock_guard guard(mutex_);
        const bool wanted = state_ == State::asking;
        state_ = outcome && wanted ? State::taken : State::free;
        if (!outcome || wanted) {
            return outcome;
        }
    }
    locks_->giveBack(nodes_, [](const auto& /*any*/) {});
    return tl::unexpected(failureOf(Errc::cancelled, "the lock is not wanted any more"));
}

void LockUse::giveBack(const Done& done) {
    bool held = false;
    {
        const std::lock_guard guard(mutex_);
        held = state_ == State::taken;
        state_ = held ? State::free : state_ == State::asking ? State::unwanted : state_;
    }
    if (held) {
        locks_->giveBack(nodes_, done);
    } else {
        done({});
    }
}

Answer<> awaitDone(const std::function<void(DeviceLocks::Done)>& request) {
    // Shared with the answer.
    const auto promise = std::make_shared<std::promise<Answer<>>>();
    auto outcome = promise->get_future();
    request([promise](Answer<> answer) { promise->set_value(std::move(answer)); });
    return outcome.get();  // at the latest at the client's time-out
}

}  // namespace metier::client
