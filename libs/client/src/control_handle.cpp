#include "metier/client/control_handle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>
#include <utility>

#include "metier/opcua/text.hpp"
#include "metier/opcua_skill/namespaces.hpp"
#include "metier/skill/control.hpp"
#include "questions.hpp"

namespace metier::client {

using opcua::Answer;
using opcua::Failure;
using opcua::NodeId;
using opcua::Value;

namespace {

constexpr int kBeatsPerLease = 4;

struct LeaseNodes {
    NodeId controller;
    NodeId acquire;
    NodeId heartbeat;
    NodeId release;
    NodeId owner;
};

Answer<LeaseNodes> findLease(opcua::Client& client, const NodeId& controller) {
    METIER_ASSIGN(const auto index, client.namespaceIndex(opcua_skill::kMetierUri));
    LeaseNodes nodes{controller, {}, {}, {}, {}};
    const std::array<std::pair<const char*, NodeId*>, 4> wanted{{{"AcquireControl", &nodes.acquire},
                                                                 {"Heartbeat", &nodes.heartbeat},
                                                                 {"ReleaseControl", &nodes.release},
                                                                 {"ControlOwner", &nodes.owner}}};
    for (const auto& [name, node] : wanted) {
        METIER_ASSIGN(auto found, client.translate(controller, {{index, name}}));
        *node = std::move(found);
    }
    return nodes;
}

Failure refused(opcua::Client& client, const LeaseNodes& nodes, Failure failure) {
    if (failure.code == Errc::locked) {
        const auto owner = client.read(nodes.owner);
        const auto name = opcua::sanitise(owner ? owner->as<std::string>().value_or("") : "");
        failure.message += name.empty() ? "" : fmt::format(": \"{}\" has control", name);
    }
    return failure;
}

}  // namespace

/// Sends heartbeats until control is lost or ended.
///
/// No heartbeat waits for the answer to another one: while TCP repeats a lost packet, the next
/// heartbeats are under way already, and their acknowledgements reveal the loss to TCP at once.
class ControlHandle::Heart {
public:
    Heart(opcua::Client& client, LeaseNodes nodes, std::uint64_t epoch,
          const ControlOptions& options)
        : client_(client),
          nodes_(std::move(nodes)),
          epoch_(epoch),
          lease_(options.lease),
          answers_(std::make_shared<Answers>()),
          thread_([this](const std::stop_token& stop) { beat(stop); }) {}

    ~Heart() {
        thread_.request_stop();
        thread_ = {};
        if (held()) {
            // The server ends the lease by itself if this does not reach it.
            static_cast<void>(client_.call(nodes_.controller, nodes_.release, {Value::of(epoch_)}));
        }
    }
    Heart(const Heart&) = delete;
    Heart& operator=(const Heart&) = delete;

    std::uint64_t epoch() const noexcept { return epoch_; }
    bool held() const { return !answers_->refusal(); }
    void onLost(std::function<void(const Failure&)> callback) {
        {
            const std::lock_guard lock(mutex_);
            if (!reported_) {
                on_lost_ = std::move(callback);
                return;
            }
        }
        if (callback) {
            callback(*reported_);  // written once
        }
    }

private:
    /// Answers of the server to the heartbeats; they may come after the end of the Heart.
    class Answers {
    public:
        void take(const Answer<opcua::CallResult>& answer) {
            const std::lock_guard lock(mutex_);
            unanswered_ = !answer && answer.error().code == Errc::timeout ? unanswered_ + 1 : 0;
            if (answer || unanswered_ == 1) {
                return;
            }
            if (!refusal_) {
                refusal_ = answer.error();
                refused_.notify_all();
            }
        }
        std::optional<Failure> refusal() const {
            const std::lock_guard lock(mutex_);
            return refusal_;
        }
        /// Waits for a refusal, the deadline or the end.
        void wait(const std::stop_token& stop, SteadyTime deadline) {
            std::unique_lock lock(mutex_);
            refused_.wait_until(lock, stop, deadline, [this] { return refusal_.has_value(); });
        }

    private:
        mutable std::mutex mutex_;
        std::condition_variable_any refused_;
        int unanswered_ = 0;  // number in succession; each waited for a whole lease
        std::optional<Failure> refusal_;
    };

    void beat(const std::stop_token& stop) {
        auto next = std::chrono::steady_clock::now();
        while (!stop.stop_requested()) {
            if (const auto refusal = answers_->refusal()) {
                tell(*refusal);
                return;
            }
            if (const auto now = std::chrono::steady_clock::now(); now >= next) {
                send();
                next = std::max(next + lease_ / kBeatsPerLease, now);
            }
            answers_->wait(stop, next);
        }
    }
    void send() {
        const auto sent = client_.callAsync(
            {nodes_.controller, nodes_.heartbeat, {Value::of(epoch_)}},
            [answers = answers_](const Answer<opcua::CallResult>& answer) {
                answers->take(answer);
            },
            lease_);
        if (!sent) {
            answers_->take(tl::unexpected(sent.error()));
        }
    }
    void tell(const Failure& failure) {
        std::function<void(const Failure&)> callback;
        {
            const std::lock_guard lock(mutex_);
            reported_ = failure;
            callback = std::exchange(on_lost_, nullptr);
        }
        if (callback) {
            callback(failure);
        }
    }

    opcua::Client& client_;
    const LeaseNodes nodes_;
    const std::uint64_t epoch_;
    const std::chrono::milliseconds lease_;
    const std::shared_ptr<Answers> answers_;  // shared with the calls that have no answer yet
    mutable std::mutex mutex_;
    std::optional<Failure> reported_;
    std::function<void(const Failure&)> on_lost_;
    std::jthread thread_;  // last: it uses everything above
};

Answer<ControlHandle> ControlHandle::acquire(opcua::Client& client, const NodeId& controller,
                                             const ControlOptions& options) {
    if (options.lease < skill::Control::kShortestLease ||
        options.lease > skill::Control::kLongestLease) {
        return tl::unexpected(
            failureOf(Errc::out_of_range,
                      fmt::format("a lease of {} ms is not within {} to {} ms",
                                  options.lease.count(), skill::Control::kShortestLease.count(),
                                  skill::Control::kLongestLease.count()),
                      opcua::status::kBadOutOfRange));
    }
    METIER_ASSIGN(auto nodes, findLease(client, controller));
    const auto taken = client.call(controller, nodes.acquire,
                                   {Value::of(static_cast<std::uint32_t>(options.lease.count())),
                                    Value::of(static_cast<std::int32_t>(options.on_loss))});
    if (!taken) {
        return tl::unexpected(refused(client, nodes, taken.error()));
    }
    const auto epoch = taken->outputs.empty() ? Result<std::uint64_t>(0)
                                              : taken->outputs.front().as<std::uint64_t>();
    if (!epoch || *epoch == 0) {
        return opcua::failed(opcua::status::kBadUnexpectedError, "AcquireControl gave no epoch");
    }
    return ControlHandle(std::make_unique<Heart>(client, std::move(nodes), *epoch, options));
}

ControlHandle::ControlHandle(std::unique_ptr<Heart> heart) : heart_(std::move(heart)) {}
ControlHandle::ControlHandle(ControlHandle&&) noexcept = default;
ControlHandle& ControlHandle::operator=(ControlHandle&&) noexcept = default;
ControlHandle::~ControlHandle() = default;

std::uint64_t ControlHandle::epoch() const noexcept {
    return heart_->epoch();
}

bool ControlHandle::held() const noexcept {
    return heart_->held();
}

void ControlHandle::onLost(std::function<void(const Failure&)> callback) {
    heart_->onLost(std::move(callback));
}

}  // namespace metier::client
