#include "metier/link/host_addresses.hpp"

#include <netdb.h>

#include <asio/ip/tcp.hpp>
#include <cstring>
#include <future>
#include <list>
#include <mutex>
#include <thread>
#include <utility>

namespace metier::link {
namespace {

using asio::ip::address;
using Found = Result<std::vector<address>>;

address addressFrom(const addrinfo& entry) {
    asio::ip::tcp::endpoint endpoint;
    endpoint.resize(entry.ai_addrlen);
    std::memcpy(endpoint.data(), entry.ai_addr, entry.ai_addrlen);
    return endpoint.address();
}

/// Waits for the name server, however long that takes.
Found lookUp(const std::string& host) {
    addrinfo wanted{};
    wanted.ai_family = AF_UNSPEC;
    wanted.ai_socktype = SOCK_STREAM;
    addrinfo* first = nullptr;
    if (const int code = ::getaddrinfo(host.c_str(), nullptr, &wanted, &first); code != 0) {
        return fail(Errc::connection_lost, ::gai_strerror(code));
    }
    std::vector<address> found;
    for (const auto* entry = first; entry != nullptr; entry = entry->ai_next) {
        if (entry->ai_family == AF_INET || entry->ai_family == AF_INET6) {
            found.push_back(addressFrom(*entry));
        }
    }
    ::freeaddrinfo(first);
    return found.empty() ? Found(fail(Errc::connection_lost, "the host has no address")) : found;
}

/// The look-ups of this process that are under way.
///
/// Threading: any. Its end waits for them.
class LookUps {
public:
    Found await(const std::string& host, SteadyTime deadline) {
        auto outcome = outcomeOf(host);
        if (outcome.wait_until(deadline) != std::future_status::ready) {
            return fail(Errc::timeout, "the name of the host was not resolved in time");
        }
        return outcome.get();
    }

private:
    struct LookUp {
        std::string host;
        std::shared_future<Found> outcome;
        std::jthread thread;
    };

    static bool over(const LookUp& one) {
        return one.outcome.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
    }

    /// Joins those that are over; joins one that is waited for now.
    std::shared_future<Found> outcomeOf(const std::string& host) {
        const std::lock_guard lock(mutex_);
        under_way_.remove_if(over);
        for (const auto& one : under_way_) {
            if (one.host == host) {
                return one.outcome;
            }
        }
        std::promise<Found> promise;
        auto outcome = promise.get_future().share();
        under_way_.push_back(
            {host, outcome, std::jthread([host, promise = std::move(promise)]() mutable {
                 promise.set_value(lookUp(host));
             })});
        return outcome;
    }

    std::mutex mutex_;
    std::list<LookUp> under_way_;
};

}  // namespace

Found addressesOf(const std::string& host, SteadyTime deadline) {
    asio::error_code error;
    const auto given = asio::ip::make_address(host, error);
    if (!error) {
        return std::vector{given};
    }
    // Not of any caller: a look-up may outlive the one that asked for it.
    static LookUps look_ups;
    return look_ups.await(host, deadline);
}

}  // namespace metier::link
