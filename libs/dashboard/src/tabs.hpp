#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>

#include "board.hpp"
#include "metier/client/control_handle.hpp"
#include "people.hpp"
#include "skill_session.hpp"
#include "watches.hpp"

namespace metier::dashboard {

/// Controls that only this page knows of, since their servers give no leases: they keep its other
/// tabs away, and no other client.
///
/// Threading: any.
class ControlsOfPage {
public:
    /// `board` must outlive this.
    explicit ControlsOfPage(Board& board) : board_(board) {}

    /// Nothing to do if the tab has it. Errors: locked, with the holder's name.
    Result<void> take(const LinkedController& controller, const std::string& tab,
                      const std::string& name);
    bool holds(const std::string& control) const;
    /// Gives all back. \return their keys
    std::set<std::string> release();

private:
    Board& board_;
    mutable std::mutex mutex_;
    std::set<std::string> keys_;
};

/// Means by which a tab commands: a session of its own with a server, and control of controllers.
///
/// Threading: any.
class TabSession {
public:
    TabSession(Board& board, std::string server, std::unique_ptr<opcua::Client> client,
               ForeignStore store);
    /// Halts what would go on without it, gives back what it holds, and ends the session.
    ~TabSession();
    TabSession(const TabSession&) = delete;
    TabSession& operator=(const TabSession&) = delete;

    /// Takes control of a controller for a tab; without leases, from the other tabs of this page
    /// only. Errors: locked, with the holder's name.
    Result<void> take(const LinkedController& controller, const std::string& tab,
                      const std::string& name);
    /// Epoch of the lease, for a start; 0 where there are no leases.
    /// Errors: locked, if it holds no control, or does not hold it any more.
    Result<std::uint64_t> epochOf(const std::string& control) const;
    /// Whether nothing of what it took was lost.
    bool holdsAll() const;
    SkillSession& session() noexcept { return session_; }

private:
    Board& board_;
    const std::string server_;
    // Shared with the callback for the loss of the connection.
    const std::shared_ptr<ControlsOfPage> of_page_ = std::make_shared<ControlsOfPage>(board_);
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

    /// Session of a tab of that person that has control of a server; null if there is none.
    std::shared_ptr<TabSession> sessionOf(const Person& person, const std::string& server) const;

private:
    struct Tab {
        Tab() = default;
        ~Tab();
        Tab(Tab&&) = default;
        Tab& operator=(Tab&&) = default;

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
