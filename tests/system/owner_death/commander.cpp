// A client that takes control of a skill, brings it into a state and then does as signals say:
//   metier_commander URL SKILL LEASE_MS ON_LOSS STATE DELAY_MS NAME=VALUE,VALUE,...
// Prints, each with the time [us since 1970]: "beat" when a heartbeat was sent that the server
// answered, "there" when the state is reached DELAY_MS after its start, "refused" or "accepted" for
// each command that it tries as a stale commander.
#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <stdexcept>
#include <thread>

#include "commander.hpp"
#include "metier/client/skill_handle.hpp"

namespace metier::system_tests {
namespace {

using namespace std::chrono_literals;
using client::SkillHandle;
using opcua::NodeId;
using opcua::Value;

constexpr int kBeatsPerLease = 4;

template <typename Answer>
auto orThrow(Answer answer) {
    if (!answer) {
        throw std::runtime_error(answer.error().message);
    }
    return std::move(*answer);
}

std::int64_t microseconds(UtcTime time) {
    return std::chrono::duration_cast<std::chrono::microseconds>(time.time_since_epoch()).count();
}

/// In one write, so that a kill leaves no half line behind.
void tell(const std::string& what, UtcTime time = std::chrono::system_clock::now()) {
    const auto line = fmt::format("{} {}\n", microseconds(time), what);
    if (::write(STDOUT_FILENO, line.data(), line.size()) < 0) {
        std::_Exit(EXIT_FAILURE);  // nobody reads the output any more
    }
}

/// The lease by hand: its heartbeats can stop while the client lives.
class Lease {
public:
    Lease(opcua::Client& client, const NodeId& controller, std::chrono::milliseconds lease,
          std::int32_t on_loss)
        : client_(client), controller_(controller), interval_(lease / kBeatsPerLease) {
        const auto index = orThrow(client.namespaceIndex("urn:metier:skills"));
        const auto acquire = orThrow(client.translate(controller, {{index, "AcquireControl"}}));
        heartbeat_ = orThrow(client.translate(controller, {{index, "Heartbeat"}}));
        const auto taken = orThrow(client.call(
            controller, acquire,
            {Value::of(static_cast<std::uint32_t>(lease.count())), Value::of(on_loss)}));
        tell("beat");
        epoch_ = taken.outputs.front().as<std::uint64_t>().value();
        thread_ = std::jthread([this](const std::stop_token& stop) { beat(stop); });
    }

    std::uint64_t epoch() const { return epoch_; }
    void fallSilent() { silent_ = true; }
    opcua::Answer<opcua::CallResult> beatOnce() {
        return client_.call(controller_, heartbeat_, {Value::of(epoch_)});
    }

private:
    void beat(const std::stop_token& stop) {
        for (auto next = std::chrono::steady_clock::now(); !stop.stop_requested();
             next += interval_) {
            std::this_thread::sleep_until(next);
            if (silent_) {
                return;
            }
            const auto sent = std::chrono::system_clock::now();
            const auto called = client_.callAsync({controller_, heartbeat_, {Value::of(epoch_)}},
                                                  [sent](const auto& answer) {
                                                      if (answer) {
                                                          tell("beat", sent);
                                                      }
                                                  });
            if (!called) {
                return;
            }
        }
    }

    opcua::Client& client_;
    const NodeId controller_;
    const std::chrono::milliseconds interval_;
    NodeId heartbeat_;
    std::uint64_t epoch_ = 0;
    std::atomic<bool> silent_ = false;
    std::jthread thread_;
};

/// Waits for one of the blocked signals; 0 at the deadline.
int awaitSignal(const sigset_t& signals, std::chrono::nanoseconds time) {
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(time);
    const timespec limit{seconds.count(), (time - seconds).count()};
    const int signal = ::sigtimedwait(&signals, nullptr, &limit);
    return signal < 0 ? 0 : signal;  // 0 also when it was stopped and continued
}

/// Commands of a commander that does not know yet that it has lost control.
class Commander {
public:
    Commander(opcua::Client& client, const CommanderOrder& order)
        : client_(client),
          order_(order),
          skill_(
              orThrow(SkillHandle::open(client, orThrow(client::findSkill(client, order.skill))))),
          lease_(client, skill_.address().controller()->node, order.lease,
                 static_cast<std::int32_t>(order.on_loss)) {}

    void reach(const sigset_t& signals) {
        if (order_.at == AtFault::ready) {
            tell("there");
            return;
        }
        orThrow(skill_.startWith(request()));
        awaitSignal(signals, order_.delay);
        if (order_.at == AtFault::suspended || order_.at == AtFault::suspending) {
            static_cast<void>(orThrow(skill_.suspend().map([] { return 0; })));
        }
        if (order_.at == AtFault::halting) {
            static_cast<void>(orThrow(skill_.halt().map([] { return 0; })));
        }
        if (order_.at == AtFault::suspended) {
            const auto soon = std::chrono::steady_clock::now() + 10s;
            orThrow(skill_.awaitState(skill::State::suspended, soon).map([] { return 0; }));
        }
        tell("there");
    }

    void obey(const sigset_t& signals) {
        for (;;) {
            switch (awaitSignal(signals, 1h)) {
                case kFallSilent:
                    lease_.fallSilent();
                    break;
                case kCloseSession:
                    static_cast<void>(client_.close());
                    break;
                case kCommandAgain:
                    commandAgain();
                    break;
                case SIGTERM:
                    return;
                default:
                    break;
            }
        }
    }

private:
    skill::StartRequest request() const {
        return {.parameters = order_.parameters, .epoch = lease_.epoch()};
    }
    template <typename Answer>
    static void report(const char* what, const Answer& answer) {
        tell(fmt::format("{} {} {}", answer ? "accepted" : "refused", what,
                         answer ? "" : answer.error().message));
    }
    void commandAgain() {
        report("Heartbeat", lease_.beatOnce());
        report("StartWith", skill_.startWith(request()));
        auto without_epoch = request();
        without_epoch.epoch = 0;
        report("StartWith without epoch", skill_.startWith(without_epoch));
        report("Resume", skill_.resume());
        for (const auto& [name, value] : order_.parameters) {
            report("write", skill_.set(name, value));
        }
        report("Start", skill_.start());
        report("Reset", skill_.reset());
        report("Suspend", skill_.suspend());
        tell("tried");
    }

    opcua::Client& client_;
    const CommanderOrder& order_;
    SkillHandle skill_;
    Lease lease_;
};

int command(const CommanderOrder& order) {
    sigset_t signals;
    ::sigemptyset(&signals);
    for (const int signal : {kFallSilent, kCloseSession, kCommandAgain, SIGTERM}) {
        ::sigaddset(&signals, signal);
    }
    ::sigprocmask(SIG_BLOCK, &signals, nullptr);  // before the first thread
    const auto client = orThrow(opcua::Client::connect(order.url));
    Commander commander(*client, order);
    commander.reach(signals);
    commander.obey(signals);
    return EXIT_SUCCESS;
}

}  // namespace
}  // namespace metier::system_tests

int main(int argc, char** argv) {
    try {
        return metier::system_tests::command(
            metier::system_tests::orderFrom({argv + 1, argv + argc}));
    } catch (const std::exception& error) {
        fmt::print(stderr, "commander: {}\n", error.what());
        return EXIT_FAILURE;
    }
}
