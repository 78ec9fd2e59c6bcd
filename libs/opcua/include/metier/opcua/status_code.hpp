#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "metier/base/error.hpp"

namespace metier::opcua {

/// The 32-bit outcome of an OPC UA service or operation (OPC 10000-4, 7.39).
///
/// Threading: a value type.
class StatusCode {
public:
    /// Good.
    constexpr StatusCode() = default;
    explicit constexpr StatusCode(std::uint32_t value) : value_(value) {}

    /// All 32 bits, info bits such as Overflow included.
    constexpr std::uint32_t value() const noexcept { return value_; }
    /// Whether the severity is Good; Uncertain is neither Good nor Bad.
    constexpr bool isGood() const noexcept { return (value_ >> 30U) == 0; }
    /// Whether the severity is Bad.
    constexpr bool isBad() const noexcept { return (value_ >> 31U) != 0; }
    /// Symbol of the standard, `BadOutOfRange`; for an unknown code its hexadecimal value.
    std::string name() const;

    friend constexpr bool operator==(StatusCode, StatusCode) = default;
    friend constexpr auto operator<=>(StatusCode, StatusCode) = default;

private:
    std::uint32_t value_ = 0;
};

namespace status {
inline constexpr StatusCode kGood{0x00000000};
inline constexpr StatusCode kBadUnexpectedError{0x80010000};
inline constexpr StatusCode kBadInternalError{0x80020000};
inline constexpr StatusCode kBadOutOfMemory{0x80030000};
inline constexpr StatusCode kBadResourceUnavailable{0x80040000};
inline constexpr StatusCode kBadTimeout{0x800A0000};
inline constexpr StatusCode kBadServiceUnsupported{0x800B0000};
inline constexpr StatusCode kBadUserAccessDenied{0x801F0000};
inline constexpr StatusCode kBadIdentityTokenRejected{0x80210000};
inline constexpr StatusCode kBadSessionIdInvalid{0x80250000};
inline constexpr StatusCode kBadSessionClosed{0x80260000};
inline constexpr StatusCode kBadSessionNotActivated{0x80270000};
inline constexpr StatusCode kBadNoCommunication{0x80310000};
inline constexpr StatusCode kBadWaitingForInitialData{0x80320000};
inline constexpr StatusCode kBadNodeIdUnknown{0x80340000};
inline constexpr StatusCode kBadOutOfRange{0x803C0000};
inline constexpr StatusCode kBadNotFound{0x803E0000};
inline constexpr StatusCode kBadNotWritable{0x803B0000};
inline constexpr StatusCode kBadNodeIdExists{0x805E0000};
inline constexpr StatusCode kBadNoMatch{0x806F0000};
inline constexpr StatusCode kBadTypeMismatch{0x80740000};
inline constexpr StatusCode kBadMethodInvalid{0x80750000};
inline constexpr StatusCode kBadTooManySessions{0x80560000};
inline constexpr StatusCode kBadConnectionClosed{0x80AE0000};
inline constexpr StatusCode kBadInvalidArgument{0x80AB0000};
inline constexpr StatusCode kBadInvalidState{0x80AF0000};
inline constexpr StatusCode kBadLocked{0x80E90000};
inline constexpr StatusCode kBadStateNotActive{0x80BF0000};
inline constexpr StatusCode kBadNoData{0x809B0000};
inline constexpr StatusCode kBadArgumentsMissing{0x80760000};
inline constexpr StatusCode kBadTooManyArguments{0x80E50000};
inline constexpr StatusCode kBadNotExecutable{0x81110000};
inline constexpr StatusCode kBadSecurityChecksFailed{0x80130000};
inline constexpr StatusCode kBadCertificateUntrusted{0x801A0000};
inline constexpr StatusCode kBadNotConnected{0x808A0000};
inline constexpr StatusCode kBadIdentityTokenInvalid{0x80200000};
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
