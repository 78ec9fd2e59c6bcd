#pragma once

#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/base/queue.hpp"
#include "metier/link/child_process.hpp"

namespace metier::system_tests {

/// A process of `metier` whose log is read for losses of control.
///
/// Threading: a thread of its own reads the output.
class OwnedServer {
public:
    /// \param arguments of `metier`, such as serve CELL --server NAME
    /// Errors: throws unless it is ready within a minute.
    explicit OwnedServer(const std::vector<std::string>& arguments);

    const std::string& url() const noexcept { return url_; }
    /// Time at which the server commanded the stop, by its own clock, rounded down to the
    /// millisecond; nothing at the deadline. Losses before forgetLosses() are left out.
    std::optional<UtcTime> awaitLoss(SteadyTime deadline) { return losses_.popUntil(deadline); }
    void forgetLosses();

private:
    void read(const std::stop_token& stop);

    link::ChildProcess process_;
    std::string url_;
    Queue<UtcTime> losses_{100};
    std::jthread reader_;  // last: it uses everything above
};

}  // namespace metier::system_tests
