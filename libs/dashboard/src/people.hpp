#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "login_queue.hpp"
#include "metier/base/clock.hpp"
#include "metier/dashboard/connector.hpp"
#include "metier/opcua/client.hpp"
#include "skill_session.hpp"
#include "watches.hpp"

namespace metier::dashboard {

/// Whether people are to log in. The same as long as a page is served, whatever servers answer.
enum class Access {
    log_in,
    lab,  ///< without login: everybody on this machine may command
};

/// A person who has logged in; in a lab, everybody who reaches the page.
///
/// Threading: any.
class Person {
public:
    /// \param password empty for the one of the lab, who has sessions without a user
    Person(const Connector& connector, Watches& watches, std::string user, std::string password)
        : connector_(connector),
          watches_(watches),
          user_(std::move(user)),
          password_(std::move(password)) {}

    const std::string& user() const noexcept { return user_; }
    bool isOfLab() const noexcept { return user_.empty(); }
    /// "operator": may command; "observer": may look.
    std::string role() const;
    void setRole(std::string role);

    /// A new session of this person with a server.
    /// \param name as which it is known there
    /// Errors: not_found; those of Client::connect(), with advice.
    Result<std::unique_ptr<opcua::Client>> connect(const std::string& server,
                                                   const std::string& name) const;
    /// A session of this person to Check and Halt by; kept until it is lost.
    /// Errors: as connect().
    Result<std::shared_ptr<SkillSession>> session(const std::string& server);
    /// Records of what is started at servers that record nothing; null: none.
    const std::shared_ptr<server::ForeignRecords>& foreignRecords() const noexcept {
        return connector_.foreign_records;
    }
    /// Opens a session with every connected server, so that no later request waits for it.
    void openSessions();

private:
    const Connector& connector_;
    Watches& watches_;
    const std::string user_;
    const std::string password_;
    mutable std::mutex mutex_;
    std::string role_ = "observer";
    // Shared with the requests that use them at this moment.
    std::map<std::string, std::shared_ptr<SkillSession>> sessions_;
};

/// The people who are logged in.
///
/// A name and password are accepted if a server accepts them. After a wrong one, the next attempt
/// for that name must wait, from one second up to a minute, and no server is asked meanwhile: so a
/// person who guesses passwords here does not lock this program out of the servers. Other names are
/// not delayed, from any address; four attempts are made at a time, and others wait for their turn.
/// Threading: any.
class People {
public:
    /// All arguments must outlive this.
    People(const Connector& connector, Watches& watches, Access access, const Clock& clock);

    bool isLab() const noexcept { return access_ == Access::lab; }
    /// \return a token that stands for the person until logout(), twelve hours, or an hour without
    ///         a request
    /// Errors: access_denied, also in a lab; resource_unavailable, how long to wait;
    ///         connection_lost, no server could be asked.
    Result<std::string> login(const std::string& user, const std::string& password);
    void logout(const std::string& token);
    /// Person to whom the token belongs; counts as a request of that person. nullptr: unknown
    /// token. In a lab no token is needed.
    std::shared_ptr<Person> find(const std::string& token);

private:
    struct Login {
        std::shared_ptr<Person> person;  // shared with their tabs
        SteadyTime begun{};
        SteadyTime used{};
    };
    static constexpr std::size_t kMostAsking = 4;
    using Logins = std::map<std::string, Login>;
    struct Failures {
        int count = 0;
        SteadyTime barred_until{};
    };

    /// Counts an attempt as wrong before it is made: many at a time are not free.
    Result<void> beginAttempt(const std::string& user);
    /// It was not wrong.
    void takeBack(const std::string& user);
    void forgetLeast();
    Logins::iterator surplusOf(const std::string& user);
    Result<std::string> keep(std::shared_ptr<Person> person);
    Result<std::shared_ptr<Person>> ask(const std::string& user, const std::string& password);
    /// \return who was forgotten, to be destroyed without the lock: that waits for servers
    std::vector<std::shared_ptr<Person>> forgetOld(SteadyTime now);

    const Connector& connector_;
    Watches& watches_;
    const Access access_;
    const Clock& clock_;
    const std::shared_ptr<Person> anybody_;  // for a lab
    std::mutex mutex_;
    Logins logins_;
    std::map<std::string, Failures> failures_;  // by user name
    LoginQueue queue_{kMostAsking};
};

}  // namespace metier::dashboard
