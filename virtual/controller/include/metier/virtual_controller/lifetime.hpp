#pragma once

#include <memory>
#include <utility>

namespace metier::virtual_controller {

/// Member of an object that gives handlers to an io_context. Handlers that are called after the
/// object's end do nothing. To cancel an operation is not enough: once it is done its handler is
/// queued, and is called without an error.
///
/// Threading: the thread that runs the io_context.
///
///     timer_.async_wait(lifetime_.guard([this](const asio::error_code&) { onTime(); }));
///
/// Make it the last member: then it ends first, before anything that a handler could use.
class Lifetime {
public:
    Lifetime() = default;
    Lifetime(const Lifetime&) = delete;
    Lifetime& operator=(const Lifetime&) = delete;

    /// A handler that calls `handler` as long as the object lives.
    /// Any number of handlers may be guarded. The handler itself is copied or moved into the
    /// result, and is destroyed with it, also if it was never called.
    template <typename Handler>
    auto guard(Handler handler) const {
        return [alive = std::weak_ptr<const bool>(alive_),
                handler = std::move(handler)](auto&&... results) mutable {
            if (!alive.expired()) {
                handler(std::forward<decltype(results)>(results)...);
            }
        };
    }

private:
    std::shared_ptr<const bool> alive_ = std::make_shared<bool>(true);  // its handlers watch it
};

}  // namespace metier::virtual_controller
