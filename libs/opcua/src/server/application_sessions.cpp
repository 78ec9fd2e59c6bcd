#include "server/application_sessions.hpp"

#include <algorithm>

namespace metier::opcua {

bool ApplicationSessions::create(const Application& application, SteadyTime now) {
    std::erase_if(created_, [now](const Created& session) { return session.gone <= now; });
    if (of(application.thumbprint) >= most_) {
        return false;
    }
    created_.push_back({application, now + lifetime_});
    return true;
}

void ApplicationSessions::activated(const std::string& thumbprint) {
    ++used_[thumbprint];
    const auto created =
        std::find_if(created_.begin(), created_.end(),
                     [&](const Created& session) { return session.by.thumbprint == thumbprint; });
    if (created != created_.end()) {
        created_.erase(created);
    }
}

void ApplicationSessions::closed(const std::string& thumbprint) {
    const auto used = used_.find(thumbprint);
    if (used != used_.end() && --used->second == 0) {
        used_.erase(used);
    }
}

void ApplicationSessions::abandoned(const std::string& uri) {
    const auto created =
        std::find_if(created_.begin(), created_.end(),
                     [&](const Created& session) { return session.by.uri == uri; });
    if (created != created_.end()) {
        created_.erase(created);
    }
}

std::size_t ApplicationSessions::of(const std::string& thumbprint) const {
    const auto used = used_.find(thumbprint);
    const auto created =
        std::count_if(created_.begin(), created_.end(),
                      [&](const Created& session) { return session.by.thumbprint == thumbprint; });
    return (used == used_.end() ? 0 : used->second) + static_cast<std::size_t>(created);
}

}  // namespace metier::opcua
