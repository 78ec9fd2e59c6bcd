#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "metier/base/error.hpp"

namespace metier::opcua {

/// The 32-bit outcome of an OPC UA service or operation (OPC 10000-4, 7.39).
///
/// Threading: a value type.
///
///     if (code == status::kBadLocked) { waitForOwner(); }
///     log("refused: {}", code.name());  // BadLocked
class StatusCode {
public:
    /// Good.
    constexpr StatusCode() = default;
    /// \param value code of OPC 10000-6, A.2, with or without info bits
    explicit constexpr StatusCode(std::uint32_t value) : value_(value) {}

    /// All 32 bits, info bits such as Overflow included.
    constexpr std::uint32_t value() const noexcept { return value_; }
    /// Whether the severity is Good; Uncertain is neither Good nor Bad.
    constexpr bool isGood() const noexcept { return (value_ >> 30U) == 0; }
    /// Whether the severity is Bad.
    constexpr bool isBad() const noexcept { return (value_ >> 31U) != 0; }
    /// Symbol of the standard, `BadOutOfRange`; for an unknown code its hexadecimal value.
    std::string name() const;

    /// Compares all 32 bits: a code with info bits differs from the plain one.
    friend constexpr bool operator==(StatusCode, StatusCode) = default;
    friend constexpr auto operator<=>(StatusCode, StatusCode) = default;

private:
    std::uint32_t value_ = 0;
};

namespace status {
/// The operation succeeded.
inline constexpr StatusCode kGood{0x00000000};
/// Something went wrong, and the cause is not known.
inline constexpr StatusCode kBadUnexpectedError{0x80010000};
/// A defect of the peer, or an exception of a skill: Errc::internal.
inline constexpr StatusCode kBadInternalError{0x80020000};
/// The peer has no memory for the operation.
inline constexpr StatusCode kBadOutOfMemory{0x80030000};
/// The device is in use by another skill, or a disk is away: Errc::resource_unavailable.
inline constexpr StatusCode kBadResourceUnavailable{0x80040000};
/// No answer in time, a deadline that has passed, or a Reset that goes on: Errc::timeout.
inline constexpr StatusCode kBadTimeout{0x800A0000};
/// The peer does not have the service.
inline constexpr StatusCode kBadServiceUnsupported{0x800B0000};
/// The user or its role may not do this: Errc::access_denied.
inline constexpr StatusCode kBadUserAccessDenied{0x801F0000};
/// A wrong user or password.
inline constexpr StatusCode kBadIdentityTokenRejected{0x80210000};
/// The session is gone; its client must make a new one.
inline constexpr StatusCode kBadSessionIdInvalid{0x80250000};
/// The session was closed.
inline constexpr StatusCode kBadSessionClosed{0x80260000};
/// The session has not logged in yet.
inline constexpr StatusCode kBadSessionNotActivated{0x80270000};
/// The server has no connection to the device, so it has no value: Errc::connection_lost.
inline constexpr StatusCode kBadNoCommunication{0x80310000};
/// The value was not set yet.
inline constexpr StatusCode kBadWaitingForInitialData{0x80320000};
/// The server has no such node, perhaps since it was started again.
inline constexpr StatusCode kBadNodeIdUnknown{0x80340000};
/// A value beyond a limit, or a pose out of reach: Errc::out_of_range, unreachable, limit_violated.
inline constexpr StatusCode kBadOutOfRange{0x803C0000};
/// The named thing, such as an execution, does not exist: Errc::not_found.
inline constexpr StatusCode kBadNotFound{0x803E0000};
/// The Variable cannot be written.
inline constexpr StatusCode kBadNotWritable{0x803B0000};
/// The id is taken, or an execution of that name has begun once: Errc::already_exists.
inline constexpr StatusCode kBadNodeIdExists{0x805E0000};
/// A path leads to no node.
inline constexpr StatusCode kBadNoMatch{0x806F0000};
/// The value has another type than the Variable or argument: Errc::type_mismatch.
inline constexpr StatusCode kBadTypeMismatch{0x80740000};
/// The object does not have the Method.
inline constexpr StatusCode kBadMethodInvalid{0x80750000};
/// The server has no room for another session, see ServerLimits::sessions.
inline constexpr StatusCode kBadTooManySessions{0x80560000};
/// The connection was closed, by the peer or a broken network.
inline constexpr StatusCode kBadConnectionClosed{0x80AE0000};
/// A value of the wrong size, form or content: Errc::invalid_argument.
inline constexpr StatusCode kBadInvalidArgument{0x80AB0000};
/// The Program's state does not allow the Method: Errc::invalid_state.
inline constexpr StatusCode kBadInvalidState{0x80AF0000};
/// Another session has control, or has configured the skill: Errc::locked.
inline constexpr StatusCode kBadLocked{0x80E90000};
/// The sub-state machine is not active now, as its state is another one.
inline constexpr StatusCode kBadStateNotActive{0x80BF0000};
/// There is nothing to show yet, such as an execution record.
inline constexpr StatusCode kBadNoData{0x809B0000};
/// Fewer arguments than the Method takes.
inline constexpr StatusCode kBadArgumentsMissing{0x80760000};
/// More arguments than the Method takes.
inline constexpr StatusCode kBadTooManyArguments{0x80E50000};
/// The Method cannot be called now.
inline constexpr StatusCode kBadNotExecutable{0x81110000};
/// The peer refused certificate or signature without saying why.
inline constexpr StatusCode kBadSecurityChecksFailed{0x80130000};
/// The certificate is not trusted by the one that reports this.
inline constexpr StatusCode kBadCertificateUntrusted{0x801A0000};
/// There is no connection, so the request was not sent.
inline constexpr StatusCode kBadNotConnected{0x808A0000};
/// The way of login is not one that the server offers.
inline constexpr StatusCode kBadIdentityTokenInvalid{0x80200000};
/// The server does not take the status or time that was written.
inline constexpr StatusCode kBadWriteNotSupported{0x80730000};
}  // namespace status

/// StatusCode that a peer gets for an error of this project: the only table of error codes. Several
/// errors share one code: unreachable and limit_violated are BadOutOfRange, too.
/// Threads of these functions: any; pure.
StatusCode statusFrom(Errc code) noexcept;

/// Error code for a peer's StatusCode, chosen by what a program can do about it. Codes of broken
/// transports and sessions become connection_lost, those without an entry of their own internal.
Errc errcFrom(StatusCode code) noexcept;

/// Error for a refusal of the stack or of a peer; text "<doing>: BadOutOfRange".
Error errorFrom(StatusCode code, std::string_view doing);

}  // namespace metier::opcua
