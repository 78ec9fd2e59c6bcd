#pragma once

#include <memory>
#include <utility>

namespace metier::virtual_controller {

/// Member of an object that gives handlers to an io_context. Handlers that are called after the
/// object's end do nothing. To cancel an operation is not enough: once it is done its handler is
/// queued, and is called without an error.
///
/// Threading: the thread that runs the io_context.
class Lifetime {
public:
    Lifetime() = default;
    Lifetime(const Lifetime&) = delete;
    Lifetime& operator=(const Lifetime&) = delete;

    /// A handler that calls `handler` as long as the object lives.
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
