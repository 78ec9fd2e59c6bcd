#pragma once

#include <atomic>
#include <cstdint>
#include <stop_token>
#include <string>
#include <thread>

#include "chunks.hpp"
#include "raw_socket.hpp"
#include "responses.hpp"

namespace metier::hostile {

/// Takes connections of clients, one at a time, and answers mostly as a server does. A seed decides
/// where it sends wrong data, is silent, does not end, closes the connection, or sends another
/// answer.
///
/// Threading: a thread of its own answers.
class HostileServer {
public:
    struct Character {
        std::uint64_t seed = 1;
        Landscape landscape = Landscape::loops;
        /// One in so many fields is wrong once the session is open; 0: none.
        std::size_t wrong_one_in = 0;
        /// One in so many answers is not what the service answers; 0: none.
        std::size_t odd_one_in = 0;
        /// The channel and the session are as bad as all that follows.
        bool from_the_start = false;
    };

    explicit HostileServer(const Character& character);

    std::string url() const;
    std::uint64_t answers() const { return answers_; }

private:
    void run(const std::stop_token& stop);
    void serve(const std::stop_token& stop, RawSocket& socket);
    void answer(RawSocket& socket, std::string_view chunk);
    void answerRequest(RawSocket& socket, std::string_view body);
    void answerOddly(RawSocket& socket, Random& random, const Asked& asked);
    Bytes inMessage(std::string_view body);
    bool isHonest(const Asked& asked) const;
    std::size_t wrongness(const Asked& asked) const;

    const Character character_;
    RawListener listener_;
    Channel channel_;
    std::atomic<std::uint64_t> answers_{0};
    std::jthread thread_;  // last: it uses all of the above
};

}  // namespace metier::hostile
