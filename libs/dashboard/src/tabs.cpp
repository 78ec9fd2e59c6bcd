#include "tabs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <future>
#include <optional>
#include <utility>
#include <vector>

#include "metier/opcua/text.hpp"

namespace metier::dashboard {

using client::ControlHandle;

namespace {

constexpr int kSevere = 800;

/// Name of a browser tab in server sessions and refusals.
std::string nameOf(const std::string& tab, const Person& person) {
    constexpr std::size_t kShort = 4;
    return fmt::format("metier dashboard{}{}, tab {}", person.user().empty() ? "" : " of ",
                       person.user(), tab.substr(0, kShort));
}

void letGo(Board& board, const std::string& control) {
    board.changeControl(control, [](ControlState& state) {
        state.held_by.clear();
        state.held_as.clear();
        state.owner.clear();
        state.lease_ms = 0.0;
        state.until = 0.0;
    });
}

void raiseLoss(Board& board, const std::string& server, const std::string& control,
               const opcua::Failure& failure) {
    constexpr int kSeverity = 600;
    board.raise(
        {server, kSeverity,
         opcua::sanitise(fmt::format("control of {} is lost: {}", control, failure.message)), 0.0});
}

}  // namespace

Result<void> ControlsOfPage::take(const LinkedController& controller, const std::string& tab,
                                  const std::string& name) {
    std::optional<std::string> holder;
    board_.changeControl(controller.key, [&](ControlState& state) {
        if (!state.held_by.empty() && !(state.held_by == tab && holds(controller.key))) {
            holder = state.held_as;
            return;
        }
        state.held_by = tab;
        state.held_as = name;
        state.owner = name;
    });
    if (holder) {
        return fail(Errc::locked, opcua::sanitise(fmt::format("{}: \"{}\" has control",
                                                              controller.key, *holder)));
    }
    const std::lock_guard lock(mutex_);
    keys_.insert(controller.key);
    return {};
}

bool ControlsOfPage::holds(const std::string& control) const {
    const std::lock_guard lock(mutex_);
    return keys_.contains(control);
}

std::set<std::string> ControlsOfPage::release() {
    auto keys = [this] {
        const std::lock_guard lock(mutex_);
        return std::exchange(keys_, {});
    }();
    for (const auto& key : keys) {
        letGo(board_, key);
    }
    return keys;
}

TabSession::TabSession(Board& board, std::string server, std::unique_ptr<opcua::Client> client,
                       ForeignStore store)
    : board_(board), server_(std::move(server)), session_(std::move(client), std::move(store)) {
    session_.client().onConnectionLost(
        [&board, server = server_, held = of_page_](const opcua::Failure& failure) {
            for (const auto& key : held->release()) {
                raiseLoss(board, server, key, failure);
            }
        });
}

TabSession::~TabSession() {
    for (const auto& why : session_.haltStarted()) {
        board_.raise({server_, kSevere, opcua::sanitise("not halted with its tab: " + why), 0.0});
    }
    of_page_->release();
    for (const auto& [key, handle] : std::exchange(controls_, {})) {
        letGo(board_, key);
    }
}

Result<void> TabSession::take(const LinkedController& controller, const std::string& tab,
                              const std::string& name) {
    if (!controller.leases) {
        METIER_TRY(of_page_->take(controller, tab, name));
        if (!session_.isConnected()) {  // lost before it could be given back
            of_page_->release();
            return fail(Errc::connection_lost, fmt::format("{} is not connected", server_));
        }
        return {};
    }
    auto handle = ControlHandle::acquire(session_.client(), controller.node, {});
    if (!handle) {
        return fail(handle.error().code,
                    opcua::sanitise(fmt::format("{}: {}", controller.key, handle.error().message)));
    }
    board_.changeControl(controller.key, [&](ControlState& state) {
        state.held_by = tab;
        state.owner = name;
    });
    handle->onLost(
        [&board = board_, server = server_, key = controller.key](const opcua::Failure& failure) {
            letGo(board, key);
            raiseLoss(board, server, key, failure);
        });
    const std::lock_guard lock(mutex_);
    controls_.insert_or_assign(controller.key, std::move(*handle));
    return {};
}

Result<std::uint64_t> TabSession::epochOf(const std::string& control) const {
    if (of_page_->holds(control)) {
        return 0;
    }
    const std::lock_guard lock(mutex_);
    const auto found = controls_.find(control);
    if (found == controls_.end() || !found->second.held()) {
        return fail(Errc::locked, fmt::format("this tab has no control of {}", control));
    }
    return found->second.epoch();
}

bool TabSession::holdsAll() const {
    const std::lock_guard lock(mutex_);
    return std::all_of(controls_.begin(), controls_.end(),
                       [](const auto& one) { return one.second.held(); });
}

void Tabs::open(const std::string& tab, const std::shared_ptr<Person>& person) {
    const std::lock_guard lock(mutex_);
    tabs_[tab].person = person;
}

void Tabs::close(const std::string& tab) {
    Tab gone;  // destroyed after the lock is: that waits for servers
    const std::lock_guard lock(mutex_);
    if (const auto found = tabs_.find(tab); found != tabs_.end()) {
        gone = std::move(found->second);
        tabs_.erase(found);
    }
}

Tabs::Tab::~Tab() {
    // None waits for the server of another one.
    std::vector<std::future<void>> ending;
    for (auto& [server, session] : sessions) {
        ending.push_back(std::async(std::launch::async, [&session = session] { session.reset(); }));
    }
}

std::shared_ptr<TabSession> Tabs::sessionOf(const Person& person, const std::string& server) const {
    const std::lock_guard lock(mutex_);
    for (const auto& [id, tab] : tabs_) {
        const auto found = tab.sessions.find(server);
        if (tab.person.get() == &person && found != tab.sessions.end() &&
            found->second->session().isConnected()) {
            return found->second;
        }
    }
    return nullptr;
}

Result<void> Tabs::checkLocked(const std::string& tab, const Person& person) const {
    const auto found = tabs_.find(tab);
    if (found == tabs_.end()) {
        return fail(Errc::not_found, "no such tab: its stream has ended");
    }
    if (found->second.person.get() != &person) {
        return fail(Errc::access_denied, "the tab is somebody else's");
    }
    return {};
}

Result<void> Tabs::check(const std::string& tab, const Person& person) const {
    const std::lock_guard lock(mutex_);
    return checkLocked(tab, person);
}

Result<void> Tabs::take(const std::string& tab, const std::shared_ptr<Person>& person,
                        const std::string& server) {
    METIER_TRY(check(tab, *person));
    const auto link = watches_.link(server);
    if (!link) {
        const auto known = watches_.url(server);
        return known ? fail(Errc::connection_lost, fmt::format("{} is not connected", server))
                     : fail(known.error());
    }
    if (const auto held = session(tab, *person, server); held && (*held)->holdsAll()) {
        return {};
    }
    METIER_TRY(release(tab, *person, server));
    const auto name = nameOf(tab, *person);
    METIER_ASSIGN(auto client, person->connect(server, name));
    METIER_ASSIGN(auto url, watches_.url(server));
    auto session = std::make_shared<TabSession>(
        board_, server, std::move(client), ForeignStore{person->foreignRecords(), std::move(url)});
    for (const auto& controller : link->controllers()) {
        METIER_TRY(session->take(controller, tab, name));
    }
    const std::lock_guard lock(mutex_);
    if (auto good = checkLocked(tab, *person); !good) {
        return good;  // closed meanwhile: what was taken is given back
    }
    tabs_.at(tab).sessions[server].swap(session);
    return {};
}

Result<void> Tabs::release(const std::string& tab, const Person& person,
                           const std::string& server) {
    std::shared_ptr<TabSession> gone;  // destroyed after the lock is
    const std::lock_guard lock(mutex_);
    METIER_TRY(checkLocked(tab, person));
    auto& sessions = tabs_.at(tab).sessions;
    if (const auto found = sessions.find(server); found != sessions.end()) {
        gone = std::move(found->second);
        sessions.erase(found);
    }
    return {};
}

Result<std::shared_ptr<TabSession>> Tabs::session(const std::string& tab, const Person& person,
                                                  const std::string& server) const {
    const std::lock_guard lock(mutex_);
    METIER_TRY(checkLocked(tab, person));
    const auto& sessions = tabs_.at(tab).sessions;
    const auto found = sessions.find(server);
    return found == sessions.end() || !found->second->session().isConnected()
               ? fail(Errc::locked, fmt::format("take control of {} first", server))
               : Result<std::shared_ptr<TabSession>>(found->second);
}

}  // namespace metier::dashboard
