#pragma once

#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "metier/base/error.hpp"
#include "metier/opcua/status_code.hpp"

namespace metier::opcua {

/// An Error that keeps the StatusCode it came from. Converts to Error, and an Answer<T> to a
/// Result<T>, where the StatusCode is of no interest.
///
/// `status` is the peer's own code where the peer refused; `BadTimeout` where it did not answer
/// in time; otherwise what the transport reported.
struct Failure : Error {
    StatusCode status = status::kBadUnexpectedError;
    /// What the peer had to say to each input argument of a Method it refused; often empty.
    std::vector<StatusCode> input_results;
    /// What is known of the request.
    enum class Delivery {
        answered,  ///< the peer refused it, or there was none
        not_sent,  ///< it never left this process: nothing happened, and nothing will
        unknown,   ///< it was sent and nothing came back: the peer may have carried it out
    };
    Delivery delivery = Delivery::answered;
};

/// What a peer answered, or why it did not.
template <typename T = void>
using Answer = tl::expected<T, Failure>;

/// A failed Answer that a StatusCode explains: "<doing>: BadOutOfRange".
inline tl::unexpected<Failure> failed(StatusCode status, std::string_view doing) {
    return tl::unexpected<Failure>(Failure{errorFrom(status, doing), status, {}});
}

}  // namespace metier::opcua
