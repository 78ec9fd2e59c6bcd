#include "metier/server/cell_runner.hpp"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <limits>
#include <utility>
#include <variant>

#include "cell/cell_member.hpp"
#include "metier/base/overloaded.hpp"

namespace metier::server {
namespace {

using namespace std::chrono_literals;

// Longest time for a process to let go of those that it uses before these get their signal, too.
constexpr auto kLetGo = 500ms;
// Deadline for the servers, from the begin of the cell's end: they brake within 2 s.
constexpr auto kServersEnd = 4s;
constexpr auto kAllEnd = 6s;

constexpr std::array kEndOrder{CellRank::composition, CellRank::synchronized, CellRank::move,
                               CellRank::device,      CellRank::controller,   CellRank::world};

CellRank rankOf(const cell::ServerConfig& server) {
    return std::visit(
        overloaded{[](const cell::ArmServer&) { return CellRank::device; },
                   [](const cell::GripperServer&) { return CellRank::device; },
                   [](const cell::MoveComponent&) { return CellRank::move; },
                   [](const cell::SynchronizedServer&) { return CellRank::synchronized; },
                   [](const cell::CompositionServer&) { return CellRank::composition; }},
        server.kind);
}

/// Those that others use first; arms before grippers.
std::vector<const cell::ServerConfig*> inStartOrder(
    const std::vector<cell::ServerConfig>& servers) {
    std::vector<const cell::ServerConfig*> order;
    for (const auto& server : servers) {
        order.push_back(&server);
    }
    std::stable_sort(order.begin(), order.end(), [](const auto* one, const auto* other) {
        return std::pair(rankOf(*one), one->kind.index()) <
               std::pair(rankOf(*other), other->kind.index());
    });
    return order;
}

SteadyTime now() {
    return std::chrono::steady_clock::now();
}

int millisecondsUntil(SteadyTime time) {
    if (time == SteadyTime::max()) {
        return -1;
    }
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(time - now()).count();
    return static_cast<int>(std::clamp<std::int64_t>(left, 0, std::numeric_limits<int>::max()));
}

}  // namespace

CellRunner::CellRunner() = default;
CellRunner::CellRunner(CellRunner&&) noexcept = default;

Result<CellRunner> CellRunner::start(const cell::CellConfig& cell, const CellCommands& commands,
                                     int stop_descriptor, const OnReady& on_ready) {
    CellRunner runner;
    METIER_TRY(runner.startAll(cell, commands, stop_descriptor, on_ready));
    return runner;
}

Result<void> CellRunner::startAll(const cell::CellConfig& cell, const CellCommands& commands,
                                  int stop_descriptor, const OnReady& on_ready) {
    for (const bool world : {true, false}) {
        for (const auto& controller : cell.virtual_controllers) {
            if ((&controller == cell.world()) != world) {
                continue;
            }
            CellMember::Plan plan{controller.name, world ? CellRank::world : CellRank::controller,
                                  commands.of(controller, known_)};
            METIER_TRY(startMember(std::make_unique<CellMember>(std::move(plan)), stop_descriptor));
            known_.controllers[controller.name] = members_.back()->address();
        }
    }
    for (const auto* server : inStartOrder(cell.servers)) {
        CellMember::Plan plan{server->name, rankOf(*server), commands.of(*server, known_)};
        METIER_TRY(startMember(std::make_unique<CellMember>(std::move(plan)), stop_descriptor));
        const auto& url = members_.back()->address();
        known_.servers[server->name] = url;
        running_.push_back({server->name, url});
        on_ready(running_.back());
    }
    return {};
}

Result<void> CellRunner::startMember(std::unique_ptr<CellMember> new_member, int stop_descriptor) {
    auto& member = *members_.emplace_back(std::move(new_member));
    METIER_TRY(member.begin(now()));
    for (;;) {
        switch (member.look(now())) {
            case CellMember::Event::ready:
                return {};
            case CellMember::Event::ended:
                return fail(Errc::connection_lost, fmt::format("'{}' did not become ready: it {}",
                                                               member.name(), member.howItEnded()));
            case CellMember::Event::none:
                break;
        }
        if (await(stop_descriptor, SteadyTime::max())) {
            return fail(Errc::cancelled, fmt::format("stopped before the cell was up: '{}' was not "
                                                     "ready yet",
                                                     member.name()));
        }
    }
}

bool CellRunner::await(int wake_descriptor, SteadyTime deadline) const {
    std::vector<pollfd> requests{{wake_descriptor, POLLIN, 0}};
    for (const auto& member : members_) {
        requests.push_back({member->outputDescriptor(), POLLIN, 0});
        requests.push_back({member->endDescriptor(), POLLIN, 0});
        if (const auto again = member->lookAgainAt()) {
            deadline = std::min(deadline, *again + 1ms);
        }
    }
    const int ready = poll(requests.data(), requests.size(), millisecondsUntil(deadline));
    return ready > 0 && requests.front().revents != 0;
}

std::optional<CellRunner::Ended> CellRunner::lookAfter(int wake_descriptor, OnFailure on_failure,
                                                       const OnChange& on_change) {
    do {
        if (auto ended = lookAtAll(on_failure, on_change)) {
            return ended;
        }
    } while (!await(wake_descriptor, SteadyTime::max()));
    return std::nullopt;
}

std::optional<CellRunner::Ended> CellRunner::lookAtAll(OnFailure on_failure,
                                                       const OnChange& on_change) {
    for (auto& member : members_) {
        const auto event = member->look(now());
        if (event == CellMember::Event::ready) {
            on_change(fmt::format("'{}' is back at {}", member->name(), member->address()));
        } else if (event == CellMember::Event::ended && on_failure == OnFailure::end_cell) {
            return Ended{member->name(), member->howItEnded()};
        } else if (event == CellMember::Event::ended) {
            const std::chrono::duration<double> pause = member->beginLater(now());
            on_change(fmt::format("'{}' {}; it is started again in {} s", member->name(),
                                  member->howItEnded(), pause.count()));
        }
    }
    return std::nullopt;
}

void CellRunner::awaitEnds(CellRank least, SteadyTime deadline) {
    const auto any_left = [&] {
        return std::any_of(members_.begin(), members_.end(), [&](const auto& member) {
            return member->rank() >= least && member->hasProcess();
        });
    };
    while (any_left() && now() < deadline) {
        await(-1, deadline);
        for (auto& member : members_) {
            member->look(now());
        }
    }
}

CellRunner::~CellRunner() {
    const auto begun = now();
    for (auto& member : members_) {
        member->stayDown();
    }
    for (const auto rank : kEndOrder) {
        if (rank == CellRank::controller) {
            awaitEnds(CellRank::device, begun + kServersEnd);
        }
        for (auto& member : members_) {
            if (member->rank() == rank) {
                member->signal(SIGTERM);
            }
        }
        const bool uses_others = rank > CellRank::device;
        awaitEnds(rank, std::min(now() + (uses_others ? kLetGo : kServersEnd), begun + kAllEnd));
    }
    for (auto& member : members_) {
        member->signal(SIGKILL);
    }
}

}  // namespace metier::server
