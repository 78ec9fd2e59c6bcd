#pragma once

#include <memory>
#include <optional>
#include <string>

#include "metier/base/clock.hpp"
#include "metier/security/certificate.hpp"

namespace metier::security {

/// Properties of a certificate for a test.
struct Wanted {
    std::string name = "robot";
    std::string uri = "urn:robot";
    UtcTime not_before = std::chrono::system_clock::now() - std::chrono::hours(1);
    UtcTime not_after = std::chrono::system_clock::now() + std::chrono::hours(24);
    int key_bits = 2048;
    bool sha1 = false;
    std::string key_usage = "critical,digitalSignature,keyEncipherment,dataEncipherment";
};

/// An authority that signs certificates for tests.
class Authority {
public:
    /// \param signer of an authority below it; null: a root. Must outlive this.
    explicit Authority(const std::string& name, const Authority* signer = nullptr);
    ~Authority();
    Authority(const Authority&) = delete;
    Authority& operator=(const Authority&) = delete;

    const Certificate& certificate() const { return *certificate_; }
    Certificate sign(const Wanted& wanted) const;
    /// DER, of all that were revoked. \param until it is valid
    std::string revocationList(const std::optional<Certificate>& revoked = {},
                               UtcTime until = std::chrono::system_clock::now() +
                                               std::chrono::hours(24)) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
    std::optional<Certificate> certificate_;
};

/// Signed by itself.
Certificate selfSigned(const Wanted& wanted);

}  // namespace metier::security
