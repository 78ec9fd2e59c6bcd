#include "tabs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "metier/opcua/text.hpp"

namespace metier::dashboard {

using client::ControlHandle;

namespace {

/// Name of a browser tab in server sessions and refusals.
std::string nameOf(const std::string& tab, const Person& person) {
    constexpr std::size_t kShort = 4;
    return fmt::format("metier dashboard{}{}, tab {}", person.user().empty() ? "" : " of ",
                       person.user(), tab.substr(0, kShort));
}

void letGo(Board& board, const std::string& control) {
    board.changeControl(control, [](ControlState& state) {
        state.held_by.clear();
        state.owner.clear();
        state.lease_ms = 0.0;
        state.until = 0.0;
    });
}

}  // namespace

TabSession::~TabSession() {
    for (const auto& [key, handle] : std::exchange(controls_, {})) {
        letGo(board_, key);
    }
}

Result<void> TabSession::take(const LinkedController& controller, const std::string& tab,
                              const std::string& name) {
    auto handle = ControlHandle::acquire(session_.client(), controller.node, {});
    if (!handle) {
        return fail(handle.error().code,
                    opcua::sanitise(fmt::format("{}: {}", controller.key, handle.error().message)));
    }
    board_.changeControl(controller.key, [&](ControlState& state) {
        state.held_by = tab;
        state.owner = name;
    });
    handle->onLost([&board = board_, key = controller.key](const opcua::Failure& failure) {
        letGo(board, key);
        board.raise(
            {key.substr(0, key.find('/')), 600,
             opcua::sanitise(fmt::format("control of {} is lost: {}", key, failure.message)), 0.0});
    });
    const std::lock_guard lock(mutex_);
    controls_.insert_or_assign(controller.key, std::move(*handle));
    return {};
}

Result<std::uint64_t> TabSession::epochOf(const std::string& control) const {
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
    auto session = std::make_shared<TabSession>(board_, std::move(client));
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
