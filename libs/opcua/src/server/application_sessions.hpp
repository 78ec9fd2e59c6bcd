#pragma once

#include <cstddef>
#include <string>
#include <unordered_map>
#include <vector>

#include "metier/base/clock.hpp"

namespace metier::opcua {

/// Number of Sessions of each application, known by its certificate: activated ones, and ones that
/// were created and not activated yet.
///
/// The stack reports the id of a Session only when it is activated or ends. So one that was only
/// created is counted by its creator, for no longer than it can live.
/// Threading: one thread.
class ApplicationSessions {
public:
    /// \param most of one application
    /// \param lifetime that the stack leaves to a Session which is not activated
    ApplicationSessions(std::size_t most, std::chrono::milliseconds lifetime)
        : most_(most), lifetime_(lifetime) {}

    struct Application {
        std::string thumbprint;  ///< of its certificate
        std::string uri;
    };

    /// A Session is about to be created. \return false if the application has all it may have
    bool create(const Application& application, SteadyTime now);
    /// A Session is used for the first time.
    void activated(const std::string& thumbprint);
    /// A Session that had been activated has ended.
    void closed(const std::string& thumbprint);
    /// A Session that was never activated has ended.
    void abandoned(const std::string& uri);

    std::size_t of(const std::string& thumbprint) const;

private:
    struct Created {
        Application by;
        SteadyTime gone;  ///< latest end
    };

    std::size_t most_;
    std::chrono::milliseconds lifetime_;
    std::unordered_map<std::string, std::size_t> used_;
    std::vector<Created> created_;  // oldest first
};

}  // namespace metier::opcua
