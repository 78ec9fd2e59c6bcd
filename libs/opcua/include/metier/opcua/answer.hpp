#pragma once

#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "metier/base/error.hpp"
#include "metier/opcua/status_code.hpp"

namespace metier::opcua {

/// An Error that keeps the StatusCode from which it was made. Converts to Error, and an Answer<T>
/// to a Result<T>, where the StatusCode does not matter.
///
/// `status` is the peer's own code where the peer refused, BadTimeout where it did not answer in
/// time, and otherwise the code that the transport reported.
///
///     const auto called = client.call(start);
///     if (!called && called.error().delivery == Failure::Delivery::unknown) {
///         // it may have begun: read its state before calling it again
///     }
struct Failure : Error {
    /// StatusCode behind the Error.
    StatusCode status = status::kBadUnexpectedError;
    /// The peer's StatusCode for each input argument of a Method that it refused; often empty.
    std::vector<StatusCode> input_results;
    /// Fate of the request, as far as it is known.
    enum class Delivery {
        /// The peer answered, or no request was needed.
        answered,
        /// It never left this process: it has no effect, now or later.
        not_sent,
        /// It was sent and no answer came: the peer may have carried it out.
        unknown,
    };
    /// Whether the request may have had an effect.
    Delivery delivery = Delivery::answered;
};

/// Answer of a peer, or the reason why there is none.
template <typename T = void>
using Answer = tl::expected<T, Failure>;

/// Makes a failed Answer from a StatusCode; text "<doing>: BadOutOfRange". Its delivery is
/// `answered`.
inline tl::unexpected<Failure> failed(StatusCode status, std::string_view doing) {
    return tl::unexpected<Failure>(Failure{errorFrom(status, doing), status, {}});
}

}  // namespace metier::opcua
