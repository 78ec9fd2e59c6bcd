#include <stdexcept>

#include "bare.hpp"
#include "both_sides.hpp"

namespace metier::benchmarks {
namespace {

namespace bare = opcua::bare;
using std::chrono::steady_clock;

constexpr std::chrono::seconds kPatience{5};
constexpr std::chrono::milliseconds kAtOnce{10};

class BareCaller final : public Caller {
public:
    explicit BareCaller(const std::string& url) : client_(url) {}

    void call() override { client_.callNothing(); }
    void start() override { client_.callStart(); }
    void subscribe() override {
        client_.subscribe(kPublishingInterval, [this] { heard(); });
    }

    std::chrono::nanoseconds startUntilRunning() override {
        events_ = 0;
        const auto begin = steady_clock::now();
        start();
        while (events_ < 2) {
            client_.iterate(kAtOnce);
            if (steady_clock::now() > begin + kPatience) {
                throw std::runtime_error("no event came");
            }
        }
        return first_ - begin;
    }

    void idleUntil(steady_clock::time_point end) override {
        while (steady_clock::now() < end) {
            client_.iterate(kPublishingInterval);
        }
    }

private:
    void heard() {
        if (events_++ == 0) {
            first_ = steady_clock::now();
        }
    }

    int events_ = 0;
    steady_clock::time_point first_{};
    bare::Client client_;
};

}  // namespace

Side bareSide() {
    return {[](std::size_t idle) {
                const auto server = std::make_shared<bare::Server>();
                server->addPrograms(static_cast<std::uint32_t>(idle));
                server->start();
                return Served{server->url(), server};
            },
            [](const std::string& url) { return std::make_unique<BareCaller>(url); }};
}

}  // namespace metier::benchmarks
