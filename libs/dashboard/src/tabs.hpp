#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "board.hpp"
#include "metier/client/control_handle.hpp"
#include "people.hpp"
#include "skill_session.hpp"
#include "watches.hpp"

namespace metier::dashboard {

/// Means by which a tab commands: a session of its own with a server, and control of controllers.
///
/// Threading: any.
class TabSession {
public:
    TabSession(Board& board, std::unique_ptr<opcua::Client> client)
        : board_(board), session_(std::move(client)) {}
    /// Gives back what it holds and ends the session.
    ~TabSession();
    TabSession(const TabSession&) = delete;
    TabSession& operator=(const TabSession&) = delete;

    /// Takes control of a controller for a tab. Errors: locked, with the holder's name.
    Result<void> take(const LinkedController& controller, const std::string& tab,
                      const std::string& name);
    /// Epoch of the lease, for a start.
    /// Errors: locked, if it holds no lease, or does not hold it any more.
    Result<std::uint64_t> epochOf(const std::string& control) const;
    /// Whether nothing of what it took was lost.
    bool holdsAll() const;
    SkillSession& session() noexcept { return session_; }

private:
    Board& board_;
    SkillSession session_;  // before what uses it
    mutable std::mutex mutex_;
    std::map<std::string, client::ControlHandle> controls_;
};

/// The tabs that are open, whose they are, and what they hold.
///
/// Threading: any; take() and release() wait for servers.
class Tabs {
public:
    /// Both must outlive this.
    Tabs(Board& board, Watches& watches) : board_(board), watches_(watches) {}

    void open(const std::string& tab, const std::shared_ptr<Person>& person);
    /// Gives back all that it holds.
    void close(const std::string& tab);

    /// Whether it is open, and that person's.
    /// Errors: not_found; access_denied.
    Result<void> check(const std::string& tab, const Person& person) const;
    /// Takes control of every controller of a server, or of none.
    /// Errors: as check(); connection_lost; locked, with the holder's name.
    Result<void> take(const std::string& tab, const std::shared_ptr<Person>& person,
                      const std::string& server);
    /// Nothing happens if it holds nothing there. Errors: as check().
    Result<void> release(const std::string& tab, const Person& person, const std::string& server);
    /// Errors: as check(); locked, if it has no control there.
    Result<std::shared_ptr<TabSession>> session(const std::string& tab, const Person& person,
                                                const std::string& server) const;

private:
    struct Tab {
        std::shared_ptr<Person> person;  // shared with their log-in
        // Shared with the commands that use them at this moment.
        std::map<std::string, std::shared_ptr<TabSession>> sessions{};
    };
    Result<void> checkLocked(const std::string& tab, const Person& person) const;

    Board& board_;
    Watches& watches_;
    mutable std::mutex mutex_;
    std::map<std::string, Tab> tabs_;
};

}  // namespace metier::dashboard
