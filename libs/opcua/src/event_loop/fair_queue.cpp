#include "fair_queue.hpp"

#include <algorithm>

namespace metier::opcua {

namespace {

constexpr int kTurnsToWait = 200;                 // for each turn of its own
constexpr std::chrono::milliseconds kUnknown{1};  // cost of a turn of a new one
constexpr int kRemembered = 8;                    // turns, about

}  // namespace

void FairQueue::ready(ConnectionId connection, Standing standing, SteadyTime now) {
    auto& account = accounts_.try_emplace(connection, Account{.turn = kUnknown}).first->second;
    if (account.place) {
        return;
    }
    account.line = standing == Standing::stranger ? 0 : 1;
    auto& line = lines_.at(account.line);
    if (line.waiting.empty()) {
        line.used = std::max(line.used, clock_);
    }
    account.place = Place{now + kTurnsToWait * account.turn, ++count_, connection};
    line.waiting.insert(*account.place);
}

std::optional<ConnectionId> FairQueue::next() {
    if (empty()) {
        return std::nullopt;
    }
    const bool second = lines_[0].waiting.empty() ||
                        (!lines_[1].waiting.empty() && lines_[1].used <= lines_[0].used);
    served_line_ = second ? 1 : 0;
    auto& line = lines_.at(served_line_);
    const auto place = *line.waiting.begin();
    line.waiting.erase(line.waiting.begin());
    clock_ = line.used;
    served_ = place.connection;
    accounts_.at(served_).place.reset();
    return served_;
}

void FairQueue::used(Cost cost) {
    lines_.at(served_line_).used += cost;
    const auto account = accounts_.find(served_);
    if (account != accounts_.end()) {
        auto& turn = account->second.turn;
        turn = (turn * (kRemembered - 1) + cost) / kRemembered;
    }
}

void FairQueue::forget(ConnectionId connection) {
    const auto account = accounts_.find(connection);
    if (account == accounts_.end()) {
        return;
    }
    if (const auto& place = account->second.place) {
        lines_.at(account->second.line).waiting.erase(*place);
    }
    accounts_.erase(account);
}

}  // namespace metier::opcua
