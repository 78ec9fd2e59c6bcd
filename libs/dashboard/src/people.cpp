#include "people.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <future>
#include <utility>

#include "metier/base/random.hpp"
#include "metier/opcua/text.hpp"
#include "metier/opcua_skill/namespaces.hpp"

namespace metier::dashboard {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kMostLogins = 200;
constexpr std::size_t kMostLoginsOfUser = 20;
constexpr std::size_t kMostFailures = 1'000;
constexpr std::size_t kTokenDigits = 32;  // 128 bits: it cannot be guessed
constexpr auto kLongestLogin = 12h;
constexpr auto kLongestRest = 1h;
constexpr int kFreeAttempts = 3;  // wrong passwords for one name before waiting begins
constexpr auto kLongestQueue = 20s;
constexpr auto kConnect = 5'000ms;

bool isDenial(const opcua::Failure& failure) {
    return failure.code == Errc::access_denied ||
           failure.status == opcua::status::kBadUserAccessDenied ||
           failure.status == opcua::status::kBadIdentityTokenRejected ||
           failure.status == opcua::status::kBadIdentityTokenInvalid;
}

/// Method that only those may call who may command: AcquireControl, or Start without leases.
opcua::Answer<opcua::NodeId> commandingMethod(opcua::Client& client, const ServerLink& link) {
    if (link.controllers().empty()) {
        return opcua::failed(opcua::status::kBadNoMatch, "no skill");
    }
    const auto& controller = link.controllers().front();
    if (!controller.leases) {
        return client::findMethod(client, link.skills().front().address, skill::Method::start);
    }
    METIER_ASSIGN(const auto metier, client.namespaceIndex(opcua_skill::kMetierUri));
    return client.translate(controller.node, {{metier, "AcquireControl"}});
}

/// Whether a session may command a server's skills.
bool mayCommand(opcua::Client& client, const ServerLink& link) {
    const auto method = commandingMethod(client, link);
    const auto executable =
        method ? client.readUserExecutable(*method) : opcua::Answer<bool>(false);
    return executable && *executable;
}

}  // namespace

std::string Person::role() const {
    const std::lock_guard lock(mutex_);
    return role_;
}

void Person::setRole(std::string role) {
    const std::lock_guard lock(mutex_);
    role_ = std::move(role);
}

Result<std::unique_ptr<opcua::Client>> Person::connect(const std::string& server,
                                                       const std::string& name) const {
    METIER_ASSIGN(const auto url, watches_.url(server));
    METIER_ASSIGN(auto options, connector_.options(url));
    options.application_name = name;
    options.connect_timeout = kConnect;
    if (!isOfLab() && !options.security) {
        return fail(Errc::connection_lost,
                    fmt::format("{}: without security it knows nobody's password", server));
    }
    if (!isOfLab()) {
        options.user = opcua::UserName{user_, password_};
    }
    auto client = opcua::Client::connect(url, options);
    if (!client) {
        const auto code = isDenial(client.error()) ? Errc::access_denied : client.error().code;
        return fail(code, opcua::sanitise(fmt::format("{}: {}", server, client.error().message)));
    }
    return std::move(*client);
}

Result<std::shared_ptr<SkillSession>> Person::session(const std::string& server) {
    {
        const std::lock_guard lock(mutex_);
        const auto known = sessions_.find(server);
        if (known != sessions_.end() && known->second->isConnected()) {
            return known->second;
        }
    }
    METIER_ASSIGN(auto client, connect(server, fmt::format("metier dashboard{}{}",
                                                           user_.empty() ? "" : " of ", user_)));
    auto session = std::make_shared<SkillSession>(std::move(client), ForeignStore());
    auto before = session;  // so that the former one ends after the lock is released
    const std::lock_guard lock(mutex_);
    sessions_[server].swap(before);
    return session;
}

void Person::openSessions() {
    std::vector<std::future<void>> opening;
    for (const auto& server : watches_.servers()) {
        if (watches_.link(server)) {
            opening.push_back(std::async(std::launch::async,
                                         [this, server] { static_cast<void>(session(server)); }));
        }
    }
}

People::People(const Connector& connector, Watches& watches, Access access, const Clock& clock)
    : connector_(connector),
      watches_(watches),
      access_(access),
      clock_(clock),
      anybody_(std::make_shared<Person>(connector, watches, "", "")) {
    anybody_->setRole("operator");
}

Result<void> People::beginAttempt(const std::string& user) {
    constexpr int kMostDoublings = 6;
    constexpr std::chrono::seconds kLongest{60};
    const std::lock_guard lock(mutex_);
    const auto found = failures_.find(user);
    const auto left = found == failures_.end() ? std::chrono::nanoseconds(0)
                                               : found->second.barred_until - clock_.now();
    if (left > 0ns) {
        return fail(Errc::resource_unavailable,
                    fmt::format("too many wrong passwords: wait {} s",
                                std::chrono::ceil<std::chrono::seconds>(left).count()));
    }
    if (found == failures_.end() && failures_.size() >= kMostFailures) {
        forgetLeast();
    }
    auto& failures = failures_[user];
    ++failures.count;
    if (failures.count >= kFreeAttempts) {
        const int doublings = std::min(failures.count - kFreeAttempts, kMostDoublings);
        failures.barred_until =
            clock_.now() + std::min(std::chrono::seconds(1LL << doublings), kLongest);
    }
    return {};
}

/// Forgets one name with failures; needs the lock. A name that was tried once goes before one that
/// is being guessed.
void People::forgetLeast() {
    failures_.erase(std::min_element(
        failures_.begin(), failures_.end(), [](const auto& left, const auto& right) {
            return std::pair(left.second.count, left.second.barred_until) <
                   std::pair(right.second.count, right.second.barred_until);
        }));
}

void People::takeBack(const std::string& user) {
    const std::lock_guard lock(mutex_);
    if (const auto found = failures_.find(user); found != failures_.end()) {
        --found->second.count;
        found->second.barred_until = {};  // no attempt is allowed while it is in the future
    }
}

Result<std::shared_ptr<Person>> People::ask(const std::string& user, const std::string& password) {
    auto person = std::make_shared<Person>(connector_, watches_, user, password);
    Result<void> outcome =
        fail(Errc::connection_lost, "no server is connected that could be asked");
    for (const auto& server : watches_.servers()) {
        const auto link = watches_.link(server);
        if (!link) {
            continue;
        }
        const auto session = person->session(server);
        if (session) {
            person->setRole(mayCommand((*session)->client(), *link) ? "operator" : "observer");
            person->openSessions();
            return person;
        }
        if (outcome.error().code != Errc::access_denied) {
            outcome = fail(session.error());
        }
    }
    return fail(outcome.error());
}

Result<std::string> People::login(const std::string& user, const std::string& password) {
    if (isLab()) {
        return fail(Errc::access_denied, "nobody logs in to an insecure lab");
    }
    if (user.empty() || password.empty()) {
        return fail(Errc::access_denied, "a name and a password are needed");
    }
    METIER_TRY(beginAttempt(user));
    const auto turn = queue_.await(kLongestQueue);
    if (!turn) {
        takeBack(user);
        return fail(Errc::resource_unavailable, "too many people log in at a time: wait a little");
    }
    auto person = ask(user, password);
    if (!person && person.error().code == Errc::access_denied) {
        return fail(Errc::access_denied, "wrong name or password");
    }
    takeBack(user);
    return person ? keep(std::move(*person)) : fail(person.error());
}

Result<std::string> People::keep(std::shared_ptr<Person> person) {
    auto token = randomHex(kTokenDigits);
    const auto now = clock_.now();
    std::vector<std::shared_ptr<Person>> gone;  // destroyed after the lock is
    const std::lock_guard lock(mutex_);
    gone = forgetOld(now);
    failures_.erase(person->user());
    if (auto surplus = surplusOf(person->user()); surplus != logins_.end()) {
        gone.push_back(std::move(surplus->second.person));
        logins_.erase(surplus);
    }
    if (logins_.size() >= kMostLogins) {
        return fail(Errc::resource_unavailable,
                    fmt::format("{} people are logged in, and no more can be", kMostLogins));
    }
    logins_[token] = {std::move(person), now, now};
    return token;
}

/// With the lock. The log-in of that user that was used longest ago, if there are as many as one
/// may have.
People::Logins::iterator People::surplusOf(const std::string& user) {
    auto oldest = logins_.end();
    std::size_t count = 0;
    for (auto one = logins_.begin(); one != logins_.end(); ++one) {
        if (one->second.person->user() == user) {
            ++count;
            oldest =
                oldest == logins_.end() || one->second.used < oldest->second.used ? one : oldest;
        }
    }
    return count < kMostLoginsOfUser ? logins_.end() : oldest;
}

void People::logout(const std::string& token) {
    Login gone;  // destroyed after the lock is
    const std::lock_guard lock(mutex_);
    if (const auto found = logins_.find(token); found != logins_.end()) {
        gone = std::move(found->second);
        logins_.erase(found);
    }
}

std::vector<std::shared_ptr<Person>> People::forgetOld(SteadyTime now) {
    std::vector<std::shared_ptr<Person>> gone;
    std::erase_if(logins_, [&](auto& one) {
        const bool old =
            now - one.second.begun > kLongestLogin || now - one.second.used > kLongestRest;
        if (old) {
            gone.push_back(std::move(one.second.person));
        }
        return old;
    });
    return gone;
}

std::shared_ptr<Person> People::find(const std::string& token) {
    if (isLab()) {
        return anybody_;
    }
    const auto now = clock_.now();
    std::vector<std::shared_ptr<Person>> gone;  // destroyed after the lock is
    const std::lock_guard lock(mutex_);
    gone = forgetOld(now);
    const auto found = logins_.find(token);
    if (found == logins_.end()) {
        return nullptr;
    }
    found->second.used = now;
    return found->second.person;
}

}  // namespace metier::dashboard
