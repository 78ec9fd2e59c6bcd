#include "cell/cell_member.hpp"

#include <fmt/format.h>

#include <csignal>
#include <cstring>
#include <utility>

#include "metier/server/ready_line.hpp"

namespace metier::server {
namespace {

using namespace std::chrono_literals;

constexpr auto kReadyTimeout = 30s;
// Longest time from the end of a program's output to its own end.
constexpr auto kLastBreath = 2s;
constexpr int kSignalBase = 128;

std::string textOfStatus(int status) {
    if (status > kSignalBase) {
        const int number = status - kSignalBase;
        return fmt::format("was ended by signal {} ({})", number, strsignal(number));
    }
    return fmt::format("ended with status {}", status);
}

}  // namespace

CellMember::CellMember(Plan plan) : plan_(std::move(plan)) {}

Result<void> CellMember::begin(SteadyTime now) {
    begin_at_.reset();
    ready_ = false;
    begun_ = now;
    auto command = plan_.command.words;
    if (!plan_.command.option_for_port.empty() && !address_.empty()) {
        command.push_back(plan_.command.option_for_port);
        command.push_back(address_.substr(address_.rfind(':') + 1));
    }
    METIER_ASSIGN(auto process, link::ChildProcess::start(command, {.group = link::Group::own,
                                                                    .on_owners_death = SIGTERM}));
    process_.emplace(std::move(process));
    return {};
}

std::chrono::milliseconds CellMember::beginLater(SteadyTime now) {
    const auto pause = pause_.next(now - begun_);
    begin_at_ = now + pause;
    return pause;
}

CellMember::Event CellMember::look(SteadyTime now) {
    if (!process_) {
        if (!begin_at_ || now < *begin_at_) {
            return Event::none;
        }
        const auto begun = begin(now);
        return begun ? Event::none : end(begun.error().message);
    }
    if (!ready_) {
        return lookWhileStarting(now);
    }
    return process_->running() ? Event::none : endedByItself();
}

CellMember::Event CellMember::lookWhileStarting(SteadyTime now) {
    const auto line = process_->readLine(SteadyTime{});
    if (line) {
        const auto address = addressOfReadyLine(*line);
        if (!address) {
            return end(fmt::format("said: {}", *line));
        }
        address_ = *address;
        ready_ = true;
        return Event::ready;
    }
    if (line.error().code == Errc::connection_lost) {
        return endedByItself();
    }
    if (now > begun_ + kReadyTimeout) {
        return end(
            fmt::format("was not ready within {} s", std::chrono::seconds(kReadyTimeout).count()));
    }
    return Event::none;
}

CellMember::Event CellMember::endedByItself() {
    const auto status = process_->waitUntil(std::chrono::steady_clock::now() + kLastBreath);
    return end(status ? textOfStatus(*status) : "closed its output");
}

CellMember::Event CellMember::end(std::string how) {
    how_ = std::move(how);
    process_.reset();
    ready_ = false;
    return Event::ended;
}

int CellMember::outputDescriptor() const noexcept {
    return process_ && !ready_ ? process_->outputDescriptor() : -1;
}

int CellMember::endDescriptor() const noexcept {
    return process_ ? process_->endDescriptor() : -1;
}

std::optional<SteadyTime> CellMember::lookAgainAt() const noexcept {
    if (!process_) {
        return begin_at_;
    }
    return ready_ ? std::nullopt : std::optional(begun_ + kReadyTimeout);
}

void CellMember::signal(int number) noexcept {
    if (process_) {
        process_->signal(number);
    }
}

}  // namespace metier::server
